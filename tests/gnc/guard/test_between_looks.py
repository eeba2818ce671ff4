"""What the vehicle does between two looks of the keep-out guard: within a step, and as its commands
change.
"""

import copy
import math
from collections import deque

import numpy as np
import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard
from guard_cases import aim_at_the_centre, moved

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube

SPEED = 20.0


def guard_of(*, radius, heading_rate_max, time_step, lag=0.0, delay=0.0, deviation=0.0):
    guard = KeepoutGuard(
        GuardParameters(
            radius=radius, heading_rate_max=heading_rate_max, lag=lag, delay=delay, slow_lag=lag + delay, time_step=time_step,
            deviation=deviation,
        )
    )  # fmt: skip
    guard.tubes = (Tube(0.0, 0.0, 0.0, 0.0, 0.0),)
    return guard


def motion_of(state):
    north, east, course, heading_rate = state
    return AirMotion(ground_north=north, ground_east=east, course=course, heading_rate=heading_rate)


@pytest.mark.parametrize(
    ("rate_hz", "heading_rate_max"), [(5.0, 0.49), (5.0, 0.58), (8.0, 0.58), (10.0, 0.85)]
)
def test_no_path_leads_in_within_a_wide_step(rate_hz, heading_rate_max):
    generator = np.random.default_rng(3)
    radius, step, nearest, worked = 10.0, 1.0 / rate_hz, math.inf, 0
    for _ in range(60):
        bearing, distance = (
            generator.uniform(-math.pi, math.pi),
            generator.uniform(1.1, 8.0) * radius,
        )
        state = (
            distance * math.cos(bearing),
            distance * math.sin(bearing),
            generator.uniform(-math.pi, math.pi),
            0.0,
        )
        guard = guard_of(radius=radius, heading_rate_max=heading_rate_max, time_step=step)
        if guard.clearance(0.0, motion_of(state), SPEED) < 0.0:
            continue
        for k in range(150):
            demanded = generator.uniform(-1.0, 1.0) * heading_rate_max
            if k % 4:
                demanded = aim_at_the_centre(k, *state[:3], heading_rate_max)
            command = guard.limit(demanded, k * step, motion_of(state), SPEED)
            for _ in range(20):
                state = moved(state, command, 0.0, step / 20.0, SPEED)
                nearest = min(nearest, math.hypot(*state[:2]))
            worked += guard.intervening
    assert worked > 100
    assert nearest >= radius


@pytest.mark.parametrize("deviation", [0.0, 3.1, 19.7])
def test_a_command_that_passes_leaves_a_turn_with_all_that_is_kept_for_its_own_change(deviation):
    # A turn that is settled, beside the disc; then a law that steers inwards by a reversal. The
    # vehicle has the guard's response.
    heading_rate_max, lag, step = 0.49, 0.26, 0.05
    worked, least = 0, math.inf
    for gap in (1.0, 5.0, 15.0, 30.0):
        guard = guard_of(
            radius=200.0,
            heading_rate_max=heading_rate_max,
            time_step=step,
            lag=lag,
            delay=4 * step,
            deviation=deviation,
        )
        state = (0.0, 200.0 + gap + 2.0 * SPEED / heading_rate_max, 0.0, -heading_rate_max)
        under_way = deque([-heading_rate_max] * 4)
        command, inwards = 0.0, False
        for k in range(900):
            # It has come round to the disc on the settled turn.
            inwards = inwards or (k > 400 and state[1] < 200.0 + gap + 1.0)
            demanded = (
                aim_at_the_centre(k, *state[:3], heading_rate_max) if inwards else -heading_rate_max
            )
            # The turn away that keeps off by all that a change of command before it takes; once
            # begun it is one itself.
            if k and not (guard.intervening and abs(command) == heading_rate_max):
                asked = copy.copy(guard)
                asked._given = copy.deepcopy(guard._given)
                least = min(least, asked.clearance(k * step, motion_of(state), SPEED))
            command = guard.limit(demanded, k * step, motion_of(state), SPEED)
            under_way.append(command)
            state = moved(state, under_way.popleft(), lag, step, SPEED)
            worked += guard.intervening
            assert not guard.lost
    assert worked > 0
    # To what is kept for the looks.
    assert least >= -0.01


