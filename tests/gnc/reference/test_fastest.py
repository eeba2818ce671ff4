import math

import numpy as np
import pytest
from gnc_cases import SPEED, TIME_STEP
from orbit_cases import assert_a_point_that_turns_so_flies
from scipy.optimize import brentq

from common.physics import STANDARD_GRAVITY
from gnc.reference.oscillating import JoinedOrbit
from gnc.reference.shapes import Fastest

LIMITS = {
    "speed": SPEED,
    "heading_rate_max": STANDARD_GRAVITY / SPEED,
    "reserve": 0.015,
    "vessel_heading_rate": 0.0,
    "roll_rate_max": math.radians(40.0),
}
"""Those of the issue's table: 45 degrees of bank, of which 1.5 % of the heading rate is kept, and
40 deg/s.
"""

FRACTION = Fastest().turn_rate_fraction_until_tracked


def design(nu=0.5, **changes):
    return Fastest().design(**({"nu": nu} | LIMITS | changes))


def reference_on(orbit, *, phase=0.0, turn_rate_fraction=1.0, vessel_course=0.3):
    joined = JoinedOrbit(
        shape=Fastest(), orbit=orbit, vessel_course=vessel_course, time_step=TIME_STEP
    )
    return joined.reference(phase, -214.0, 5.0, turn_rate_fraction=turn_rate_fraction)


def interval_by_integration(nu):
    """Return the shortest interval, from the bank's trapezoid and the heading rates that follow
    from it [s].
    """
    heading_rate = (1.0 - LIMITS["reserve"]) * LIMITS["heading_rate_max"]
    bank_max = math.atan(heading_rate * SPEED / STANDARD_GRAVITY)

    def excess(half):
        time = np.linspace(0.0, half, 20001)
        bank = np.minimum(
            np.minimum(LIMITS["roll_rate_max"] * time, LIMITS["roll_rate_max"] * (half - time)),
            bank_max,
        )
        rate = STANDARD_GRAVITY / SPEED * np.tan(bank)
        course = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * time[1])])
        return float(np.trapezoid(np.cos(course - 0.5 * course[-1]), time)) / half - nu

    return brentq(excess, 0.5, 13.0)


@pytest.mark.parametrize("nu", [0.0, 0.25, 0.5, 0.95])
def test_the_interval_is_that_of_the_trapezoid_integrated_step_by_step(nu):
    # The trapezoidal rule over 20,000 steps: 1e-8.
    assert design(nu).crossing_interval == pytest.approx(interval_by_integration(nu), rel=1e-6)


@pytest.mark.parametrize("nu", [0.0, 0.5, 0.9, 0.995])
def test_a_point_that_turns_so_flies_the_orbit(nu):
    orbit = design(nu)
    assert_a_point_that_turns_so_flies(orbit, nu, start=(0.0, 0.0, orbit.eta))
    widths = [
        float(np.abs(part).max()) for part in orbit.offset(np.linspace(0.0, orbit.period, 40001))
    ]
    # 40,000 points miss a peak by less than V omega (T/80,000)^2/2 = 2e-7 m.
    assert orbit.half_widths() == pytest.approx(widths, rel=0.0, abs=1e-5)


@pytest.mark.parametrize("share", [FRACTION, 0.5])
def test_a_reference_that_is_slowed_down_has_a_larger_orbit_about_the_same_centre(share):
    orbit = design()
    slow = reference_on(orbit, phase=1.0, turn_rate_fraction=share, vessel_course=0.0)
    full = reference_on(orbit, phase=1.0, vessel_course=0.0)
    # About the same centre, 1/share as far off, on the same course.
    assert slow.north + 214.0 == pytest.approx((full.north + 214.0) / share, rel=1e-12)
    assert slow.east - 5.0 == pytest.approx((full.east - 5.0) / share, rel=1e-12)
    assert (slow.course, slow.heading_rate) == (
        full.course,
        pytest.approx(share * full.heading_rate, rel=1e-15),
    )
    for _ in range(round(1.3 * orbit.period / TIME_STEP)):
        slow.step()
        assert abs(slow.heading_rate) <= share * orbit.amplitude * (1.0 + 1e-12)
    # Asked to spend all, it does so from the next passage through the centre on, where it does not
    # turn.
    slow.set_turn_rate_fraction(1.0)
    while slow.turn_rate_fraction != 1.0:
        before = slow.heading_rate
        slow.step()
    # A step of 0.05 s of rolling at 40 deg/s changes it by 0.5 rad/s^2 times that, 0.018 rad/s.
    assert abs(slow.heading_rate - before) < 0.02
