"""Between two looks of the keep-out guard: within a step, and while commands need no look."""

import copy
import math
from collections import deque

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX
from gnc_cases import SPEED as PAPER_SPEED
from guard_cases import (
    AT_REST,
    LAGS,
    TIME_STEP,
    DiscGuard,
    aim_at_the_centre,
    held_at_random,
    known_motion,
    moved,
    parameters_of,
    polar,
    random_start,
    relative_motion,
)

from gnc.estimation.vessel import Tube
from gnc.guard.guard import GuardStatus, HeadingRateFilter, SkipBudget
from gnc.guard.turn import TurnAway

SPEED = 20.0


@pytest.mark.slow
@pytest.mark.parametrize(("rate_hz", "heading_rate_max"), [(5.0, 0.49), (5.0, 0.58), (10.0, 0.85)])
def test_no_path_leads_in_within_a_wide_step(rate_hz, heading_rate_max):
    generator = np.random.default_rng(3)
    radius, step, nearest, intervened = 10.0, 1.0 / rate_hz, math.inf, 0
    parameters = parameters_of(
        radius=radius, heading_rate_max=heading_rate_max, lag=0.0, time_step=step
    )
    for _ in range(60):
        bearing = generator.uniform(-math.pi, math.pi)
        distance = generator.uniform(1.1, 8.0) * radius
        state = polar(distance, bearing, generator.uniform(-math.pi, math.pi))
        guard = HeadingRateFilter(parameters)
        if guard.clearance(0.0, known_motion(state), (AT_REST,), SPEED) < 0.0:
            continue
        for k in range(150):
            demanded = generator.uniform(-1.0, 1.0) * heading_rate_max
            if k % 4:
                demanded = aim_at_the_centre(k, *state[:3], heading_rate_max)
            command = guard.limit(demanded, k * step, known_motion(state), (AT_REST,), SPEED)
            for _ in range(20):
                state = moved(state, command, 0.0, step / 20.0, SPEED)
                nearest = min(nearest, math.hypot(*state[:2]))
            intervened += guard.status is not GuardStatus.FREE
    assert intervened > 100
    assert nearest >= radius


RATE, LAG, DELAY = 0.49, 0.26, 4 * TIME_STEP
"""Largest heading rate [rad/s], lag and dead time [s] of the vehicle of the next tests."""


def filter_of(**changes):
    return HeadingRateFilter(parameters_of(heading_rate_max=RATE, lag=LAG, delay=DELAY, **changes))


@pytest.mark.slow
@pytest.mark.parametrize("deviation", [0.0, 3.1, 19.7])
def test_a_command_that_passes_leaves_a_turn_with_the_deviation_that_its_change_adds(deviation):
    # A settled turn beside the disc; then a law that reverses it and steers inwards. The vehicle
    # has the guard's response.
    intervened, least = 0, math.inf
    for gap in (1.0, 5.0, 15.0, 30.0):
        guard = filter_of(radius=200.0, deviation=deviation)
        state = (0.0, 200.0 + gap + 2.0 * SPEED / RATE, 0.0, -RATE)
        under_way = deque([-RATE] * 4)
        command, inwards = 0.0, False
        for k in range(900):
            # It has come round to the disc on the settled turn.
            inwards = inwards or (k > 400 and state[1] < 200.0 + gap + 1.0)
            demanded = aim_at_the_centre(k, *state[:3], RATE) if inwards else -RATE
            # The turn away keeps off by all that a change of command before it takes; once begun
            # it is such a change itself.
            if k and not (guard.status is not GuardStatus.FREE and abs(command) == RATE):
                other = copy.copy(guard)
                other.history = copy.deepcopy(guard.history)
                clearance = other.clearance(k * TIME_STEP, known_motion(state), (AT_REST,), SPEED)
                least = min(least, clearance)
            command = guard.limit(demanded, k * TIME_STEP, known_motion(state), (AT_REST,), SPEED)
            under_way.append(command)
            state = moved(state, under_way.popleft(), LAG, TIME_STEP, SPEED)
            intervened += guard.status is not GuardStatus.FREE
            assert guard.status is not GuardStatus.LOST
    assert intervened > 0
    # To the resolution of the prediction.
    assert least >= -0.01


