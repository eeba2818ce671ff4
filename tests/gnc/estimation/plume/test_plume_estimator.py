"""The plume estimate and its passes: symmetry, silence and absence, consistency, pulses, sensors."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from exhaust_cases import PRIOR, SENSOR, MadePlume, estimated

from gnc.estimation.plume.estimator import PlumeEstimator, PlumeState, random_walk
from gnc.estimation.plume.passes import PassReader, Path, SensorState, SensorWatch
from gnc.estimation.plume.prior import BACKGROUND_DRIFT, BEARING_DRIFT, HEIGHT_DRIFT, GasSensor

AROUND = [65.0, 72.0, 58.0, 68.0, 62.0, 70.0]
"""Altitudes of passes about the expected height [m]."""


def test_after_a_silence_a_plume_that_was_found_is_known_as_little_as_it_has_drifted() -> None:
    estimator = estimated(MadePlume(height=68.0, offset=12.0), AROUND)
    known = estimator.height_deviation, estimator.bearing_deviation
    silence = 300.0
    for i in range(round(silence / 0.1)):
        estimator.predict(0.1)
        estimator.update(230.0, 60.0 * math.cos(0.035 * i), 68.0, math.nan)
    # A pass ahead of the ship says nothing, and drift is reckoned with it.
    MadePlume(height=68.0, peak=0.0, prior=replace(PRIOR, distance=10.0)).fly(estimator, [68.0])
    drifts = HEIGHT_DRIFT * math.sqrt(silence), BEARING_DRIFT * math.sqrt(silence)
    # 1/6000 per second of the prior beside it, and some seconds of passes: a tenth and a quarter
    # more.
    found = estimator.height_deviation, estimator.bearing_deviation
    for before, drift, after in zip(known, drifts, found, strict=True):
        assert math.hypot(before, drift) * 0.99 < after < 1.25 * math.hypot(before, drift)


def test_a_mirrored_flight_has_the_mirrored_estimate() -> None:
    plume = MadePlume(height=70.0, offset=12.0)
    straight, mirrored = PlumeEstimator(PRIOR), PlumeEstimator(PRIOR)
    plume.fly(straight, AROUND)
    plume.fly(mirrored, AROUND, mirrored=True)
    # Rounding alone is left.
    assert mirrored.offset == pytest.approx(-straight.offset, abs=1e-6)
    assert mirrored.height == pytest.approx(straight.height, abs=1e-6)
    assert straight.offset > 5.0


def test_stated_intervals_hold_the_truth() -> None:
    generator = np.random.default_rng(20)
    inside, squares = [], []
    for seed in range(40):
        plume = MadePlume(
            height=PRIOR.height + PRIOR.height_deviation * generator.standard_normal(),
            offset=PRIOR.distance * PRIOR.bearing_deviation * generator.standard_normal(),
            peak=PRIOR.peak * math.exp(PRIOR.peak_deviation * generator.standard_normal()),
            seed=seed,
        )
        estimator = estimated(plume, AROUND)
        low, high = estimator.height_interval
        inside.append(low <= plume.height <= high)
        squares.append(((estimator.height - plume.height) / estimator.height_deviation) ** 2)
    # 40 cases at 95 %: fewer than 34 happen once in 300.
    assert sum(inside) >= 34
    # The mean of 40 squares of unit variance is 1 +- 0.22; the filter allows for more than the made
    # plume has.
    assert 0.3 < np.mean(squares) < 1.7


@pytest.mark.parametrize("altitude", [45.0, 65.0, 90.0])
def test_the_chance_of_a_detection_is_that_of_centres_drawn_at_random(altitude: float) -> None:
    estimator = estimated(MadePlume(height=68.0, peak=20.0), [65.0])
    generator = np.random.default_rng(3)
    count = 200_000
    grid, shape = estimator.grid, estimator.cells.shape
    spread, height, strength = np.unravel_index(
        generator.choice(estimator.cells.size, count, p=estimator.cells.ravel()), shape
    )
    off = grid.height[height] + PRIOR.meander_z * generator.standard_normal(count) - altitude
    read = grid.strength[strength] * np.exp(-0.5 * (off / grid.sigma_z[spread, height]) ** 2)
    # One look, at the cells' own distance. Steps of 0.5 in the logarithm of strength blur the least
    # that is detected.
    assert estimator.detection(altitude) == pytest.approx(
        np.mean(read > estimator.detectable), abs=0.01
    )
    assert 0.1 < estimator.detection(altitude) < 0.999


@pytest.mark.parametrize(
    ("broken", "state"),
    [(431.5, SensorState.STUCK), (5000.0, SensorState.SATURATED), (math.nan, SensorState.SILENT)],
)
def test_a_sensor_that_does_not_work_is_recognised_and_says_nothing(
    broken: float, state: SensorState
) -> None:
    estimator = PlumeEstimator(replace(PRIOR, sensor=replace(SENSOR, saturated=5000.0)))
    before = estimator.cells.copy()
    MadePlume(height=65.0).fly(estimator, [65.0] * 4, broken=broken)
    assert estimator.sensor is state
    assert estimator.state is PlumeState.SEARCHING
    # Only the drift of 45 s is left, 0.7 m of 12 m.
    assert np.abs(estimator.cells - before).max() < 0.05 * before.max()


@pytest.mark.parametrize("unread", ["silent", "ahead of the ship"])
def test_a_background_that_drifts_while_nothing_is_read_is_no_plume(unread: str) -> None:
    """Clean air, whose reading rises at the rate that the data sheet allows: 0.1 ppm/s, 12 times
    the noise in a minute.
    """
    for seed in range(5):
        estimator, generator = PlumeEstimator(PRIOR), np.random.default_rng(seed)
        for i in range(round(160.0 / 0.05)):
            time = 0.05 * i
            away = 40.0 < time < 100.0
            along = -230.0 if away and unread == "ahead of the ship" else 230.0
            reads = i % 4 == 0 and not (away and unread == "silent")
            reading = (
                420.0 + BACKGROUND_DRIFT * time + SENSOR.noise * generator.standard_normal()
                if reads
                else math.nan
            )
            estimator.predict(0.05)
            estimator.update(along, 60.0 * math.cos(math.pi * time / 9.0), 65.0, reading)
        assert estimator.state is PlumeState.SEARCHING


@pytest.mark.parametrize("steps", [0.0, 0.1, 0.5, 0.7, 10.0])
def test_a_random_walk_has_the_variance_that_it_should_and_loses_nothing(steps: float) -> None:
    cells = np.zeros((3, 201))
    cells[:, 100] = [0.2, 0.3, 0.5]
    found = random_walk(cells, 1, steps)
    assert found.sum(axis=1) == pytest.approx(cells.sum(axis=1), rel=1e-12)
    assert found.min() >= 0.0
    off = np.arange(201) - 100
    # Exact: each round moves a share by one step either way. At ten deviations from the ends,
    # rounding is left.
    assert found[2] @ off**2 / found[2].sum() == pytest.approx(steps, abs=1e-12)


_SPEED = 20.0


def _path(
    readings: Callable[[np.ndarray], np.ndarray] = np.zeros_like,
    *,
    begun: float = 0.0,
    first: float = 0.5,
    end: float = 9.0,
    sign: float = 1.0,
    seed: int = 0,
) -> Path:
    """Return a straight way across at 20 m/s, on the axis after 4.5 s, and readings at 5 Hz."""
    time, read_at = np.arange(begun, end + 0.25, 0.25), np.arange(first, end, 0.2)
    across = sign * _SPEED * (time - begun - 4.5)
    noise = SENSOR.noise * np.random.default_rng(seed).standard_normal(len(read_at))
    values = 420.0 + noise + readings(read_at)
    return Path(time, np.full_like(time, 230.0), across, np.full_like(time, 60.0), read_at, values)


def _lagged(air: np.ndarray) -> np.ndarray:
    """Return what the sensor's lag makes of the air, by its convolution in steps of 1 ms."""
    lagged, decay = np.empty_like(air), math.exp(-1e-3 / SENSOR.time_constant)
    state = 0.0
    for i, value in enumerate(air.tolist()):
        state = decay * state + (1.0 - decay) * value
        lagged[i] = state
    return lagged


