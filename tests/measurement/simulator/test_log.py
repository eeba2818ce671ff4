"""The simulated logs are what their regimes declare, by closed forms and by their own air."""

import math
from dataclasses import replace

import numpy as np
import pytest

from measurement.estimate import estimate
from measurement.log.config import read_config
from measurement.log.read import read_flight
from tests.measurement.simulator.log import (
    GASES,
    STEP_S,
    Cell,
    Exhaust,
    plume,
    random_flight,
    random_instrument,
    respond,
    simulate,
    write_logs,
)
from tests.measurement.simulator.regimes import REGIMES, Haze, OtherShip, Sine, Steps
from tests.measurement.simulator.runner import readings_of

pytestmark = pytest.mark.slow

QUIET = REGIMES["quiet"]


def flight_of(number=0, regime=QUIET):
    return random_flight(np.random.default_rng([5, number]), regime)


def cell_of(t90, second_pole):
    response = np.array([1.0, 0.0, 0.0, 0.0])
    return Cell(t90, second_pole, 0.0, response, zero=0.0, noise=0.0, walk=0.0)


@pytest.mark.parametrize("second_pole", [0.0, 0.1, 0.3])
@pytest.mark.parametrize("t90", [1.0, 20.0])
def test_a_cell_reads_90_percent_of_a_step_after_its_t90(t90, second_pole):
    air = np.zeros((2000, len(GASES)))
    air[100:, 0] = 50.0
    time = STEP_S * (np.arange(2000) - 99.5)
    seen = respond(cell_of(t90, second_pole), air)
    # The step is a ramp over one step of the air, and a second pole is interpolated.
    assert np.interp(t90, time, seen) == pytest.approx(45.0, rel=2e-3)


def test_a_cell_reads_a_sine_with_the_gain_and_lag_of_its_pole():
    period, t90 = 20.0, 12.0
    time = STEP_S * np.arange(8000)
    air = np.zeros((8000, len(GASES)))
    air[:, 0] = np.sin(2.0 * math.pi * time / period)
    pole = 1.0 / (1.0 + 2j * math.pi / period * t90 / math.log(10.0))
    expected = np.imag(pole * np.exp(2j * math.pi * time / period))
    late = time > 100.0
    assert respond(cell_of(t90, 0.0), air)[late] == pytest.approx(expected[late], abs=1e-4)


def test_exhaust_has_the_sulphur_of_its_fuel():
    # 1 kg of fuel with 0.87 kg of carbon and 10 g of sulphur: 72.43 mol of CO2, 0.3119 mol of SO2.
    exhaust = Exhaust(content_percent=1.0, carbon=0.87, no=0.0, no2=0.0)
    so2, co2, *_ = exhaust.per_co2
    assert so2 / co2 == pytest.approx(1e3 * (10.0 / 32.06) / (870.0 / 12.011), rel=1e-9)


def test_the_slow_level_of_quiet_air_is_the_only_change_of_its_co2_without_a_plume():
    flight = flight_of()
    clean = replace(flight, peak=0.0 * flight.peak).air()
    assert np.ptp(clean[:, [0, 2, 3]], axis=0) == pytest.approx(0.0)
    # Nothing of it is quicker than 300 s: its slope is at most 2 pi/300 s of its size.
    slope = np.abs(np.diff(clean[:, 1])) / STEP_S
    assert np.max(slope) < 2.0 * math.pi / 300.0 * 8.0


def test_haze_has_its_standard_deviation_and_correlation():
    flight = flight_of()
    haze = Haze(3.0, (20.0, 20.0))
    values = np.array([haze.air(flight, np.random.default_rng(seed))[:, 1] for seed in range(400)])
    # 400 flights of 10 or more independent values: 4000 of them, 2.2 % of the variance; four times.
    assert np.mean(values**2) == pytest.approx(9.0, rel=0.09)
    later = round(20.0 / STEP_S)
    correlation = np.mean(values[:, later:] * values[:, :-later]) / 9.0
    assert correlation == pytest.approx(math.exp(-1.0), abs=0.06)


