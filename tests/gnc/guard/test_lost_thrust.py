"""A vehicle that loses its airspeed in a turn away, as without thrust, keeps out where the guard
knows how slow it becomes.
"""

import math

import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import RADIUS, TIME_STEP, aim_at_the_centre, make_guard, moved

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube

LAG, FALL, SLOWEST = 0.4, 1.25, 14.2
"""Of the X8: its airspeed falls by 1.25 m/s2 without thrust in a turn at 45 degrees, to 14.2 m/s
until that is detected.
"""


def fly(fails, closing, slowest):
    """Return the closest approach [m] to a disc that closes in, of a vehicle that is steered at it,
    and how often it was lost.
    """
    guard = make_guard(lag=LAG, slowest=slowest)
    state, x, closest, lost, speed = (0.0, 3.0, 0.0, 0.0), -600.0, math.inf, 0, SPEED
    for step in range(round(45.0 / TIME_STEP)):
        _, y, course, rate = state
        command = aim_at_the_centre(step, x, y, course)
        command = guard.limit(command, x, y, -closing, 0.0, course, SPEED, rate, slowest=speed)
        lost += guard.lost
        if step * TIME_STEP >= fails:
            speed = max(SLOWEST, speed - FALL * TIME_STEP)
        north = state[0]
        state = moved(state, command, LAG, TIME_STEP, speed)
        x += state[0] - north + closing * TIME_STEP
        closest = min(closest, math.hypot(x, state[1]))
    return closest, lost


@pytest.mark.parametrize("closing", [5.0, 13.0])
def test_a_vehicle_that_slows_down_to_the_slowest_keeps_out_whenever_it_begins_to(closing):
    # Both close in by 340 m until the guard acts; the fall takes 4.2 s, a turn away 6 s.
    until = 340.0 / (SPEED + closing)
    times = [until + after for after in (-6.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0)]
    kept = [fly(fails, closing, SLOWEST) for fails in times]
    assert min(closest for closest, _ in kept) >= RADIUS
    assert not any(lost for _, lost in kept)
    # A guard that reckons with the airspeed of the moment lets it in.
    assert min(fly(fails, closing, math.inf)[0] for fails in times) < RADIUS


def test_a_start_and_an_orbit_are_judged_by_the_slowest_too():
    # Astern of a disc that comes on the vehicle flies away from it, the slower the nearer.
    own = AirMotion(ground_north=300.0, ground_east=0.0, course=1.0)
    clearances = []
    for slowest in (math.inf, SPEED, SLOWEST):
        guard = KeepoutGuard(
            GuardParameters(
                radius=RADIUS,
                heading_rate_max=HEADING_RATE_MAX,
                lag=LAG,
                time_step=TIME_STEP,
                slowest=slowest,
            )
        )
        guard.tubes = (Tube(0.0, 0.0, 0.0, 13.0, 0.0),)
        clearances.append(guard.clearance(0.0, own, SPEED))
    assert clearances[0] == clearances[1]
    # Until it heads straight away, at 14.2 m/s where it was 19.4, it loses 5.2 m in each second.
    assert 2.0 < clearances[1] - clearances[2] < 5.2 * math.pi / 2.0 / HEADING_RATE_MAX
