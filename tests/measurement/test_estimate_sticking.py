"""Sensors that stick give no verdict, and what living sensors read in clean air is not taken for
it.
"""

import math

import numpy as np
import pytest
from crossings import changed, crossings, flight, read

from measurement.estimate.estimator import estimate
from measurement.gases import GASES
from measurement.sniffer.sniffer import Readings
from measurement.sniffer.spec import sensor_preset

STUCK = "its sensor, or its logger, was stuck"


def told(readings, spec):
    """Return the reasons of the quality."""
    return "; ".join(estimate(readings, spec).quality_reasons)


def frozen(readings, gases, start, end=301, toggle=0.0):
    """Return readings, to a tenth, of which some gases read from a row to another what they read at
    first, or a digit more.
    """
    values = readings.values.round(1)
    for gas in gases:
        rows = np.arange(start, end)
        values[rows, GASES.index(gas)] = values[start, GASES.index(gas)] + toggle * (rows % 2)
    return Readings(readings.time, values)


@pytest.mark.parametrize("analyst", ["electrochemical", "unspecified"])
@pytest.mark.parametrize(
    ("gas", "start", "toggle", "message"),
    [
        ("so2", 20, 0.0, "SO2 reads the same for 280 s from 20 s on"),
        ("so2", 20, 0.1, "SO2 reads the same within 0.1 ppb for 280 s from 20 s on"),
        ("so2", 60, 0.0, "SO2 reads the same for 240 s from 60 s on"),
        ("co2", 100, 0.0, "CO2 reads the same for 200 s from 100 s on"),
        ("no2", 60, 0.0, "NO2 reads the same for 240 s from 60 s on"),
    ],
)
def test_a_sensor_that_sticks_has_no_verdict(analyst, gas, start, toggle, message):
    readings, _ = flight("electrochemical", 0.25, 1)
    found = estimate(frozen(readings, [gas], start, toggle=toggle), sensor_preset(analyst))
    assert found.quality == "C"
    assert {verdict.verdict for verdict in found.verdicts} == {"open"}
    assert message in "; ".join(found.quality_reasons)
    assert STUCK in "; ".join(found.quality_reasons)


def test_a_logger_that_repeats_all_readings_has_no_verdict():
    # No gas rises in the meantime; the stated noise alone tells it.
    readings, spec = flight("electrochemical", 0.25, 1)
    assert told(frozen(readings, GASES, 100), spec).count(STUCK) == 4


def test_a_sensor_that_sticks_again_and_again_has_no_verdict():
    # Six times 19 s are 38 % of 300 s; each is shorter than the t90 of 20 s.
    readings, spec = flight("electrochemical", 0.25, 1)
    for start in range(10, 300, 50):
        readings = frozen(readings, ["so2"], start, start + 20)
    assert "SO2 reads the same for 19 s from 10 s on, and 5 more times" in told(readings, spec)


def test_a_logger_that_repeats_a_few_readings_is_no_stuck_sensor():
    readings, spec = flight("electrochemical", 0.25, 1)
    assert STUCK not in told(frozen(readings, ["so2"], 100, 115), spec)


@pytest.mark.parametrize("analyst", ["electrochemical", "unspecified"])
def test_a_logger_that_is_faster_than_the_sensors_is_no_stuck_sensor(analyst):
    # Rows fifty times a second hold each reading of a second for as long.
    readings, _ = flight("electrochemical", 0.25, 1, duration=100.0)
    time = np.arange(0.0, 100.0, 0.02)
    held = readings.values[np.floor(time + 1e-9).astype(int)]
    assert STUCK not in told(Readings(time, held), sensor_preset(analyst))
    held[2000:, 0] = held[2000, 0]
    # Where no noise is stated, readings that are held show none either.
    assert (
        "SO2 reads the same for 60 s from 40 s on"
        in told(Readings(time, held), sensor_preset(analyst))
    ) == (analyst == "electrochemical")


def late_plume(fsc):
    """Return the readings of a fast sniffer, with 200 s of clean air before passes through the
    plume of a ship.
    """
    spec = sensor_preset("fast")
    return read(spec, crossings(fsc, first=200.0, interval=20.0)), spec


@pytest.mark.parametrize("noise", ["stated", "not stated"])
@pytest.mark.parametrize("step", [10.0, 20.0, 50.0])
def test_clean_air_in_a_coarse_sensor_is_no_stuck_sensor(step, noise):
    # Noise of 2 ppb of SO2, NO and NO2 is less than half a step: they read 0 for 200 s; so does
    # CO2, of 0.5 ppm, in steps of 10.
    readings, spec = late_plume(1.0)
    for gas in GASES:
        spec = changed(spec, gas, **({} if noise == "stated" else {"noise": math.nan}))
    values = np.round(readings.values / step) * step
    assert STUCK not in told(Readings(readings.time, values), spec)


def test_a_sensor_that_cuts_off_what_is_below_zero_is_none_that_sticks():
    # A zero of -8 ppb is four times the noise: clean air reads 0.
    readings, spec = late_plume(1.0)
    values = readings.values.copy()
    values[:, 0] = np.maximum(values[:, 0] - 8.0, 0.0).round(2)
    assert np.sum(values[:900, 0] == 0.0) > 800
    assert STUCK not in told(Readings(readings.time, values), spec)


@pytest.mark.parametrize(
    "preset", ["electrochemical", "fast", "laser", "alphasense_a4", "alphasense_b4"]
)
@pytest.mark.parametrize("fsc", [0.0, 0.25, 2.7])
def test_flights_of_living_sensors_stick_in_no_step(preset, fsc):
    readings, spec = flight(preset, fsc, 3)
    for decimals in (0, 1, 3):
        rounded = Readings(readings.time, readings.values.round(decimals))
        for analyst in (spec, sensor_preset("unspecified")):
            assert STUCK not in told(rounded, analyst)
