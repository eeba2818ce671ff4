"""What is known beside a log: the speed of its ship, calibrations of gases that it has, humid air."""

from dataclasses import replace
from datetime import UTC, datetime, timedelta

import numpy as np
import pandas as pd
import pytest

from measurement.log.config import read_config
from measurement.log.prepare import prepare
from measurement.log.read import read_flight
from measurement.log.ship import ShipTrack, speed_of
from tests.measurement.log.zero_and_span import calibrated

START = datetime(2026, 6, 1, 10, 0, tzinfo=UTC)
METRES_PER_DEGREE = 111_195.0  # of latitude; other radii of the Earth differ by 0.13 %


def track(speed_mps, seconds=900.0, every=30.0):
    time = START.timestamp() - 300.0 + np.arange(0.0, seconds, every)
    latitude = 56.0 + speed_mps * (time - time[0]) / METRES_PER_DEGREE
    return ShipTrack(name="ship", latitude=latitude, longitude=np.full(len(time), 11.0), time=time)


def prepared(logged, text, **more):
    path = logged.parent / "own.toml"
    path.write_text(
        f'instrument = "electrochemical"\n{text}\n[flight]\ndate = 2026-06-01T10:00:00Z\n',
        encoding="utf-8",
    )
    config = read_config(path)
    return prepare(read_flight(logged, config), config, **more), config


def with_methane(logged, **columns):
    table = pd.read_csv(logged)
    excess = table["co2_ppm"] - table["co2_ppm"].quantile(0.05)
    table["ch4_ppb"] = (1950.0 + 70.0 * excess).round(1)
    for name, value in columns.items():
        table[name] = value
    table.to_csv(logged, index=False)
    return logged


def test_the_speed_by_ais_is_that_of_the_track_during_the_log():
    begin = START.timestamp()
    assert speed_of(track(6.0), begin, begin + 300.0) == pytest.approx(6.0, rel=2e-3)
    # A ship that stops at the end of its track: only the log's time counts.
    both = track(6.0, seconds=1800.0)
    stopped = np.minimum(both.latitude, np.interp(begin + 400.0, both.time, both.latitude))
    late = replace(both, latitude=stopped)
    assert speed_of(late, begin, begin + 300.0) == pytest.approx(6.0, rel=2e-3)
    assert speed_of(late, begin + 600.0, begin + 900.0) == pytest.approx(0.0, abs=1e-3)
    assert speed_of(late, begin + 9000.0, begin + 9300.0) is None


def test_an_engine_gets_the_speed_of_its_ship_unless_it_is_stated(logged):
    engine = "[engine]\nrated_rpm = 120\ndesign_speed_mps = 8.0\n"
    found, _ = prepared(logged, engine, ships=[track(6.0)])
    assert found.config.engine.speed_mps == pytest.approx(6.0, rel=2e-3)
    assert not found.changed
    found, _ = prepared(logged, f"{engine}speed_mps = 7.0\n", ships=[track(6.0)])
    assert found.config.engine.speed_mps == 7.0
    found, _ = prepared(logged, "", ships=[track(6.0)])
    assert found.config.engine is None


def test_calibrations_change_the_gases_that_the_log_has(logged, tmp_path):
    at = START - timedelta(minutes=75)
    methane = calibrated(tmp_path / "a.csv", at, gas="ch4", span=5000.0, noise=4.0, gain=0.97)
    found, _ = prepared(logged, "", calibrations=[methane])
    assert not found.changed
    assert found.config.channels == {}
    assert "calibration: CH4 of 2026-06-01" in found.remarks[0]
    found, _ = prepared(with_methane(logged), "", calibrations=[methane])
    assert found.changed
    channel = found.config.channels["ch4"]
    assert channel.gain == pytest.approx(0.97, abs=0.01)
    assert channel.t90_s == pytest.approx(8.0, abs=0.5)
    assert np.isfinite(channel.t90_sd)
    [nox, gas] = read_flight(logged, found.config).gases
    assert (nox.species.name, gas.species.name) == ("nox", "ch4")
    assert gas.instrument.known("so2").gain == channel.gain


def test_the_effect_of_humid_air_is_a_gain_with_its_uncertainty(logged):
    humid = with_methane(logged, humidity_percent=85.0)
    found, _ = prepared(humid, "[humidity]\nch4 = [-10.0, 2.0]\nnox = [0.0, 1.0]\n")
    channel = found.config.channels["ch4"]
    # What nobody declares has a gain known to 10 %, here of 0.9.
    assert channel.gain == pytest.approx(0.9)
    assert channel.gain_sd == pytest.approx(np.hypot(0.1, 0.02 / 0.9))
    assert set(found.problems) == {"so2"}
    dry, _ = prepared(with_methane(logged, humidity_percent=79.0), "")
    assert not dry.changed
    assert not dry.problems
