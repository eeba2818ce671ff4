"""The search for the reversal in which an aircraft strays farthest from its response."""

import math
from dataclasses import replace

import numpy as np
import pytest

from aircraft.fleet.x8 import X8
from innerloop.designs.long_search import PART, repeat_search
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from innerloop.flight.reversal_search import _deviation, _predicted, reversals_of_a_design, search_reversals
from innerloop.flight.turn_reversal import TurnReversalResponse, measure_turn_reversal

REVERSALS = 12


@pytest.fixture
def flown(x8_schedule, x8_aircraft, x8_root):
    """Return the response of the X8 at the bank of its studies, and a function that searches a few reversals of a new one."""
    level, bank = x8_schedule.level(x8_schedule.middle), X8.envelope.bank
    measured = measure_turn_reversal(x8_aircraft, level, bank)

    def flown(response=measured, seed=0):
        return search_reversals(AutopilotedAircraft(X8, x8_root), level, bank, response, reversals=REVERSALS, seed=seed)

    return measured, flown


def test_it_finds_a_deviation_and_the_same_for_the_same_seed(flown):
    _, search = flown
    found = search()
    assert 0.0 < found.usual <= found.deviation
    # Of a turn radius of 38 m; measured 1.5 to 6 m.
    assert found.deviation < 10.0
    assert found.reversals == REVERSALS
    assert X8.envelope.airspeed_min < found.airspeed_before < X8.envelope.airspeed_max
    assert abs(found.command_before) <= 1.0
    assert search() == found
    assert search(seed=1) != found


def test_of_a_response_that_is_slower_than_the_aircraft_it_strays_less(flown):
    response, search = flown
    slow = replace(response, delay=2.0 * response.delay, lag=2.0 * response.lag)
    fast = replace(response, delay=0.5 * response.delay, lag=0.5 * response.lag)
    assert search(slow).deviation <= search().deviation < search(fast).deviation


def test_a_vehicle_of_just_that_response_is_predicted():
    # Half a reversal by hand: after 0.5 s the heading rate goes from -0.5 to 0.5 rad/s with a lag of 0.4 s, at 20 m/s.
    response, steps = TurnReversalResponse(delay=0.5, lag=0.4), 480
    path = _predicted(response, [-0.5] * 60 + [0.5], 0.3, 20.0, -0.5, steps)
    time = np.arange(1, steps + 1) / 120.0
    late = np.maximum(time - 0.5, 0.0)
    course = 0.3 - 0.5 * np.minimum(time, 0.5) + 0.5 * late - 0.4 * (1.0 - np.exp(-late / 0.4))
    expected = np.cumsum(np.column_stack([np.cos(course), np.sin(course)]), axis=0) * 20.0 / 120.0
    # Rates held over steps of 1/120 s: half a step of turning at 1 rad/s, over 80 m.
    np.testing.assert_allclose(path, expected, rtol=0.0, atol=0.35)


def test_the_deviation_is_the_way_that_is_lacking_in_the_direction_of_the_turn():
    # Northbound; to the right, away is east, or up to 60 degrees forward of it. 3 m less of the east, and 1 m more of the north.
    north = np.arange(1.0, 101.0)
    predicted = np.column_stack([north, np.zeros(100)])
    flown = predicted + np.outer(np.linspace(0.0, 1.0, 100), [1.0, -3.0])
    assert _deviation(flown, predicted, 1.0) == pytest.approx(3.0, rel=1e-12)
    # To the left the same is a gain in the west, and a lack of none of the directions.
    assert _deviation(flown, predicted, -1.0) <= 0.0
    # 2 m behind: by 30 and 60 degrees forward of abeam, that is sin(60 deg) of it.
    behind = predicted - np.outer(np.linspace(0.0, 1.0, 100), [2.0, 0.0])
    assert _deviation(behind, predicted, 1.0) == pytest.approx(2.0 * math.sin(math.radians(60.0)), rel=1e-12)


@pytest.mark.parametrize(("bank_deg", "airspeed", "expected"), [(45.0, 19.42, 100), (30.0, 76.5, 24), (25.0, 144.6, 20)])
def test_a_design_flies_as_many_reversals_as_a_thousand_seconds_hold(bank_deg, airspeed, expected):
    # A quarter of a turn takes pi/2 V/(g tan(bank)): 3.1, 21 and 50 s, and twice that with what comes before it; 20 to 100.
    assert reversals_of_a_design(math.radians(bank_deg), airspeed) == expected


def test_a_repeated_search_is_told_of_part_by_part_and_counts_all(designs, x8_root):
    told = []
    found = repeat_search(designs("x8"), x8_root, PART + 2, done=lambda count, deviation: told.append((count, deviation)))
    assert found["reversals"] == PART + 2
    assert len(told) == 2
    assert told[-1] == (PART + 2, found["deviation_max_m"])
