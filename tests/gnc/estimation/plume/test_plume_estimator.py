"""The plume estimate: its cells, symmetry, silence and absence, consistency, and broken sensors."""

import math
from dataclasses import replace

import numpy as np
import pytest
from exhaust_cases import PRIOR, SENSOR, MadePlume, estimated

from gnc.estimation.plume.estimator import PlumeEstimator, PlumeState, random_walk
from gnc.estimation.plume.passes import SensorState
from gnc.estimation.plume.prior import BACKGROUND_DRIFT, BEARING_DRIFT, HEIGHT_DRIFT

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
