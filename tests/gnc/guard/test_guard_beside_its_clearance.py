"""The guard lets a command pass exactly where the turn away that follows keeps off: beside its own
clearance, and in wind.
"""

import numpy as np
import pytest
from gnc.safety.guard_parameters import GuardParameters
from gnc.safety.keepout_guard import KeepoutGuard
from gnc_cases import HEADING_RATE_MAX, SPEED
from guard_cases import RADIUS, TIME_STEP, TURN_RADIUS, random_start, random_velocity

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube


def a_guard(tube, *, delay=0.0):
    guard = KeepoutGuard(
        GuardParameters(
            radius=RADIUS,
            heading_rate_max=HEADING_RATE_MAX,
            lag=0.25,
            delay=delay,
            time_step=TIME_STEP,
        )
    )
    guard.tubes = (tube,)
    return guard


def nearest(asked):
    """Return the least distance [m] at which something is so, which is not so at the radius and is
    so 100 m from it.
    """
    low, high = RADIUS, RADIUS + 100.0
    assert asked(high)
    for _ in range(12):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if asked(middle) else (middle, high)
    return high


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize("delay", [0.0, 0.25, 0.5])
@pytest.mark.parametrize("growth", [0.0, 5.0])
def test_a_turn_away_passes_exactly_where_one_that_begins_now_keeps_off(side, delay, growth):
    # The disc grows by 2.5 m within half a second, before any command acts. Straight at it, 5 m off
    # its middle.
    disc = Tube(0.0, 0.0, 0.0, 0.0, 0.0, growth=growth)

    def own(distance):
        return AirMotion(
            ground_north=-distance, ground_east=5.0 * side, course=0.0, heading_rate=0.0
        )

    floor = 1e-3 * TURN_RADIUS
    keeps_off = nearest(
        lambda distance: a_guard(disc, delay=delay).clearance(0.0, own(distance), SPEED) >= floor
    )
    passes = nearest(
        lambda distance: a_guard(disc, delay=delay).allows(
            side * HEADING_RATE_MAX, 0.0, own(distance), SPEED
        )
    )
    # Each closest approach is predicted to a thousandth of a turn radius; the bisections end within
    # 0.03 m.
    assert passes == pytest.approx(keeps_off, abs=2.0 * floor + 0.05)


def test_in_wind_it_does_what_it_does_in_still_air_beside_a_vessel_that_moves_against_it():
    generator = np.random.default_rng(6)
    changed = 0
    for _ in range(100):
        velocity, wind = (
            random_velocity(generator, 0.5 * SPEED),
            random_velocity(generator, 0.4 * SPEED),
        )
        x, y, course, heading_rate = random_start(generator, nearest=RADIUS)
        command = float(generator.uniform(-HEADING_RATE_MAX, HEADING_RATE_MAX))
        place = {
            "ground_north": x,
            "ground_east": y,
            "course": course,
            "heading_rate": heading_rate,
        }
        windy = AirMotion(**place, wind_north=wind[0], wind_east=wind[1])
        in_wind = a_guard(Tube(0.0, 0.0, 0.0, *velocity))
        in_still_air = a_guard(Tube(0.0, 0.0, 0.0, velocity[0] - wind[0], velocity[1] - wind[1]))
        assert in_wind.clearance(0.0, windy, SPEED) == in_still_air.clearance(
            0.0, AirMotion(**place), SPEED
        )
        answer = in_wind.limit(command, 0.0, windy, SPEED)
        assert answer == in_still_air.limit(command, 0.0, AirMotion(**place), SPEED)
        changed += answer != command
    assert changed > 3
