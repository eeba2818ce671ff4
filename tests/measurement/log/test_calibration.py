"""Calibrations: what a log of zero and span gas shows, and what an estimate makes of it.

The readings are simulated here by another integration than that of ``measurement``.
"""

import json
from datetime import UTC, datetime, timedelta

import numpy as np
import pandas as pd
import pytest
from logged_flights import run
from scipy.signal import lfilter

from measurement.log.calibrate_command import main
from measurement.log.calibration import calibrate, read_calibration, write_calibration

BRIEFLY = pytest.mark.usefixtures("briefly")
START = datetime(2026, 6, 1, 9, 0, tzinfo=UTC)
FLIGHT_DATE = "[flight]\ndate = 2026-06-01T10:00:00Z\n"


def zero_and_span(
    path,
    *,
    seed=0,
    gas="so2",
    span=200.0,
    gain=0.95,
    offset=3.0,
    drift_per_h=0.0,
    t90=8.0,
    delay=1.5,
    noise=2.5,
    leak=0.0,
    tail=0.0,
    seconds=1800,
):
    """Write a log of zero and span gas, five minutes each."""
    generator, step = np.random.default_rng(seed), 0.02
    time, fine = np.arange(float(seconds)), np.arange(0.0, seconds, step)

    def supplied(t):
        return np.where((t % 600.0) < 300.0, 0.0, span)

    def lag(signal, constant):
        kept = np.exp(-step / constant)
        return lfilter([1.0 - kept], [1.0, -kept], signal)

    inlet = (1.0 - leak) * supplied(np.maximum(fine - delay, 0.0))
    seen = (1.0 - tail) * lag(inlet, t90 / np.log(10.0)) + tail * lag(inlet, 60.0)
    read = np.interp(time, fine, seen)
    read = read * (gain + drift_per_h * (time - seconds / 2.0) / 3600.0) + offset
    read += noise * generator.standard_normal(len(time))
    unit = "ppm" if gas == "co2" else "ppb"
    table = {"time_s": time, f"{gas}_{unit}": read.round(2)}
    table[f"{gas}_supplied_{unit}"] = supplied(time)
    pd.DataFrame(table).to_csv(path, index=False)
    return path


def calibrated(path, at=START, instrument="electrochemical", **log):
    return calibrate(zero_and_span(path, **log), instrument=instrument, serial="7", time_utc=at)


def test_what_was_simulated_is_found_within_its_uncertainty(tmp_path):
    truth = {
        "gain": (0.95, "gain_sd"),
        "offset": (3.0, "offset_sd"),
        "gain_drift": (0.1, "gain_drift_sd"),
        "t90_s": (8.0, "t90_sd_s"),
        "delay_s": (1.5, "delay_sd_s"),
    }
    errors = {name: [] for name in truth}
    for seed in range(15):
        log = zero_and_span(tmp_path / "zero.csv", seed=seed, drift_per_h=0.1)
        found = calibrate(log, instrument="x", time_utc=START, span_sd=0.0).channels["so2"]
        for name, (value, deviation) in truth.items():
            errors[name].append((getattr(found, name) - value) / getattr(found, deviation))
        assert not found.problems
        assert any("the gain of SO2 drifts by +0." in remark for remark in found.remarks)
    for name, of in errors.items():
        # Mean and spread of 15 errors in standard deviations: three of each.
        assert abs(np.mean(of)) < 1.5, name
        assert 0.4 < np.std(of) < 1.8, name


@pytest.mark.parametrize(
    ("log", "problem"),
    [
        ({"leak": 0.25}, "SO2 reads 71 % of the span"),
        ({"tail": 0.2}, "SO2 does not follow the steps as one lag"),
    ],
)
def test_a_leak_is_found(tmp_path, capsys, log, problem):
    zero_and_span(tmp_path / "zero.csv", **log)
    words = ["--instrument=electrochemical", "--time=2026-06-01T09:00:00Z"]
    assert main([str(tmp_path / "zero.csv"), *words]) == 1
    assert problem in capsys.readouterr().out
    found = read_calibration(tmp_path / "zero.calibration.json")
    assert problem in found.channels["so2"].problems[0]