@LAGS
def test_looking_less_often_where_nothing_can_happen_changes_nothing(lag, delay):
    # A guard whose budget is always empty looks at every step, and lets the same commands pass.
    generator = np.random.default_rng(1)
    velocity = (0.6 * PAPER_SPEED, 0.0)
    skipped = 0
    for _ in range(2):
        guard, state = DiscGuard(lag=lag, delay=delay), random_start(generator)
        want = held_at_random(generator)
        under_way = deque([state[3]] * round(delay / TIME_STEP))
        for step in range(400):
            fresh = copy.deepcopy(guard)
            fresh.filter.budget.steps = 0
            skipped += guard.filter.budget.steps > 0
            command = guard.limit(want(step), state, velocity)
            assert fresh.limit(want(step), state, velocity) == command
            under_way.append(command)
            x, y, course, heading_rate = moved(state, under_way.popleft(), lag, TIME_STEP)
            state = (x - velocity[0] * TIME_STEP, y - velocity[1] * TIME_STEP, course, heading_rate)
    assert skipped > 100


@pytest.mark.parametrize(
    ("command", "fastest", "slowest", "looks"),
    [
        (0.24, SPEED, SPEED, False),
        (0.26, SPEED, SPEED, True),
        (-0.26, SPEED, SPEED, True),
        (0.0, SPEED + 0.04, SPEED - 0.04, False),
        (0.0, SPEED + 0.06, SPEED, True),
        (0.0, SPEED, SPEED - 0.06, True),
    ],
)
def test_a_command_or_airspeed_beyond_those_that_were_counted_is_looked_at(
    command, fastest, slowest, looks
):
    # Beside the disc, northbound. Half a reversal is counted, since it has to roll into the turn:
    # a quarter to either side.
    guard = HeadingRateFilter(parameters_of(heading_rate_max=0.5, lag=0.26, deviation=3.0))
    own = known_motion((0.0, 220.0, 0.0, 0.0))
    first = 1e-6
    assert guard.limit(first, 0.0, own, (AT_REST,), SPEED, SPEED) == first
    assert guard.budget.steps > 0
    guard.limit(command, 0.05, own, (AT_REST,), fastest, slowest)
    # A look takes in the commands since the last one.
    assert (guard.history.recent[-1] == first) == looks


@pytest.mark.slow
@pytest.mark.parametrize(
    ("deviation", "radius", "closing"),
    [(0.0, 200.0, 0.5), (3.1, 200.0, 0.5), (19.7, 200.0, 0.5), (6.1, 41.0, 0.9)],
)
@pytest.mark.parametrize("order", ["against the turn", "at random", "of the turn"])
def test_skipped_commands_leave_the_turn_that_was_found(deviation, radius, closing, order):
    # The worst command that needs no look, the best or any, until every command needs one: the
    # better turn away then still keeps off by all that is kept for the last change of command. The
    # vehicle has the guard's response; the disc follows it.
    generator, passed, least = np.random.default_rng(5), 0, math.inf
    tried = np.linspace(-1.0, 1.0, 9) * RATE
    for _ in range(120):
        guard = filter_of(radius=radius, deviation=deviation)
        bearing = generator.uniform(-math.pi, math.pi)
        distance = radius + deviation + generator.uniform(2.0, 90.0)
        velocity = (closing * SPEED * math.cos(bearing), closing * SPEED * math.sin(bearing))
        discs = (Tube(0.0, 0.0, 0.0, *velocity, 0.0),)
        state = polar(distance, bearing, generator.uniform(-math.pi, math.pi))
        under_way, k, skippable = deque([0.0] * 4), 0, {0.0: 0.0}
        while skippable and k < 200:
            if order == "at random":
                demanded = generator.choice(list(skippable))
            else:
                choose = min if order == "against the turn" else max
                demanded = choose(skippable, key=skippable.get)
            command = guard.limit(float(demanded), k * TIME_STEP, known_motion(state), discs, SPEED)
            if guard.status is not GuardStatus.FREE:
                break
            under_way.append(command)
            state = moved(state, under_way.popleft(), LAG, TIME_STEP, SPEED)
            k += 1
            skippable = {}
            for each in tried:
                budget = copy.copy(guard.budget)
                if budget.may_skip(each, SPEED, SPEED):
                    skippable[each] = budget.course_left
        x, y = state[0] - k * TIME_STEP * velocity[0], state[1] - k * TIME_STEP * velocity[1]
        if k > 1 and guard.status is GuardStatus.FREE and math.hypot(x, y) < 500.0:
            passed += 1
            clearance = guard.clearance(k * TIME_STEP, known_motion(state), discs, SPEED)
            least = min(least, clearance)
    assert passed > 20
    # To the resolution of the prediction.
    assert least >= -0.01