@pytest.mark.parametrize(
    ("command", "speed", "slowest", "looks"),
    [
        (0.24, SPEED, SPEED, 0), (0.26, SPEED, SPEED, 1), (-0.26, SPEED, SPEED, 1),
        (0.0, SPEED + 0.04, SPEED - 0.04, 0), (0.0, SPEED + 0.06, SPEED, 1), (0.0, SPEED, SPEED - 0.06, 1),
    ],
)  # fmt: skip
def test_another_command_or_speed_than_was_counted_is_looked_at_at_once(
    command, speed, slowest, looks, monkeypatch
):
    # Beside the disc, northbound: of a look some steps are free. Half a reversal is counted, which
    # it has to roll into the turn as well, so a quarter to either side.
    guard, own = (
        guard_of(radius=200.0, heading_rate_max=0.5, time_step=0.05, lag=0.26, deviation=3.0),
        motion_of((0.0, 220.0, 0.0, 0.0)),
    )
    assert guard.limit(0.0, 0.0, own, SPEED, SPEED) == 0.0
    assert guard._free.steps > 0
    asked = []
    look = KeepoutGuard._look
    monkeypatch.setattr(KeepoutGuard, "_look", lambda *given: asked.append(given) or look(*given))
    guard.limit(command, 0.05, own, speed, slowest)
    assert len(asked) == looks


def flown(state, under_way, command, lag):
    """Return where a vehicle is after a step in which the oldest of the commands under way acts."""
    under_way.append(command)
    return moved(state, under_way.popleft(), lag, 0.05, SPEED)


@pytest.mark.parametrize(
    ("deviation", "radius", "closing"),
    [(0.0, 200.0, 0.5), (3.1, 200.0, 0.5), (19.7, 200.0, 0.5), (6.1, 41.0, 0.9)],
)
@pytest.mark.parametrize("order", ["against the turn", "at random", "of the turn"])
def test_whatever_needs_no_look_leaves_the_turn_that_was_found(deviation, radius, closing, order):
    # The worst that passes without a look, or anything that does, until nothing does: the better
    # turn away then still keeps off by all that is kept for the last change of command. The vehicle
    # has the guard's response; the disc follows it.
    heading_rate_max, lag, step = 0.49, 0.26, 0.05
    generator, passed, least = np.random.default_rng(5), 0, math.inf
    tried = np.linspace(-1.0, 1.0, 9) * heading_rate_max
    for _ in range(120):
        guard = guard_of(
            radius=radius,
            heading_rate_max=heading_rate_max,
            time_step=step,
            lag=lag,
            delay=4 * step,
            deviation=deviation,
        )
        bearing, distance = (
            generator.uniform(-math.pi, math.pi),
            radius + deviation + generator.uniform(2.0, 90.0),
        )
        velocity = (closing * SPEED * math.cos(bearing), closing * SPEED * math.sin(bearing))
        guard.tubes = (Tube(0.0, 0.0, *velocity, 0.0),)
        state = (
            distance * math.cos(bearing),
            distance * math.sin(bearing),
            generator.uniform(-math.pi, math.pi),
            0.0,
        )
        under_way, k, free = deque([0.0] * 4), 0, [0.0]
        while free and k < 200:
            side = guard._free._towards
            against = min(free, key=lambda each, side=side: side * each)
            ordered = {
                "against the turn": against,
                "of the turn": max(free, key=lambda each, side=side: side * each),
            }
            demanded = ordered.get(order) if order in ordered else generator.choice(free)
            command = guard.limit(float(demanded), k * step, motion_of(state), SPEED)
            if guard.intervening:
                break
            state, k = flown(state, under_way, command, lag), k + 1
            free = [each for each in tried if copy.copy(guard._free).cover(each, SPEED, SPEED)]
        if (
            k > 1
            and not guard.intervening
            and math.hypot(state[0] - k * step * velocity[0], state[1] - k * step * velocity[1])
            < 500.0
        ):
            passed += 1
            least = min(least, guard.clearance(k * step, motion_of(state), SPEED))
    assert passed > 20
    # To what is kept for the looks.
    assert least >= -0.01
