"""A sensor that does not work, by its readings."""

import math

import numpy as np
import pytest

from gnc.estimation.plume.prior import GasSensor
from gnc.estimation.plume.sensor_watch import SensorState, SensorWatch, equal_readings


def _sensor(noise: float = 1.0, resolution: float = 0.1) -> GasSensor:
    return GasSensor(
        interval=1.0,
        delay=0.0,
        time_constant=1.0,
        noise=noise,
        saturated=5000.0,
        resolution=resolution,
    )


def _watch() -> SensorWatch:
    return SensorWatch(_sensor())


def test_noise_is_that_of_a_working_sensor() -> None:
    watch, generator = _watch(), np.random.default_rng(0)
    for _ in range(500):
        watch.wait(1.0)
        # Rounded to 0.1 at a noise of 1: neighbours are equal once in 35, ten in a row never.
        watch.read(round(420.0 + generator.standard_normal(), 1))
        assert watch.state is SensorState.WORKING


def test_ten_equal_readings_are_those_of_a_stuck_sensor() -> None:
    watch = _watch()
    for _ in range(9):
        watch.read(420.0)
    assert watch.state is SensorState.WORKING
    watch.read(420.0)
    assert watch.state is SensorState.STUCK
    watch.read(421.0)
    assert watch.state is SensorState.WORKING


def test_no_reading_for_five_intervals_is_silence() -> None:
    watch = _watch()
    watch.read(420.0)
    watch.wait(4.9)
    assert watch.state is SensorState.WORKING
    watch.wait(0.2)
    assert watch.state is SensorState.SILENT
    watch.read(421.0)
    assert watch.state is SensorState.WORKING


def test_a_reading_at_the_end_of_the_range_is_saturated() -> None:
    watch = _watch()
    watch.read(5000.0)
    assert watch.state is SensorState.SATURATED
    watch.read(4999.0)
    assert watch.state is SensorState.WORKING


@pytest.mark.parametrize("noise", [0.2, 0.3, 0.5])
def test_readings_that_are_coarser_than_their_noise_are_those_of_a_working_sensor(
    noise: float,
) -> None:
    """Clean air at a multiple of the step, where readings of noise 0.3 are the same in 90 % of all
    cases: 10 in a row are usual.
    """
    watch, generator = SensorWatch(_sensor(noise, 1.0)), np.random.default_rng(1)
    for reading in np.round(420.0 + noise * generator.standard_normal(10_000)):
        watch.read(float(reading))
        assert watch.state is SensorState.WORKING


def test_a_sensor_with_coarse_readings_that_sticks_is_found_later() -> None:
    # erf(1/(2 sqrt(2) 0.5)) = 0.6827 of a normal distribution lie within one deviation; 0.6827^73 =
    # 7.8e-13, 0.6827^72 = 1.1e-12.
    watch = SensorWatch(_sensor(0.5, 1.0))
    for _ in range(72):
        watch.read(420.0)
    assert watch.state is SensorState.WORKING
    watch.read(420.0)
    assert watch.state is SensorState.STUCK


def test_noise_that_never_shows_says_nothing_of_equal_readings() -> None:
    assert equal_readings(_sensor(0.01, 1.0)) == math.inf
