"""The guard is asked whether it would let a command pass at another speed, and answers for what it does next."""

import math
from collections import deque

import numpy as np
from gnc_cases import SPEED
from guard_cases import LAGS, TIME_STEP, aim_at_the_centre, make_guard, moved


@LAGS
def test_it_allows_what_it_would_let_pass_and_is_none_the_wiser_for_having_been_asked(lag, delay):
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
    # Head on, at just the distance from which it can still turn away; not so if it were half as fast again.
    far = next(
        distance for distance in np.arange(205.0, 400.0) if make_guard().allows(0.0, -distance, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0)
    )
    assert not make_guard().allows(0.0, -far, 0.0, 0.0, 0.0, 0.0, 1.5 * SPEED, 0.0)
    guard = make_guard()
    # It need not look for a while, and does so all the same before the vehicle becomes faster.
    guard.limit(0.0, -far - 60.0, 0.0, 0.0, 0.0, 0.0, SPEED, 0.0)
    free = guard.guard._free_steps
    assert guard.allows(0.0, -far - 60.0, 0.0, 0.0, 0.0, 0.0, 1.5 * SPEED, 0.0)
    assert 0 < guard.guard._free_steps < free