def test_a_sound_calibration_is_written_and_read_without_loss(tmp_path, capsys):
    zero_and_span(tmp_path / "zero.csv")
    words = ["--instrument=electrochemical", "--serial=7", "--time=2026-06-01T09:00:00Z"]
    assert main([str(tmp_path / "zero.csv"), *words]) == 0
    assert "gain 0.9" in capsys.readouterr().out
    path = tmp_path / "zero.calibration.json"
    found = read_calibration(path)
    assert found == calibrate(
        tmp_path / "zero.csv", instrument="electrochemical", serial="7", time_utc=START
    )
    content = json.loads(path.read_text(encoding="utf-8"))
    assert content["sha256"] == found.sha256


def configured(logged, text=FLIGHT_DATE):
    (logged.parent / "instrument.toml").write_text(
        f'instrument = "electrochemical"\n{text}', encoding="utf-8"
    )


def estimated(logged):
    return json.loads((logged.parent / "out" / "estimate.json").read_text(encoding="utf-8"))


def with_calibrations(logged, *found):
    words = []
    for number, of in enumerate(found):
        path = logged.parent / f"{number}.json"
        write_calibration(path, of)
        words += ["--calibration", str(path)]
    return run(logged, *words)


@BRIEFLY
def test_calibrations_before_and_after_a_flight_are_interpolated(logged, tmp_path, capsys):
    configured(logged)
    assert run(logged) == 0
    plain = estimated(logged)
    # The flight is of 10:00 to 10:05; the middles of both logs are as far from its middle.
    middle = START + timedelta(minutes=62.5)
    before = calibrated(
        tmp_path / "a.csv", middle - timedelta(minutes=75), gain=0.9, t90=20.0, delay=1.0
    )
    after = calibrated(
        tmp_path / "b.csv", middle + timedelta(minutes=45), gain=1.1, t90=20.0, delay=1.0, seed=1
    )
    assert with_calibrations(logged, after, before) == 0
    found = estimated(logged)
    used = found["instrument"]["used"]["so2"]
    assert used["gain"] == pytest.approx(1.0, abs=0.02)
    # A change of 0.2, evenly: 0.2 over the root of 12.
    assert used["gain_sd"] == pytest.approx(0.2 / 12.0**0.5, rel=0.1)
    common = (of["estimate"]["common_percent"]["calibration"] for of in (found, plain))
    assert next(common) > 1.3 * next(common)
    assert capsys.readouterr().out.count("calibration: SO2 of 2026-06-01") == 2
    # One alone, of the same gain: 3 % of the preset's data sheet are 1 % of the span gas.
    alone = calibrated(tmp_path / "a.csv", middle, gain=0.9, t90=20.0, delay=1.0)
    assert with_calibrations(logged, alone) == 0
    corrected = estimated(logged)["estimate"]["fsc_percent"]
    assert corrected == pytest.approx(plain["estimate"]["fsc_percent"] / 0.9, rel=0.05)


@BRIEFLY
def test_a_leak_is_in_the_uncertainty_and_leaves_no_verdict(logged, tmp_path):
    configured(logged)
    found = calibrated(tmp_path / "a.csv", leak=0.25, gain=1.0, t90=20.0, delay=1.0)
    assert with_calibrations(logged, found) == 0
    record = estimated(logged)
    assert record["instrument"]["used"]["so2"]["gain_sd"] > 0.25
    assert record["estimate"]["quality"] == "C"
    assert "a leak" in " ".join(record["estimate"]["quality_reasons"])


def changed_file(path):
    content = json.loads(path.read_text(encoding="utf-8"))
    content["channels"]["so2"]["gain"] *= 1.1
    path.write_text(json.dumps(content), encoding="utf-8")