def budget_after_a_look(side=1.0):
    """Return what a look leaves for omega_max 0.5 rad/s and steps of 0.1 s, at 0.5 rad/s into the
    turn: commands of 0.25 to 0.5 rad/s into the turn.
    """
    budget = SkipBudget(0.5, 0.1)
    turn = TurnAway(slack=1.0, free_time=1.05, free_course=0.21, change=0.5)
    budget.reset(
        turn, side, command=0.5 * side, recent=(0.5 * side, 0.5 * side), slowest=19.0, fastest=21.0
    )
    return budget


def skips(budget, command):
    count = 0
    while budget.may_skip(command, 20.0, 20.0):
        count += 1
    return count


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_commands_are_skipped_until_time_or_course_is_used_up(side):
    # Of the 10 steps of 1.05 s the one that was looked at is the first.
    assert skips(budget_after_a_look(side=side), 0.5 * side) == 9
    # Each takes 0.025 of the 0.21 rad, of which the course of two steps, 0.1 rad, is kept less what
    # the next command turns.
    budget = budget_after_a_look(side=side)
    assert skips(budget, 0.25 * side) == 6
    assert budget.course_left == pytest.approx(0.06)
    assert budget.may_skip(0.5 * side, 20.0, 20.0)
    for command in (0.24, 0.51, math.nan):
        assert not budget_after_a_look(side=side).may_skip(command * side, 20.0, 20.0)


def test_what_is_flown_in_place_of_a_skipped_command_is_charged():
    budget = budget_after_a_look()
    budget.charge(0.5, 0.3)
    assert (budget.steps, budget.course_left) == (9, pytest.approx(0.21 - 0.2 * 0.1))
    # More of the turn costs nothing, and earns nothing.
    budget.charge(0.3, 0.5)
    assert (budget.steps, budget.course_left) == (9, pytest.approx(0.21 - 0.2 * 0.1))
    budget.charge(0.5, 0.2)
    assert budget.steps == 0


@pytest.mark.parametrize("speed", [PAPER_SPEED, 1.5 * PAPER_SPEED])
def test_a_disc_that_is_far_away_stays_out_of_reach_for_as_long_as_predicted(speed):
    # Straight at each other, the disc speeding up all the while: at the end of that time, and no
    # sooner, a turn may be needed.
    acceleration = 0.3
    guard = DiscGuard(turn_speed=PAPER_SPEED).filter

    def time_until_near(distance, closing):
        state = (-distance, 0.0, 0.0, 0.0)
        return guard.time_until_near(
            relative_motion(state, (-closing, 0.0), fastest=speed, acceleration=acceleration)
        )

    radius = 200.0
    duration = 1.5 * math.pi / HEADING_RATE_MAX * speed / PAPER_SPEED
    for distance in (800.0, 1000.0, 1200.0):
        free = time_until_near(distance, 5.0)
        then = distance - (speed + 5.0) * free - 0.5 * acceleration * free**2
        assert time_until_near(then, 5.0 + acceleration * free) >= -1e-9
        # What is left is what both can close in a full turn, which takes the longer the faster it
        # flies.
        assert free == 0.0 or then - radius > (speed + 5.0 + acceleration * free) * duration