def _pulse(strength: float, *, place: float, spread: float = 9.0) -> Callable:
    """Return the readings of a Gaussian pulse on the first way of ``_path``, gone after it."""
    fine = np.arange(0.0, 18.0, 1e-3)
    across = _SPEED * (np.minimum(fine, 9.0) - 4.5)
    air = np.where(fine < 9.0, strength * np.exp(-0.5 * ((across - place) / spread) ** 2), 0.0)
    lagged = _lagged(air)
    return lambda read_at: np.interp(read_at, fine, lagged)


PLACES, SPREADS = np.linspace(-40.0, 40.0, 17), np.array([6.0, 9.0, 13.0])


def test_a_pulse_is_found_where_and_as_strong_as_it_is() -> None:
    evidence = PassReader(SENSOR).read(_path(_pulse(80.0, place=10.0)), PLACES, SPREADS)
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


@pytest.mark.parametrize("place", [0.0, 80.0])
def test_clean_air_after_a_plume_is_clean_air(place: float) -> None:
    """Its background has not risen, and the rest of the plume in the sensor is no second plume."""
    # The plume is gone by the turn, at 90 m: the second pass meets nothing.
    tail, places = SENSOR.time_constant, np.linspace(-80.0, 80.0, 33)
    pulse = _pulse(300.0, place=place)
    for seed in range(5):
        reader = PassReader(SENSOR)
        there = reader.read(_path(pulse, end=9.0 + tail, seed=seed), places, SPREADS)
        returning = _path(pulse, begun=9.0, first=9.1 + tail, end=18.0, sign=-1.0, seed=100 + seed)
        back = reader.read(returning, places, SPREADS)
        assert there is not None
        assert there.significance > 100.0
        assert back is not None
        # As of clean air, where one in a million exceeds 5; a tenth of what the tail is would.
        assert back.significance < 5.0
        assert back.peak < 5.0 * SENSOR.noise


