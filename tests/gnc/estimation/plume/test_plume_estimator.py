"""The plume estimate: symmetry, what silence and absence say, consistency, and sensors that do not
work.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from exhaust_cases import PRIOR, SENSOR, MadePlume, estimated

from gnc.errors import InfeasibleError
from gnc.estimation.plume.estimator import PlumeEstimator, PlumeState
from gnc.estimation.plume.passes import SensorState
from gnc.estimation.plume.prior import BACKGROUND_DRIFT, BEARING_DRIFT, HEIGHT_DRIFT

AROUND = [65.0, 72.0, 58.0, 68.0, 62.0, 70.0]
"""Altitudes of passes about the expected height [m]."""


def test_without_a_reading_the_estimate_stays_the_prior() -> None:
    estimator = PlumeEstimator(PRIOR)
    for i in range(1200):
        estimator.predict(0.1)
        assert not estimator.update(230.0, 60.0 * math.cos(0.07 * i), 50.0, math.nan)
    assert estimator.state is PlumeState.SEARCHING
    assert estimator.passes == 0
    # Drift is reckoned with the next pass, and there was none.
    assert np.array_equal(estimator.cells, estimator.grid.prior)
    assert np.array_equal(estimator.bearings, estimator.grid.bearing_prior)


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


def test_a_constant_background_says_nothing() -> None:
    prior = replace(PRIOR, sensor=replace(SENSOR, noise=0.5))

    def with_background(level: float) -> PlumeEstimator:
        estimator = PlumeEstimator(prior)
        update = estimator.update

        def shifted(along: float, across: float, altitude: float, reading: float) -> bool:
            return update(along, across, altitude, reading + level)

        estimator.update = shifted  # type: ignore[method-assign, assignment]
        MadePlume(height=70.0).fly(estimator, AROUND)
        return estimator

    usual, more = with_background(0.0), with_background(150.0)
    # The first level is only known to 1000 ppm, so that a shift of 150 ppm leaves rounding.
    assert more.height == pytest.approx(usual.height, abs=0.01)
    assert more.offset == pytest.approx(usual.offset, abs=0.01)


def test_places_in_between_readings_do_not_change_the_estimate() -> None:
    """The path is interpolated: places at 20 Hz say what places at 10 Hz say."""
    dense, sparse = PlumeEstimator(PRIOR), PlumeEstimator(PRIOR)
    plume = MadePlume(height=70.0, meander=0.0)
    plume.fly(dense, AROUND)
    update, calls = sparse.update, iter(range(10**6))

    def every_other(along: float, across: float, altitude: float, reading: float) -> bool:
        return next(calls) % 2 == 0 and update(along, across, altitude, reading)

    sparse.update = every_other  # type: ignore[method-assign, assignment]
    plume.fly(sparse, AROUND)
    # Turns are found a step later, and the way between is a chord: less than 0.1 m.
    assert sparse.height == pytest.approx(dense.height, abs=0.5)


def test_absence_moves_the_estimate_away_from_the_flown_height() -> None:
    estimator = PlumeEstimator(PRIOR)
    grid = estimator.grid
    near = np.abs(grid.height - 60.0) < 8.0
    before, chance = estimator.cells[:, near].sum(), estimator.detection(60.0)
    MadePlume(height=60.0, peak=0.0).fly(estimator, [60.0] * 4)
    assert estimator.state is PlumeState.SEARCHING
    assert estimator.cells[:, near].sum() < 0.2 * before
    assert estimator.detection(60.0) < 0.3 * chance
    # What is left lies above and below, and the best height to fly with it.
    altitudes = np.linspace(20.0, 120.0, 51)
    best = altitudes[
        int(np.argmax([estimator.detection(float(altitude)) for altitude in altitudes]))
    ]
    assert abs(best - 60.0) > 8.0


def test_absence_in_next_to_no_apparent_wind_says_what_it_says_in_one_of_a_metre_a_second() -> None:
    def missed(wind: float) -> PlumeEstimator:
        estimator = PlumeEstimator(PRIOR)
        for i in range(600):
            estimator.predict(0.05)
            reading = 420.0 + SENSOR.noise * math.sin(1.7 * i) if i % 4 == 0 else math.nan
            estimator.update(
                230.0, 60.0 * math.cos(math.pi * i / 180.0), 65.0, reading, apparent_wind=wind
            )
        assert estimator.passes == 3
        return estimator

    # The floor of rise and spreads, below which a plume has no direction: nor is it any stronger.
    slow = missed(1.0)
    for wind in (0.3, 0.0):
        estimator = missed(wind)
        assert np.array_equal(estimator.cells, slow.cells)
        assert estimator.detection(65.0) == slow.detection(65.0)
    # A wind that is measured counts, and not the one that was expected.
    assert not np.array_equal(missed(PRIOR.apparent_wind).cells, slow.cells)


def test_a_plume_that_does_not_meander_is_placed_within_metres() -> None:
    estimator = estimated(MadePlume(height=74.0, offset=-15.0, meander=0.0), AROUND)
    assert estimator.state is PlumeState.FOUND
    # The filter takes a meander of 4 m and an error of strength of 25 % for granted, and 6 passes.
    assert estimator.height == pytest.approx(74.0, abs=4.0)
    # The cells of bearing are 10 m wide, and the meander across is 5 m.
    assert estimator.offset == pytest.approx(-15.0, abs=5.0)


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


def test_innovations_are_those_of_a_consistent_filter() -> None:
    estimator = estimated(MadePlume(height=68.0), AROUND)
    # Chances of a hit are near 1, where squares are 0.02 unless there is a miss.
    assert 0.0 < estimator.innovation < 0.2
    # And of one that reckons with a plume elsewhere, far above one, which it begins with: there are
    # misses where hits are sure.
    assert estimated(MadePlume(height=68.0, peak=0.0), AROUND).innovation > 2.0


def test_a_plume_that_goes_is_lost_again() -> None:
    estimator = estimated(MadePlume(height=65.0), AROUND)
    assert estimator.state is PlumeState.FOUND
    MadePlume(height=65.0, peak=0.0).fly(estimator, [estimator.height] * 6)
    assert estimator.state is PlumeState.LOST
    MadePlume(height=65.0).fly(estimator, [65.0] * 3)
    assert estimator.state is PlumeState.FOUND


def test_a_single_miss_does_not_lose_a_plume() -> None:
    estimator = estimated(MadePlume(height=65.0), AROUND)
    # Beside its edge a miss is no wonder, and one in its middle may be meander.
    MadePlume(height=65.0, peak=0.0).fly(estimator, [85.0])
    assert estimator.state is PlumeState.FOUND


def test_the_interval_leaves_a_fortieth_on_either_side() -> None:
    # Passes at the distance and in the wind of the prior: heights are those of the cells.
    estimator = estimated(MadePlume(height=68.0), [65.0])
    heights, of_heights = estimator.grid.height, estimator.cells.sum(axis=(0, 2))
    step = heights[1] - heights[0]
    low, high = estimator.height_interval
    # Each cell is as likely anywhere between its edges.
    below = of_heights @ np.clip(0.5 + (low - heights) / step, 0.0, 1.0)
    above = of_heights @ np.clip(0.5 - (high - heights) / step, 0.0, 1.0)
    assert (below, above) == pytest.approx((0.025, 0.025), abs=1e-9)


@pytest.mark.parametrize("altitude", [45.0, 65.0, 90.0])
def test_the_chance_of_a_detection_is_that_of_centres_drawn_at_random(altitude: float) -> None:
    estimator, generator, count = (
        estimated(MadePlume(height=68.0, peak=20.0), [65.0]),
        np.random.default_rng(3),
        200_000,
    )
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


def test_a_pass_in_which_the_sensor_failed_says_nothing() -> None:
    """The last third of each pass is stuck at 100 ppm more than clean air, which looks like the
    edge of a plume.
    """
    estimator, generator = PlumeEstimator(PRIOR), np.random.default_rng(7)
    before = estimator.cells.copy()
    for i in range(round(4.0 * 18.0 / 0.1)):
        estimator.predict(0.1)
        stuck = (0.1 * i) % 9.0 > 6.0
        reading = 520.0 if stuck else 420.0 + SENSOR.noise * generator.standard_normal()
        estimator.update(
            230.0,
            60.0 * math.cos(math.pi * 0.1 * i / 9.0),
            65.0,
            reading if i % 2 == 0 else math.nan,
        )
    assert estimator.passes > 4
    assert estimator.state is PlumeState.SEARCHING
    # Only the drift of a minute is left.
    assert np.abs(estimator.cells - before).max() < 0.1 * before.max()


def test_a_sensor_that_comes_back_is_believed_again() -> None:
    estimator = PlumeEstimator(PRIOR)
    MadePlume(height=65.0).fly(estimator, [65.0] * 2, broken=420.0)
    assert estimator.sensor is SensorState.STUCK
    MadePlume(height=65.0).fly(estimator, AROUND)
    assert estimator.sensor is SensorState.WORKING
    assert estimator.state is PlumeState.FOUND


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


def test_a_plume_above_the_limits_cannot_be_measured() -> None:
    assert PlumeEstimator(PRIOR).measurable > 0.9
    above = replace(PRIOR, height=190.0, height_deviation=8.0, source_deviation=5.0, highest=120.0)
    assert PlumeEstimator(above).measurable < 0.05


def test_the_height_is_that_at_the_place_and_in_the_wind_of_the_pass() -> None:
    """In half the apparent wind the plume rises twice as much: Briggs, 1/U."""
    estimator = PlumeEstimator(PRIOR)
    risen = float(PRIOR.rise_of(65.0))
    twice = float(PRIOR.height_at(np.array(65.0), PRIOR.distance, 0.5 * PRIOR.apparent_wind))
    assert twice == pytest.approx(65.0 + risen)
    farther = float(PRIOR.height_at(np.array(65.0), 8.0 * PRIOR.distance, PRIOR.apparent_wind))
    assert farther == pytest.approx(65.0 + 3.0 * risen)  # 8^(2/3) = 4
    assert estimator.height == pytest.approx(65.0, abs=0.5)


def test_limits_without_room_are_refused_in_one_line() -> None:
    with pytest.raises(InfeasibleError, match="must be above the first"):
        replace(PRIOR, lowest=80.0, highest=60.0)


def test_a_pass_ahead_of_the_ship_says_nothing() -> None:
    estimator = PlumeEstimator(PRIOR)
    generator = np.random.default_rng(4)
    before = estimator.cells.copy()
    for i in range(600):
        estimator.predict(0.1)
        reading = 420.0 + generator.standard_normal() if i % 2 == 0 else math.nan
        estimator.update(-150.0, 60.0 * math.cos(0.35 * 0.1 * i), 65.0, reading)
    assert estimator.passes > 4
    assert estimator.height == pytest.approx(PRIOR.height, abs=0.5)
    assert np.abs(estimator.cells - before).max() < 0.1 * before.max()


@pytest.mark.parametrize("name", ["interval", "time_constant", "noise"])
def test_a_sensor_without_noise_or_lag_is_refused(name: str) -> None:
    with pytest.raises(InfeasibleError, match=f"{name} of the CO2 sensor is 0"):
        replace(SENSOR, **{name: 0.0})
