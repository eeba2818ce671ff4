"""The search for a plume: limits, the soonest height, probing, and the ladder."""

import math

import numpy as np
import pytest
from exhaust_cases import PRIOR, MadePlume, estimated

from gnc.estimation.plume_estimator import PlumeEstimator, PlumeState
from gnc.mission.plume_search import HeightSearch, LadderSearch

LOW, HIGH = 20.0, 120.0

PASS_TIME = 9.0


def _search(climb_rate: float = 1.5, lowest: float = LOW, highest: float = HIGH) -> HeightSearch:
    return HeightSearch(lowest=lowest, highest=highest, climb_rate=climb_rate)


def test_a_search_begins_where_the_plume_is_most_likely() -> None:
    demand = _search().next_demand(PlumeEstimator(PRIOR), 65.0, PASS_TIME)
    # The heights that are weighed are 6 m apart, and the plume's spread is 9 m.
    assert demand.altitude == pytest.approx(65.0, abs=9.0)
    assert demand.offset == pytest.approx(0.0, abs=1e-9)


def test_a_search_leaves_a_height_at_which_nothing_was_detected() -> None:
    estimator = PlumeEstimator(PRIOR)
    MadePlume(height=65.0, peak=0.0).fly(estimator, [65.0] * 4)
    assert abs(_search().next_demand(estimator, 65.0, PASS_TIME).altitude - 65.0) > 8.0


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
    assert _search().next_demand(estimator, 62.0, PASS_TIME).altitude == pytest.approx(best)


@pytest.mark.parametrize(("lowest", "highest"), [(20.0, 120.0), (80.0, 90.0), (20.0, 45.0)])
def test_demands_keep_within_the_limits(lowest: float, highest: float) -> None:
    estimator = PlumeEstimator(PRIOR)
    for search in (_search(1.5, lowest, highest), LadderSearch(lowest=lowest, highest=highest)):
        altitude = 0.5 * (lowest + highest)
        for _ in range(12):
            altitude = search.next_demand(estimator, altitude, PASS_TIME).altitude
            assert lowest <= altitude <= highest
    found = estimated(MadePlume(height=65.0), [65.0, 72.0])
    assert lowest <= _search(1.5, lowest, highest).next_demand(found, 65.0, PASS_TIME).altitude <= highest


def test_an_uncertain_height_is_probed_and_a_known_one_flown() -> None:
    vague = estimated(MadePlume(height=65.0), [65.0])
    assert vague.state is PlumeState.FOUND
    probing = _search().next_demand(vague, 65.0, PASS_TIME).altitude
    spread = math.hypot(vague.sigma_z, PRIOR.meander_z)
    assert vague.height_deviation > 0.5 * spread
    assert 0.1 * spread < abs(probing - vague.height) <= spread + 1e-9
    sure = estimated(MadePlume(height=65.0), [65.0, 74.0, 56.0, 65.0, 74.0, 56.0, 65.0, 72.0])
    assert sure.height_deviation < 0.5 * spread
    assert _search().next_demand(sure, 65.0, PASS_TIME).altitude == pytest.approx(sure.height)


def test_a_ladder_goes_up_and_down_between_its_ends() -> None:
    search, estimator, altitude = LadderSearch(lowest=20.0, highest=120.0, rung=20.0), PlumeEstimator(PRIOR), 65.0
    steps = []
    for _ in range(10):
        altitude = search.next_demand(estimator, altitude, PASS_TIME).altitude
        steps.append(altitude)
    assert steps == [85.0, 105.0, 85.0, 65.0, 45.0, 25.0, 45.0, 65.0, 85.0, 105.0]
