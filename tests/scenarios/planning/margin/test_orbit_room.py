"""How far out an orbit lies, as r_CO less its half-width along: there the guard never acts on it,
and 2 m nearer it does.
"""

import math
from collections import deque

import numpy as np
import pytest

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import VesselLimits, VesselReport, tube
from gnc.guard.guard import GuardParameters, GuardStatus, HeadingRateFilter
from gnc.paper import design_oscillation
from gnc.unicycle import lagged_move
from scenarios.planning.margin.keepout_margin import orbit_distance

SPEED, HEADING_RATE_MAX, TIME_STEP, LAG, DELAY = 19.42, 0.505, 0.05, 0.2, 0.2
GUARD = GuardParameters(
    radius=200.0,
    heading_rate_max=HEADING_RATE_MAX,
    lag=LAG,
    delay=DELAY,
    slow_lag=DELAY + LAG,
    time_step=TIME_STEP,
)
# AIS every 10 s, up to 2 s late, and looked at twice a second: a ship that brakes or turns by 0.25
# m/s^2.
AIS = tube(
    VesselReport(-12.5, 0.0, 0.0, 0.0, 0.0),
    VesselLimits(
        acceleration=0.25,
        speed_max=math.inf,
        position_sigma=5.0,
        velocity_sigma=0.15,
        deviations=5.2,
        horizon=7.0,
    ),
    0.0,
)


def oscillation(nu):
    return design_oscillation(nu=nu, speed=SPEED, heading_rate_max=0.9 * HEADING_RATE_MAX)


def interventions(nu, distance, vessel):
    """Return at how many steps a guard intervenes on an orbit at some distance from a vessel that
    may always be as far off.

    The vehicle has a dead time and a lag; commands are what the orbit needs when they act, so that
    only the guard disturbs it.
    """
    orbit, history = oscillation(nu), HeadingRateFilter(GUARD).history
    along, _ = orbit.half_widths()
    mean, late = nu * SPEED, round(DELAY / TIME_STEP)
    before = TIME_STEP * np.arange(-200, round(3.0 * orbit.period / TIME_STEP) + late + 2)
    (x, y), (ahead, right) = orbit.offset(before), orbit.offset(before + 1e-3)
    courses = np.unwrap(np.arctan2((right - y) / 1e-3, (ahead - x) / 1e-3 + mean))
    rates = np.gradient(courses, TIME_STEP)
    # Commands that a vehicle with a lag needs.
    commands = np.clip(
        rates + LAG * np.gradient(rates, TIME_STEP), -HEADING_RATE_MAX, HEADING_RATE_MAX
    )
    first = 200
    place = (float(x[first]) - distance - along, float(y[first]))
    state = (*place, float(courses[first]), float(rates[first]))
    under_way = deque(commands[first - late : first].tolist())
    count = 0
    for step in range(round(2.0 * orbit.period / TIME_STEP)):
        time = step * TIME_STEP
        disc = vessel._replace(time=time, north=mean * time, velocity_north=mean)
        own = AirMotion(
            ground_north=state[0], ground_east=state[1], course=state[2], heading_rate=state[3]
        )
        # A guard that remembers nothing but the commands: it looks at each step.
        guard = HeadingRateFilter(GUARD)
        guard.history = history
        guard.limit(float(commands[first + step]), time, own, (disc,), SPEED)
        count += guard.status is not GuardStatus.FREE
        under_way.append(float(commands[first + step]))
        state = lagged_move(*state[:3], state[3], SPEED, under_way.popleft(), LAG, TIME_STEP)
    return count


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.6, 0.8])
def test_on_the_orbit_the_guard_never_intervenes_and_2_m_nearer_it_does(nu):
    distance = orbit_distance(GUARD, AIS, oscillation(nu))
    assert interventions(nu, distance, AIS) == 0
    assert interventions(nu, distance - 2.0, AIS) > 0
