"""The search for a plume: limits, the soonest height, probing, and the ladder."""

import math

import numpy as np
import pytest
from exhaust_cases import PRIOR, MadePlume, estimated

from gnc.estimation.plume.estimator import HIT, PlumeEstimator, PlumeState
from gnc.mission.plume_search import HeightSearch, LadderSearch

LOW, HIGH = 20.0, 120.0

PASS_TIME = 9.0


def _search(climb_rate: float = 1.5, lowest: float = LOW, highest: float = HIGH) -> HeightSearch:
    return HeightSearch(lowest=lowest, highest=highest, climb_rate=climb_rate)


def test_a_search_begins_where_the_plume_is_most_likely() -> None:
    altitude = _search().next_altitude(PlumeEstimator(PRIOR), 65.0, PASS_TIME)
    # The heights that are weighed are 6 m apart, and the plume's spread is 9 m.
    assert altitude == pytest.approx(65.0, abs=9.0)


def test_a_search_leaves_a_height_at_which_nothing_was_detected() -> None:
    estimator = PlumeEstimator(PRIOR)
    MadePlume(height=65.0, peak=0.0).fly(estimator, [65.0] * 4)
    assert abs(_search().next_altitude(estimator, 65.0, PASS_TIME) - 65.0) > 8.0


def test_the_demanded_height_has_the_least_expected_time_to_find() -> None:
    """Against the definition: passes on the way and there, misses independent given a cell."""
    estimator, climb = PlumeEstimator(PRIOR), 1.5 * PASS_TIME
    MadePlume(height=100.0, peak=0.0).fly(estimator, [62.0] * 2)
    heights = np.linspace(LOW, HIGH, 18)

    def still_searching(target: float) -> float:
        missed, total = 1.0, 0.0
        for k in range(1, 9):
            altitude = 62.0 + min(max(target - 62.0, -climb * k), climb * k)
            nearest = heights[int(np.abs(heights - altitude).argmin())]
            weights, chances = estimator.prospects(np.array([nearest]))
            missed = missed * (1.0 - chances[0])
            total += float(np.sum(weights * missed))
        return total

    best = min(heights.tolist(), key=still_searching)
    assert _search().next_altitude(estimator, 62.0, PASS_TIME) == pytest.approx(best)


@pytest.mark.parametrize(("lowest", "highest"), [(20.0, 120.0), (80.0, 90.0), (20.0, 45.0)])
def test_demands_keep_within_the_limits(lowest: float, highest: float) -> None:
    estimator = PlumeEstimator(PRIOR)
    for search in (_search(1.5, lowest, highest), LadderSearch(lowest=lowest, highest=highest)):
        altitude = 0.5 * (lowest + highest)
        for _ in range(12):
            altitude = search.next_altitude(estimator, altitude, PASS_TIME)
            assert lowest <= altitude <= highest
    found = estimated(MadePlume(height=65.0), [65.0, 72.0])
    assert lowest <= _search(1.5, lowest, highest).next_altitude(found, 65.0, PASS_TIME) <= highest


def test_an_uncertain_height_is_probed_and_a_known_one_flown() -> None:
    vague = estimated(MadePlume(height=65.0), [65.0])
    assert vague.state is PlumeState.FOUND
    probing = _search().next_altitude(vague, 65.0, PASS_TIME)
    spread = math.hypot(vague.sigma_z, PRIOR.meander_z)
    assert vague.height_deviation > 0.5 * spread
    # One pass leaves open on which side the axis is: beside the estimate, but not where the plume
    # is missed.
    assert 0.1 * spread < abs(probing - vague.height) <= 1.5 * spread
    sure = estimated(MadePlume(height=65.0), [65.0, 74.0, 56.0, 65.0, 74.0, 56.0, 65.0, 72.0])
    # Between known and vague there is little to be gained off the estimate, and none where the
    # deviation is small.
    assert abs(_search().next_altitude(sure, 65.0, PASS_TIME) - sure.height) < 0.3 * spread
    sure.height_deviation = 0.1 * spread
    assert _search().next_altitude(sure, 65.0, PASS_TIME) == pytest.approx(sure.height)


def test_the_height_that_is_flown_has_the_most_hits_in_it_and_in_what_it_says() -> None:
    """Against the definition: hits now, and three at the deviation that is expected after it."""
    estimator = estimated(MadePlume(height=75.0), [65.0, 65.0])
    demanded = _search().next_altitude(estimator, 65.0, PASS_TIME)
    around = estimator.height + estimator.height_deviation * np.linspace(-1.6, 1.6, 9)
    reach = estimator.sigma_z * math.sqrt(-2.0 * math.log(HIT))

    def worth(altitude: float) -> float:
        at = np.array([altitude])
        off = math.hypot(float(estimator.expected_deviation(at)[0]), PRIOR.meander_z)
        return float(estimator.hits(at)[0]) + 3.0 * math.erf(reach / off / math.sqrt(2.0))

    assert demanded == pytest.approx(max(around.tolist(), key=worth))


def test_hits_are_those_of_centres_drawn_at_random() -> None:
    estimator = estimated(MadePlume(height=68.0), [65.0, 74.0, 56.0])
    generator, altitudes = np.random.default_rng(4), np.array([50.0, 66.0, 80.0])
    weights = estimator._weights.sum(axis=1)
    axes = generator.choice(len(weights), 100_000, p=weights / weights.sum())
    heights = estimator.grid.coarse_heights(estimator._heights)[axes]
    # The made ways are square to the plume in its frame, and have a correlation length of a
    # kilometre: one look.
    centres = heights + PRIOR.meander_z * generator.standard_normal(len(axes))
    for altitude, chance in zip(altitudes, estimator.hits(altitudes), strict=True):
        peak = np.exp(-0.5 * ((altitude - centres) / estimator._spread[axes]) ** 2)
        # A share of 100,000 has a deviation of at most 0.0016.
        assert chance == pytest.approx(float(np.mean(peak > HIT)), abs=0.01)


def test_a_ladder_goes_up_and_down_between_its_ends() -> None:
    search, estimator, altitude = (
        LadderSearch(lowest=20.0, highest=120.0),
        PlumeEstimator(PRIOR),
        65.0,
    )
    steps = []
    for _ in range(10):
        altitude = search.next_altitude(estimator, altitude, PASS_TIME)
        steps.append(altitude)
    assert steps == [80.0, 95.0, 110.0, 95.0, 80.0, 65.0, 50.0, 35.0, 50.0, 65.0]
