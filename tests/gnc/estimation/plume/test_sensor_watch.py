"""A sensor that does not work, by its readings."""

import numpy as np

from gnc.estimation.plume.sensor_watch import SensorState, SensorWatch


def _watch() -> SensorWatch:
    return SensorWatch(interval=1.0, saturated=5000.0)


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
