"""Passes: where they end, and what their readings say of pulses."""

import math

import numpy as np
import pytest
from exhaust_cases import SENSOR

from gnc.estimation.plume.passes import (
    PassReader,
    Path,
    SensorState,
    SensorWatch,
)
from gnc.estimation.plume.prior import GasSensor

_SPEED = 20.0


def _path(readings: np.ndarray | None = None, *, duration: float = 9.0, seed: int = 0) -> Path:
    """Return a straight way across at 20 m/s, the axis half way, and readings at 5 Hz."""
    time = np.arange(0.0, duration + 0.5, 0.25)
    across = _SPEED * (time - 0.5 * duration)
    read_at = np.arange(0.5, duration, 0.2)
    noise = SENSOR.noise * np.random.default_rng(seed).standard_normal(len(read_at))
    values = 420.0 + noise + (0.0 if readings is None else readings)
    return Path(time, np.full_like(time, 230.0), across, np.full_like(time, 60.0), read_at, values)


def _lagged(air: np.ndarray) -> np.ndarray:
    """Return what the sensor's lag makes of the air, by its convolution in steps of 1 ms."""
    lagged, decay = np.empty_like(air), math.exp(-1e-3 / SENSOR.time_constant)
    state = 0.0
    for i, value in enumerate(air.tolist()):
        state = decay * state + (1.0 - decay) * value
        lagged[i] = state
    return lagged


def _pulse(read_at: np.ndarray, strength: float, *, place: float, spread: float) -> np.ndarray:
    """Return the readings of a Gaussian pulse on the way of ``_path``."""
    fine = np.arange(0.0, 9.0, 1e-3)
    air = strength * np.exp(-0.5 * ((_SPEED * (fine - 4.5) - place) / spread) ** 2)
    return np.interp(read_at, fine, _lagged(air))


PLACES, SPREADS = np.linspace(-40.0, 40.0, 17), np.array([6.0, 9.0, 13.0])


def test_a_pulse_is_found_where_and_as_strong_as_it_is() -> None:
    clean = _path()
    evidence = PassReader(SENSOR).read(
        _path(_pulse(clean.read_at, 80.0, place=10.0, spread=9.0)), PLACES, SPREADS
    )
    assert evidence is not None
    assert PLACES[evidence.at] == pytest.approx(10.0)
    gain = evidence.slope**2 / evidence.bend
    spread, place = np.unravel_index(gain.argmax(), gain.shape)
    assert (SPREADS[spread], place) == (9.0, evidence.at)
    # A step of 0.25 s of the path is half a spread.
    strength = evidence.slope[spread, place] / evidence.bend[spread, place]
    assert strength == pytest.approx(80.0, rel=0.05)
    # Through a lag of 0.43 s a pulse of 0.45 s keeps about two thirds of its peak.
    assert 0.5 * 80.0 < evidence.peak < 0.8 * 80.0


def test_clean_air_has_no_significant_pulse() -> None:
    # Of 17 places and 3 spreads some fit the noise; above 5 one in a million would.
    for seed in range(20):
        evidence = PassReader(SENSOR).read(_path(seed=seed), PLACES, SPREADS)
        assert evidence is not None
        assert evidence.significance < 5.0
        assert evidence.peak < 5.0 * SENSOR.noise


@pytest.mark.parametrize("place", [0.0, 80.0])
def test_clean_air_after_a_plume_is_clean_air(place: float) -> None:
    """Its background has not risen, and the rest of the plume in the sensor is no second plume."""
    duration, tail = 9.0, SENSOR.time_constant
    fine = np.arange(0.0, 2.0 * duration, 1e-3)
    # The plume is gone by the turn, at 90 m: the second pass meets nothing.
    across = _SPEED * (np.minimum(fine, duration) - 0.5 * duration)
    air = np.where(fine < duration, 300.0 * np.exp(-0.5 * ((across - place) / 9.0) ** 2), 0.0)
    lagged = _lagged(air)

    def path(begun: float, first: float, end: float, sign: float, seed: int) -> Path:
        time = np.arange(begun, end + 0.25, 0.25)
        read_at = np.arange(first, end, 0.2)
        noise = SENSOR.noise * np.random.default_rng(seed).standard_normal(len(read_at))
        way = sign * _SPEED * (time - begun - 0.5 * duration)
        return Path(
            time,
            np.full_like(time, 230.0),
            way,
            np.full_like(time, 60.0),
            read_at,
            420.0 + noise + np.interp(read_at, fine, lagged),
        )

    places = np.linspace(-80.0, 80.0, 33)
    for seed in range(5):
        reader = PassReader(SENSOR)
        there = reader.read(path(0.0, 0.5, duration + tail, 1.0, seed), places, SPREADS)
        back = reader.read(
            path(duration, duration + tail + 0.1, 2.0 * duration, -1.0, 100 + seed), places, SPREADS
        )
        assert there is not None
        assert there.significance > 100.0
        assert back is not None
        # As of clean air; a tenth of what the tail is would be above it.
        assert back.significance < 5.0
        assert back.peak < 5.0 * SENSOR.noise


@pytest.mark.parametrize("strength", [0.0, 80.0])
@pytest.mark.parametrize("rate", [-0.2, 0.0, 0.2])
def test_the_background_at_the_end_of_a_pass_is_what_its_pulse_leaves(
    rate: float, strength: float
) -> None:
    off = []
    for seed in range(20):
        reader, clean = PassReader(SENSOR), _path(seed=seed)
        pulse = _pulse(clean.read_at, strength, place=10.0, spread=9.0)
        reader.read(_path(pulse + rate * clean.read_at, seed=seed), PLACES, SPREADS)
        off.append((reader.level - 420.0 - rate * clean.read_at[-1]) / reader.level_deviation)
    # A drift of twice what the data sheet allows as a deviation; the mean of 20 errors of unit
    # variance is 0.22 off at one sigma.
    assert abs(np.mean(off)) < 1.0
    assert np.sqrt(np.mean(np.square(off))) < 1.5


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
