"""The simulated logs are what their regimes declare, by closed forms and by their own air."""

import math
from dataclasses import replace

import numpy as np
import pytest

from measurement.log.config import read_config
from measurement.log.read import read_flight
from tests.measurement.simulator.log import (
    GASES,
    STEP_S,
    Cell,
    Exhaust,
    plume,
    random_flight,
    respond,
    simulate,
    write_logs,
)
from tests.measurement.simulator.regimes import REGIMES, Haze, Sine, Steps
from tests.measurement.simulator.runner import readings_of

pytestmark = pytest.mark.slow

QUIET = REGIMES["quiet"]


def flight_of(number=0, regime=QUIET):
    return random_flight(np.random.default_rng([5, number]), regime)


def cell_of(t90, second_pole):
    response = np.array([1.0, 0.0, 0.0, 0.0])
    return Cell(t90, second_pole, 0.0, response, zero=0.0, noise=0.0, walk=0.0)


@pytest.mark.parametrize(("t90", "second_pole"), [(1.0, 0.0), (20.0, 0.1), (20.0, 0.3)])
def test_a_cell_reads_90_percent_of_a_step_after_its_t90(t90, second_pole):
    air = np.zeros((2000, len(GASES)))
    air[100:, 0] = 50.0
    time = STEP_S * (np.arange(2000) - 99.5)
    seen = respond(cell_of(t90, second_pole), air)
    # The step is a ramp over one step of the air, and a second pole is interpolated.
    assert np.interp(t90, time, seen) == pytest.approx(45.0, rel=2e-3)


def test_haze_has_its_standard_deviation_and_correlation():
    flight = flight_of()
    haze = Haze(3.0, (20.0, 20.0))
    values = np.array([haze.air(flight, np.random.default_rng(seed))[:, 1] for seed in range(400)])
    # 400 flights of 10 or more independent values: 4000 of them, 2.2 % of the variance; four times.
    assert np.mean(values**2) == pytest.approx(9.0, rel=0.09)
    later = round(20.0 / STEP_S)
    correlation = np.mean(values[:, later:] * values[:, :-later]) / 9.0
    assert correlation == pytest.approx(math.exp(-1.0), abs=0.06)


def test_the_same_log_of_two_regimes_differs_by_the_disturbance_alone():
    quiet, hazy = simulate(QUIET, 4, 2), simulate(REGIMES["haze_5"], 4, 2)
    assert quiet.config == hazy.config
    assert np.array_equal(quiet.time, hazy.time)
    for gas in quiet.values.keys() - {"co2"}:
        assert np.array_equal(quiet.values[gas], hazy.values[gas])
    assert np.std(quiet.values["co2"] - hazy.values["co2"]) > 1.0
    # In the air, too; and a change of fuel is one by a factor of five, within the range of fuels.
    generator = np.random.default_rng(2)
    for disturbance in (Sine(2.0, 60.0), Steps(3.0), Haze(2.0)):
        air = disturbance.air(flight_of(), generator)
        assert not air[:, [0, 2, 3]].any()
        assert np.ptp(air[:, 1]) > 0.0
    for number in range(20):
        contents = simulate(REGIMES["fuel_change"], 3, number).truth.contents_percent
        assert max(contents) / min(contents) == pytest.approx(5.0)
        assert 0.03 <= min(contents) <= max(contents) <= 2.75


def test_a_log_without_noise_has_the_content_of_its_fuel_by_the_areas_of_its_plumes():
    # Over whole plumes a lag changes no area: the ratio of areas is that of the emission.
    time = np.arange(0.0, 400.0, STEP_S)
    exhaust = Exhaust(content_percent=0.5, carbon=0.86, no=18.0, no2=2.0)
    air = sum(plume(time, middle, 1.2, 40.0, exhaust) for middle in (50.0, 80.0, 120.0))
    so2 = respond(cell_of(20.0, 0.2), air)
    co2 = respond(replace(cell_of(3.0, 0.0), response=np.array([0.0, 1.0, 0.0, 0.0])), air)
    ratio = np.sum(so2) / np.sum(co2)
    assert 0.1 * 0.86 * 32.06 / 12.011 * ratio == pytest.approx(0.5, rel=1e-3)


def test_a_written_log_is_read_as_that_of_a_real_flight(tmp_path):
    log = simulate(REGIMES["second_ship_one_gap"], 4, 1)
    write_logs([log], tmp_path)
    config = read_config(tmp_path / f"{log.name}.toml")
    read, direct = read_flight(tmp_path / f"{log.name}.csv", config).readings, readings_of(log)
    np.testing.assert_array_equal(read.time, direct.time)
    np.testing.assert_array_equal(read.values, direct.values)
    assert (
        config.instrument.known("so2").cross_sd
        == log.config["instrument"]["channels"]["so2"]["cross_sd"]
    )
    name, first, last, answerable = (tmp_path / "truth.csv").read_text().splitlines()[1].split(",")
    assert (name, answerable) == (log.name, "True")
    assert first == last == f"{log.truth.contents_percent[0]:.4f}"
