"""The guard is asked whether it would let a command pass at another speed, and answers for what it
does next.
"""

import math
from collections import deque

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import LAGS, RADIUS, TIME_STEP, aim_at_the_centre, make_guard, moved

from gnc.estimation.navigation import AirMotion


@LAGS
def test_it_allows_what_it_would_let_pass_and_asking_changes_nothing(lag, delay):
    velocity, answers = (0.3 * SPEED, 0.0), []
    guard, asked = make_guard(lag=lag, delay=delay), make_guard(lag=lag, delay=delay)
    state = (500.0, 40.0, math.pi, 0.0)
    under_way = deque([state[3]] * round(delay / TIME_STEP))
    for step in range(600):
        x, y, course, heading_rate = state
        motion = (x, y, *velocity, course, SPEED, heading_rate)
        want = aim_at_the_centre(step, x, y, course)
        allowed = asked.allows(want, *motion)
        command = guard.limit(want, *motion)
        assert asked.limit(want, *motion) == command
        assert allowed != guard.intervening
        answers.append(allowed)
        under_way.append(command)
        x, y, course, heading_rate = moved(state, under_way.popleft(), lag, TIME_STEP)
        state = (x - velocity[0] * TIME_STEP, y - velocity[1] * TIME_STEP, course, heading_rate)
    assert 50 < sum(answers) < 550


def test_what_is_allowed_at_a_speed_is_safe_at_that_speed_from_then_on():
    # Head on, at just the distance from which it can still turn away; not so if it were half as
    # fast again.
    far = next(
        distance
        for distance in np.arange(205.0, 400.0)
        if make_guard().allows(0.0, -distance, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0)
    )
    assert not make_guard().allows(0.0, -far, 0.0, 0.0, 0.0, 0.0, 1.5 * SPEED, 0.0)
    guard = make_guard()
    # It need not look for a while, and does so all the same before the vehicle becomes faster.
    guard.limit(0.0, -far - 60.0, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0)
    free = guard.guard._free.steps
    assert guard.allows(0.0, -far - 60.0, 0.0, 0.0, 0.0, 0.0, 1.5 * SPEED, 0.0)
    assert 0 < guard.guard._free.steps < free


@pytest.mark.parametrize("command", [0.0, 0.5 * HEADING_RATE_MAX, -0.5 * HEADING_RATE_MAX])
@pytest.mark.parametrize("bearing", [80.0, -80.0])
def test_to_ask_first_frees_no_more(bearing, command):
    # Beside the disc, so that a turn away is needed, and what commands may take from it is counted.
    motion = (-240.0, 0.0, 0.0, 0.0, math.radians(bearing), SPEED, 0.0)
    guard, asked = make_guard(), make_guard()
    assert guard.limit(command, *motion) == command
    assert asked.allows(command, *motion)
    assert asked.limit(command, *motion) == command
    assert guard.guard._free._towards != 0.0
    assert asked.guard._free._left == pytest.approx(guard.guard._free._left, abs=1e-12)
    assert asked.guard._free.steps == guard.guard._free.steps


def test_it_allows_nothing_that_a_slower_vehicle_could_not_turn_away_after():
    # Heading off from a disc that closes in at 0.8 of its speed: 12 m are left over, and at three
    # quarters of its speed 7 m lack.
    motion = (-215.0, 0.0, -0.8 * SPEED, 0.0, math.radians(120.0), SPEED, 0.0)
    for slowest, allowed in ((math.inf, True), (SPEED - 0.4, True), (0.75 * SPEED, False)):
        guard = make_guard()
        assert guard.allows(0.0, *motion, slowest=slowest) == allowed
        assert (guard.limit(0.0, *motion, slowest=slowest) == 0.0) == allowed
        assert guard.intervening != allowed


def test_it_remembers_of_a_fast_vehicle_no_more_than_it_can_turn():
    guard = make_guard(turn_speed=SPEED)
    for speed in (SPEED, 1.5 * SPEED):
        guard.limit(HEADING_RATE_MAX, 1000.0, 0.0, 0.0, 0.0, 0.0, speed, 0.0)
        # Flown at the largest bank; the command itself is passed on as it is.
        assert guard.guard._given.since[-1] == HEADING_RATE_MAX * SPEED / speed
    # One that may become faster, and is not, turns in full: taken for a slow turn it flew 9 m into
    # a disc of 10.
    own = AirMotion(ground_north=1000.0, ground_east=0.0, course=0.0, speed=SPEED)
    guard.guard.limit(HEADING_RATE_MAX, 0.1, own, 1.5 * SPEED, SPEED)
    assert guard.guard._given.since[-1] == HEADING_RATE_MAX


def test_what_it_does_not_allow_frees_nothing():
    guard = make_guard(deviation=3.1)
    motion = (-250.0, 0.0, 0.0, 0.0, math.radians(10.0))
    assert guard.limit(0.0, *motion, SPEED, 0.0) == 0.0
    assert guard.guard._free.steps > 0
    assert not guard.allows(-HEADING_RATE_MAX, *motion, 2.5 * SPEED, 0.0)
    # As fast as it was asked about it has to turn at once, to the other side.
    assert guard.limit(-HEADING_RATE_MAX, *motion, 2.5 * SPEED, 0.0) == HEADING_RATE_MAX
    assert guard.intervening


def test_a_command_that_is_not_a_number_is_not_passed_on_beside_the_area():
    guard = make_guard()
    answer = guard.limit(math.nan, -240.0, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0)
    assert abs(answer) == HEADING_RATE_MAX
    assert guard.intervening


@pytest.mark.parametrize("speed", [SPEED, 1.5 * SPEED])
def test_far_away_it_need_not_look_for_as_long_as_nothing_can_happen(speed):
    # Straight at each other, the disc speeding up all the while: at the end of that time, and no
    # later, a turn may be needed.
    acceleration = 0.3
    guard = make_guard(turn_speed=SPEED, acceleration=acceleration)

    def free_from(distance, closing):
        return guard.guard._free_when_far(
            (-distance, 0.0, -closing, 0.0, 0.0, speed, 0.0, RADIUS, 0.0, acceleration, 0.0, 0.0)
        )

    duration = 1.5 * math.pi / HEADING_RATE_MAX * speed / SPEED
    for distance in (800.0, 1000.0, 1200.0):
        free = free_from(distance, 5.0)
        then = distance - (speed + 5.0) * free - 0.5 * acceleration * free**2
        assert free_from(then, 5.0 + acceleration * free) >= -1e-9
        # What is left is what both can close in a full turn, which takes the longer the faster it
        # flies.
        assert free == 0.0 or then - RADIUS > (speed + 5.0 + acceleration * free) * duration