def test_a_sine_and_steps_add_co2_alone():
    flight, generator = flight_of(), np.random.default_rng(2)
    for disturbance in (Sine(2.0, 60.0), Steps(3.0), Haze(2.0)):
        air = disturbance.air(flight, generator)
        assert not air[:, [0, 2, 3]].any()
        assert np.ptp(air[:, 1]) > 0.0


def test_another_ship_has_as_many_plumes_as_declared_with_one_content():
    flight, generator = flight_of(), np.random.default_rng(2)
    air = OtherShip(3, (0.5, 0.5), (2.0, 2.0)).air(flight, generator)
    inside = air[:, 1] > 1.0
    assert np.count_nonzero(np.diff(inside.astype(int)) == 1) == 3
    ratio = air[inside, 0] / air[inside, 1]
    assert np.ptp(ratio) == pytest.approx(0.0, abs=1e-9)
    assert (
        Exhaust(2.0, 0.875, 0.0, 0.0).per_co2[0] <= ratio[0] <= Exhaust(2.0, 0.85, 0, 0).per_co2[0]
    )
    # In the middle between passes: none of them within a fifth of an interval.
    peaks = flight.time[np.flatnonzero(np.diff(np.sign(np.diff(air[:, 1]))) < 0) + 1]
    far = np.min(np.abs(peaks[:, np.newaxis] - flight.middle), axis=1)
    assert np.all(far > 0.2 * flight.interval_s)


def test_a_change_of_fuel_multiplies_the_content_by_five_within_the_range_of_fuels():
    contents = [simulate(REGIMES["fuel_change"], 3, k).truth.contents_percent for k in range(20)]
    for first, last in contents:
        assert max(first, last) / min(first, last) == pytest.approx(5.0)
        assert 0.03 <= min(first, last) <= max(first, last) <= 2.75


def test_an_instrument_departs_from_its_data_sheet_as_its_regime_declares():
    def cells(name):
        instruments = (
            random_instrument(np.random.default_rng([7, k]), REGIMES[name]) for k in range(300)
        )
        return [(of.cells["so2"], of.stated["so2"], of.cells["co2"]) for of in instruments]

    ratios = {
        name: np.mean([so2.t90_s / stated["t90_s"] for so2, stated, _ in cells(name)])
        for name in ("quiet", "so2_slower", "so2_faster")
    }
    # 5 % over the root of 300.
    assert ratios["quiet"] == pytest.approx(1.0, abs=0.012)
    assert ratios["so2_slower"] == pytest.approx(1.3 * ratios["quiet"])
    assert ratios["so2_faster"] == pytest.approx(0.7 * ratios["quiet"])
    late = np.array([so2.delay_s - stated["delay_s"] for so2, stated, _ in cells("so2_delay")])
    # 0.3 s beside 1.5 s; no delay is below 0.
    assert np.mean(np.abs(late) > 0.9) > 0.95
    assert (late > 0.9).any()
    assert (late < -0.9).any()
    noise = {(so2.noise, co2.noise) for so2, _, co2 in cells("noise_twice")}
    assert noise == {(5.0, 2.0)}
    assert all(0.2 <= so2.second_pole <= 0.5 for so2, *_ in cells("two_poles"))


def test_the_same_log_of_two_regimes_differs_by_the_disturbance_alone():
    quiet, hazy = simulate(QUIET, 4, 2), simulate(REGIMES["haze_5"], 4, 2)
    assert quiet.config == hazy.config
    assert np.array_equal(quiet.time, hazy.time)
    for gas in quiet.values.keys() - {"co2"}:
        assert np.array_equal(quiet.values[gas], hazy.values[gas])
    assert np.std(quiet.values["co2"] - hazy.values["co2"]) > 1.0


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
    flight = read_flight(tmp_path / f"{log.name}.csv", config)
    read = estimate(flight.readings, config.instrument)
    direct = estimate(readings_of(log), config.instrument)
    assert read.fsc_percent == pytest.approx(direct.fsc_percent, rel=1e-9)
    name, first, last, answerable = (tmp_path / "truth.csv").read_text().splitlines()[1].split(",")
    assert (name, answerable) == (log.name, "True")
    assert first == last == f"{log.truth.contents_percent[0]:.4f}"
