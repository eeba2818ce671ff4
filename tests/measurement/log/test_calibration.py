"""Calibrations: what a log of zero and span gas shows, and what an estimate makes of it."""

import json
from datetime import timedelta

import numpy as np
import pandas as pd
import pytest

from measurement.errors import MeasurementError
from measurement.log.calibrate_command import main
from measurement.log.calibration import applied, calibrate, read_calibration, write_calibration
from measurement.sniffer.spec import sensor_preset
from tests.measurement.log.zero_and_span import START, calibrated, zero_and_span

COMMAND = ["--instrument=electrochemical", "--serial=7", "--time=2026-06-01T09:00:00Z"]
BEGIN, END = START + timedelta(minutes=60), START + timedelta(minutes=65)
"""Of the flight: its middle is 62.5 min after START."""


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


def test_a_sound_calibration_is_written_and_read_without_loss(tmp_path, capsys):
    zero_and_span(tmp_path / "zero.csv")
    assert main([str(tmp_path / "zero.csv"), *COMMAND]) == 0
    assert "gain 0.9" in capsys.readouterr().out
    path = tmp_path / "zero.calibration.json"
    found = read_calibration(path)
    assert found == calibrated(tmp_path / "zero.csv")
    assert json.loads(path.read_text(encoding="utf-8"))["sha256"] == found.sha256


@pytest.mark.parametrize(
    ("log", "problem"),
    [
        ({"leak": 0.25, "gain": 1.0}, "SO2 reads 75 % of the span"),
        ({"tail": 0.2}, "SO2 does not follow the steps as one lag"),
    ],
)
def test_a_leak_is_found_and_is_a_problem_of_the_flight(tmp_path, log, problem):
    zero_and_span(tmp_path / "zero.csv", **log)
    assert main([str(tmp_path / "zero.csv"), *COMMAND]) == 1
    found = read_calibration(tmp_path / "zero.calibration.json")
    assert problem in found.channels["so2"].problems[0]
    of_flight = used_by_the_flight(found)
    assert problem in of_flight.problems("so2")[0]
    channel = of_flight.channel("so2", sensor_preset("electrochemical").known("so2"))
    # What the leak takes away is in the uncertainty.
    assert channel.gain_sd * channel.gain > abs(channel.gain - 1.0)


def used_by_the_flight(*calibrations, serial="7", begin=BEGIN, **more):
    return applied(
        calibrations, instrument="electrochemical", serial=serial, begin=begin, end=END, **more
    )


def test_calibrations_before_and_after_a_flight_are_interpolated(tmp_path):
    # The middles of both logs of 30 minutes are as far from that of the flight.
    middle = BEGIN + timedelta(minutes=2.5)
    before = calibrated(tmp_path / "a.csv", middle - timedelta(minutes=75), gain=0.9, t90=20.0)
    after = calibrated(
        tmp_path / "b.csv", middle + timedelta(minutes=45), gain=1.1, t90=20.0, seed=1
    )
    so2 = sensor_preset("electrochemical").known("so2")
    used = used_by_the_flight(after, before).channel("so2", so2)
    assert used.gain == pytest.approx(1.0, abs=0.02)
    # A change of 0.2, evenly: 0.2 over the root of 12.
    assert used.gain_sd == pytest.approx(0.2 / 12.0**0.5, rel=0.1)
    assert (used.t90_s, used.delay_s) == pytest.approx((20.0, 1.5), abs=0.3)
    assert used.zero == pytest.approx(3.0, abs=0.5)
    alone = used_by_the_flight(before).channel("so2", so2)
    # The span gas is known to 1 %, and the drift since then adds to it.
    assert alone.gain == pytest.approx(0.9, abs=0.02)
    assert 0.01 < alone.gain_sd < 0.03


def test_a_stale_or_foreign_calibration_is_refused_in_a_line(tmp_path):
    of = calibrated(tmp_path / "a.csv")
    fast = calibrated(tmp_path / "a.csv", instrument="fast")
    old = calibrated(tmp_path / "a.csv", START - timedelta(days=3))
    for calibrations, more, message in (
        ([fast], {}, "is of 'fast' number 7, and the flight of 'electro"),
        ([of], {"serial": "B-2"}, "'electrochemical' number B-2; give one of"),
        ([old], {}, "h from the flight; at most 24 h count"),
        ([of], {"hours_most": 0.5}, "at most 0.5 h count"),
        ([of], {"begin": None}, "the log has no date to compare with that of the calibration"),
        ([of, of, of], {}, "3 calibrations are given"),
        ([of, of], {}, "not before and after the flight"),
    ):
        with pytest.raises(MeasurementError, match=message) as caught:
            used_by_the_flight(*calibrations, **more)
        assert "\n" not in str(caught.value)


def test_a_calibration_that_cannot_be_is_refused_in_a_line(tmp_path):
    path = tmp_path / "c.json"
    write_calibration(path, calibrated(tmp_path / "a.csv"))
    written = path.read_text(encoding="utf-8")
    content = json.loads(written)
    content["channels"]["so2"]["gain"] *= 1.1
    for text, message in (
        (json.dumps(content), "was changed after it was written"),
        ("{}", "is no calibration"),
        ("[", "cannot be read"),
        (written.replace('"format": 1', '"format": 9'), "has the format 9"),
    ):
        path.write_text(text, encoding="utf-8")
        with pytest.raises(MeasurementError, match=message) as caught:
            read_calibration(path)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("change", "words", "message"),
    [
        (lambda of: of.assign(so2_supplied_ppb=0.0), (), "and 0 steps"),
        (lambda of: of.assign(so2_ppb=of["so2_ppb"][:9]), (), "SO2 has 9 readings"),
        (lambda of: of.assign(time_s=-of["time_s"]), (), "times are missing or do not increase"),
        (lambda of: of.drop(columns="so2_supplied_ppb"), (), "has no gas with what was supplied"),
        (lambda of: of.drop(columns="so2_ppb"), (), "'so2_supplied_ppb' has no reading beside it"),
        (
            lambda of: of.rename(columns=lambda name: name.removesuffix("_ppb")),
            (),
            "does not say its unit",
        ),
        (None, (), "cannot be read"),
        (lambda of: of, ("--time=noon",), "--time is 'noon'"),
        (lambda of: of, ("--span-sd-percent=99",), "--span-sd-percent is 99 %"),
        (lambda of: of, ("--time=",), "--time is ''"),
    ],
)
def test_a_log_that_is_no_calibration_is_refused_in_a_line(
    tmp_path, capsys, change, words, message
):
    path = tmp_path / "zero.csv"
    if change is not None:
        change(pd.read_csv(zero_and_span(path))).to_csv(path, index=False)
    assert main([str(path), *COMMAND, *words]) == 2
    printed = capsys.readouterr().err
    assert message in printed
    assert printed.count("\n") == 1