@pytest.mark.parametrize(
    ("text", "log", "message"),
    [
        (FLIGHT_DATE, {"instrument": "fast"}, "is of 'fast' number 7, and the flight of 'electro"),
        (f"serial = 'B-2'\n{FLIGHT_DATE}", {}, "'electrochemical' number B-2; give one of"),
        (FLIGHT_DATE, {"at": START - timedelta(days=3)}, "h from the flight; at most 24 h count"),
        (f"calibration_hours = 0.5\n{FLIGHT_DATE}", {}, "at most 0.5 h count"),
        ("", {}, "the log has no date to compare with that of the calibration"),
    ],
)
def test_a_stale_or_foreign_calibration_is_refused_in_a_line(
    logged, tmp_path, capsys, text, log, message
):
    configured(logged, text)
    assert with_calibrations(logged, calibrated(tmp_path / "a.csv", **log)) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1


def test_three_calibrations_or_two_of_one_side_are_refused(logged, tmp_path, capsys):
    configured(logged)
    of = calibrated(tmp_path / "a.csv")
    assert with_calibrations(logged, of, of, of) == 2
    assert "3 calibrations are given" in capsys.readouterr().err
    assert with_calibrations(logged, of, of) == 2
    assert "not before and after the flight" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (changed_file, "was changed after it was written"),
        (lambda path: path.write_text("{}", encoding="utf-8"), "is no calibration"),
        (lambda path: path.write_text("[", encoding="utf-8"), "cannot be read"),
        (lambda path: path.unlink(), "cannot be read"),
        (
            lambda path: path.write_text(
                path.read_text(encoding="utf-8").replace('"format": 1', '"format": 9'),
                encoding="utf-8",
            ),
            "has the format 9",
        ),
    ],
)
def test_a_calibration_that_cannot_be_is_refused_in_a_line(
    logged, tmp_path, capsys, change, message
):
    configured(logged)
    path = tmp_path / "c.json"
    write_calibration(path, calibrated(tmp_path / "a.csv"))
    change(path)
    assert run(logged, "--calibration", str(path)) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1


def edited(path, **columns):
    table = pd.read_csv(path)
    for name, change in columns.items():
        table[name] = change(table[name])
    table.to_csv(path, index=False)


@pytest.mark.parametrize(
    ("change", "words", "message"),
    [
        (lambda p: edited(p, so2_supplied_ppb=lambda s: 0.0 * s), (), "and 0 steps"),
        (lambda p: edited(p, so2_ppb=lambda s: s.where(s.index < 9)), (), "SO2 has 9 readings"),
        (lambda p: edited(p, time_s=lambda s: -s), (), "times are missing or do not increase"),
        (
            lambda p: pd.read_csv(p).drop(columns="so2_supplied_ppb").to_csv(p, index=False),
            (),
            "has no gas with what was supplied",
        ),
        (
            lambda p: pd.read_csv(p).drop(columns="so2_ppb").to_csv(p, index=False),
            (),
            "column 'so2_supplied_ppb' has no reading beside it",
        ),
        (
            lambda p: (
                pd.read_csv(p)
                .rename(columns={"so2_ppb": "so2", "so2_supplied_ppb": "so2_supplied"})
                .to_csv(p, index=False)
            ),
            (),
            "does not say its unit",
        ),
        (lambda p: p.unlink(), (), "cannot be read"),
        (lambda _: None, ("--time=noon",), "--time is 'noon'"),
        (lambda _: None, ("--span-sd-percent=99",), "--span-sd-percent is 99 %"),
        (lambda _: None, ("--time=",), "--time is ''"),
    ],
)
def test_a_log_that_is_no_calibration_is_refused_in_a_line(
    tmp_path, capsys, change, words, message
):
    path = zero_and_span(tmp_path / "zero.csv")
    change(path)
    given = ["--instrument=x", "--time=2026-06-01T09:00:00Z", *words]
    assert main([str(path), *given]) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
