import math

import numpy as np
import pytest
from gnc_cases import SPEED, examples
from hypothesis import given
from hypothesis import strategies as st
from orbit_cases import assert_a_point_that_turns_so_flies

from common.physics import STANDARD_GRAVITY
from gnc.errors import InfeasibleError
from gnc.paper import PlumeAxis, distance_exact
from gnc.reference.shapes import LoiterShape

HEADING_RATE = STANDARD_GRAVITY / SPEED
ROLL_RATE = math.radians(40.0)


def design(nu, *, heading_rate=HEADING_RATE, roll_rate=ROLL_RATE):
    return LoiterShape().design(
        nu=nu,
        speed=SPEED,
        heading_rate_max=heading_rate,
        reserve=0.0,
        vessel_heading_rate=0.0,
        roll_rate_max=roll_rate,
    )


ratios = st.floats(0.0, 0.499)  # beside faster vessels there is none at an infinite roll rate


@given(nu=ratios, heading_rate=st.floats(0.1, 0.9), roll_rate=st.floats(0.2, 5.0))
@examples(60)
def test_its_course_goes_round_once_at_the_mean_velocity_of_the_vessel_within_the_limits(
    nu, heading_rate, roll_rate
):
    orbit = design(nu, heading_rate=heading_rate, roll_rate=roll_rate)
    phases = 2.0 * math.pi * (np.arange(2000) + 0.5) / 2000
    courses = np.array([orbit.course(phase) for phase in phases.tolist()])
    # The midpoint rule over a period of a course whose slope jumps at most: (2 pi/2000)^2 times a
    # few.
    assert np.mean(np.cos(courses)) == pytest.approx(nu, abs=1e-4)
    assert np.mean(np.sin(courses)) == pytest.approx(0.0, abs=1e-10)
    assert orbit.course(phases[3] + 2.0 * math.pi) == pytest.approx(
        courses[3] + 2.0 * math.pi, rel=1e-13
    )
    rates = np.array([orbit.heading_rate(phase) for phase in phases.tolist()])
    assert rates.max() <= heading_rate * (1.0 + 1e-12)
    assert rates.min() >= 0.0
    banks = np.arctan(rates * SPEED / STANDARD_GRAVITY)
    # Rounding.
    assert np.abs(np.diff(banks)).max() <= roll_rate * orbit.period / 2000 * (1.0 + 1e-6)


@given(nu=ratios)
@examples(30)
def test_no_roll_rate_makes_it_faster_than_the_bound_for_paths_that_go_round(nu):
    # docs/fastest_oscillation.md: 2 pi/omega_max of turning with a mean velocity of 0, and the rest
    # on the vessel's course.
    bound = math.pi / (HEADING_RATE * (1.0 - nu))
    intervals = [
        design(nu, roll_rate=rate).crossing_interval for rate in (math.inf, 4.0, ROLL_RATE)
    ]
    assert intervals[0] == pytest.approx(bound, rel=1e-12)
    assert bound * (1.0 - 1e-12) <= intervals[1] <= intervals[2] * (1.0 + 1e-12)


@pytest.mark.parametrize("nu", [0.0, 0.05, 0.25, 0.5])
def test_a_point_that_turns_so_flies_the_orbit_and_meets_the_plume_every_half_turn(nu):
    orbit = design(nu)
    along, right = orbit.offset(np.zeros(1))
    assert_a_point_that_turns_so_flies(orbit, nu, start=(float(along[0]), float(right[0]), 0.0))
    # On the plume's axis a quarter of a period before and after phase 0.
    crossings = orbit.offset(np.array([0.25, 0.75]) * orbit.period)[1]
    assert crossings == pytest.approx([0.0, 0.0], abs=1e-4)
    widths = [
        float(np.abs(part).max()) for part in orbit.offset(np.linspace(0.0, orbit.period, 20001))
    ]
    assert orbit.half_widths() == pytest.approx(widths, rel=0.0, abs=1e-4)
    distance = distance_exact(orbit, PlumeAxis(heading=math.pi), 200.0)
    many = orbit.offset(np.linspace(0.0, orbit.period, 20001))
    assert np.hypot(many[0] - distance, many[1]).min() == pytest.approx(200.0, abs=1e-4)


@pytest.mark.parametrize(("nu", "roll_rate"), [(0.54, ROLL_RATE), (0.499, math.inf)])
def test_up_to_about_half_the_speed_it_crosses_the_plume_and_beside_faster_vessels_it_is_refused(
    nu, roll_rate
):
    orbit = design(nu, roll_rate=roll_rate)
    # Within two thousandths of the limit it just reaches both sides: at phase 0 the left, half a
    # period later the right.
    left, right = orbit.offset(np.array([0.0, 0.5]) * orbit.period)[1]
    assert left <= 0.0 < right
    assert orbit.straight == pytest.approx(0.5 * orbit.crossing_interval, rel=0.05)
    # The straight leg takes nu of the time at an infinite roll rate; at 40 deg/s half of it at
    # 0.546.
    for faster in (nu + 0.01, 0.6, 0.9):
        with pytest.raises(
            InfeasibleError,
            match=r"stays on one side of the plume.*: set reference\.shape to 'fastest'",
        ):
            design(faster, roll_rate=roll_rate)