@pytest.mark.parametrize("strength", [0.0, 80.0])
@pytest.mark.parametrize("rate", [-0.2, 0.0, 0.2])
def test_the_background_at_the_end_of_a_pass_is_what_its_pulse_leaves(
    rate: float, strength: float
) -> None:
    off, pulse = [], _pulse(strength, place=10.0)
    for seed in range(20):
        reader = PassReader(SENSOR)
        path = _path(lambda read_at: pulse(read_at) + rate * read_at, seed=seed)
        reader.read(path, PLACES, SPREADS)
        off.append((reader.level - 420.0 - rate * path.read_at[-1]) / reader.level_deviation)
    # A drift of twice what the data sheet allows as a deviation; the mean of 20 errors of unit
    # variance is 0.22 off at one sigma.
    assert abs(np.mean(off)) < 1.0
    assert np.sqrt(np.mean(np.square(off))) < 1.5


def _watch(noise: float = 1.0, resolution: float = 0.1) -> SensorWatch:
    return SensorWatch(
        GasSensor(
            interval=1.0,
            delay=0.0,
            time_constant=1.0,
            noise=noise,
            saturated=5000.0,
            resolution=resolution,
        )
    )


def test_a_sensor_that_is_stuck_silent_or_saturated_is_none_that_works() -> None:
    watch = _watch()
    # Ten equal readings, a reading at the end of the range, and none for five intervals.
    for reading, state in (
        *[(420.0, SensorState.WORKING)] * 9,
        (420.0, SensorState.STUCK),
        (421.0, SensorState.WORKING),
        (5000.0, SensorState.SATURATED),
        (4999.0, SensorState.WORKING),
    ):
        watch.read(reading)
        assert watch.state is state
    watch.wait(4.9)
    assert watch.state is SensorState.WORKING
    watch.wait(0.2)
    assert watch.state is SensorState.SILENT
    watch.read(421.0)
    assert watch.state is SensorState.WORKING


@pytest.mark.parametrize(("noise", "resolution"), [(1.0, 0.1), (0.2, 1.0), (0.3, 1.0), (0.5, 1.0)])
def test_noise_is_that_of_a_working_sensor_also_if_readings_are_coarser(
    noise: float, resolution: float
) -> None:
    """Clean air at a multiple of the step, where rounded readings of noise 0.3 are the same in 90 %
    of all cases: 10 in a row are usual.
    """
    watch, generator = _watch(noise, resolution), np.random.default_rng(1)
    for reading in 420.0 + noise * generator.standard_normal(10_000):
        watch.read(resolution * round(float(reading) / resolution))
        assert watch.state is SensorState.WORKING
