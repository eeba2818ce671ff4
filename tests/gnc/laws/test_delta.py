import math

import pytest
from gnc_cases import LOOK_AHEAD, courses, examples, moved, relative, tracking_motion
from hypothesis import given
from hypothesis import strategies as st

from gnc.errors import InfeasibleError
from gnc.numeric import wrap
from gnc.paper import (
    distance_squared,
    distance_squared_rate,
    look_ahead,
    relative_state,
    relative_velocity,
)

offsets = st.floats(-500.0, 500.0)
speeds = st.floats(5.0, 40.0)
heading_rates = st.floats(-0.6, 0.6)


@st.composite
def cartesian_states(draw):
    """The reference at the origin, the vehicle about it: north, east and course of each."""
    return [0.0, 0.0, draw(courses), draw(offsets), draw(offsets), draw(courses)]


def course_of_z(state):
    return state[5] - relative(state).phi


@examples(200)
@given(north=offsets, east=offsets, reference_course=courses, course=courses)
def test_the_relative_state_holds_the_geometry_of_figure_2(north, east, reference_course, course):
    state = relative_state(LOOK_AHEAD, north, east, reference_course, course)
    # Equations (14) to (16): d = z - delta, both with their courses; delta = epsilon d^2 + R with
    # epsilon = 0.005, R = 60.
    z_course = course - state.phi
    delta = 0.005 * (north**2 + east**2) + 60.0
    # Roundings of angles, 1e-15 times lengths up to 3 km.
    assert state.delta == pytest.approx(delta, rel=1e-14)
    assert state.rho * math.cos(z_course) - delta * math.cos(reference_course) == pytest.approx(
        north, rel=0.0, abs=1e-11
    )
    assert state.rho * math.sin(z_course) - delta * math.sin(reference_course) == pytest.approx(
        east, rel=0.0, abs=1e-11
    )
    assert wrap(reference_course - state.phi_r - z_course) == pytest.approx(0.0, abs=1e-14)
    assert -math.pi <= state.phi < math.pi
    assert -math.pi <= state.phi_r < math.pi


@examples(200)
@given(
    state=cartesian_states(),
    reference_speed=speeds,
    speed=speeds,
    reference_heading_rate=heading_rates,
    heading_rate=heading_rates,
)
def test_relative_rates_are_those_of_the_cartesian_motion_also_at_unequal_speeds(
    state, reference_speed, speed, reference_heading_rate, heading_rate
):
    rates = tracking_motion(
        lambda *_: heading_rate,
        lambda _: reference_heading_rate,
        reference_speed=reference_speed,
        speed=speed,
    )
    step = 1e-4
    before, after = moved(rates, 0.0, state, -step), moved(rates, 0.0, state, step)
    there = relative(state)
    rho_rate, omega_rho = relative_velocity(
        LOOK_AHEAD, there, reference_speed, speed, reference_heading_rate
    )
    delta_rate = LOOK_AHEAD.epsilon * distance_squared_rate(there, reference_speed, speed)
    squared_rate = (distance_squared(relative(after)) - distance_squared(relative(before))) / (
        2.0 * step
    )
    numerical_delta = (relative(after).delta - relative(before).delta) / (2.0 * step)
    numerical_rho = (relative(after).rho - relative(before).rho) / (2.0 * step)
    numerical_omega = wrap(course_of_z(after) - course_of_z(before)) / (2.0 * step)
    # Central differences err by step^2/6 of the third derivative, which is largest where delta (5
    # km) swings the end of z or where rho is shortest (10 m). Over 4,000 random states they erred
    # by 4e-5 m^2/s, 2e-7 m/s, 8e-6 m/s and 9e-7 rad/s, a hundred times more at ten times the step;
    # corners are allowed some ten times that. The rates themselves reach 9e4, 400, 600 and 9.
    assert distance_squared_rate(there, reference_speed, speed) == pytest.approx(
        squared_rate, rel=0.0, abs=5e-4
    )
    assert delta_rate == pytest.approx(numerical_delta, rel=0.0, abs=5e-6)
    assert rho_rate == pytest.approx(numerical_rho, rel=0.0, abs=1e-4)
    assert omega_rho == pytest.approx(numerical_omega, rel=0.0, abs=2e-5)


def test_a_look_ahead_too_short_for_its_epsilon_or_that_does_not_grow_is_refused():
    # Section IV.B: R > 1/(4 epsilon), 50 m at epsilon = 0.005.
    for radius in (50.0, -60.0, math.nan, math.inf):
        with pytest.raises(InfeasibleError, match=f"R is {radius:g} m; it must exceed .* = 50 m"):
            look_ahead(0.005, radius)
    assert look_ahead(0.005, 50.1).radius == 50.1
    for epsilon in (0.0, -0.005, math.nan, math.inf):
        with pytest.raises(InfeasibleError, match=f"epsilon is {epsilon:g} 1/m"):
            look_ahead(epsilon, 60.0)
