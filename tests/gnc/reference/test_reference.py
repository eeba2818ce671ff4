"""The paper's reference over time, and where its orbit is joined."""

import math

import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    SPEED,
    TIME_STEP,
    courses,
    examples,
    make_reference,
    paper_oscillation,
)
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gnc.reference.oscillating import ClosingReference, JoinedOrbit
from gnc.reference.shapes import Sinusoid

COURSE = 0.7


def make(phase):
    oscillation = paper_oscillation(0.5, roll_rate_max=math.radians(40.0))
    return oscillation, make_reference(
        oscillation, phase=phase, centre=(-214.0, 35.0), vessel_course=COURSE
    )


@pytest.mark.parametrize(("vessel_heading_rate", "phase"), [(0.0, 0.0), (0.02, 1.0), (-0.01, 0.0)])
def test_the_stepped_reference_is_equation_2_integrated_also_while_the_vessel_turns(
    vessel_heading_rate, phase
):
    oscillation, reference = make(phase)

    def rates(time, state):
        heading_rate = (
            -oscillation.amplitude * math.sin(oscillation.omega_0 * time + phase)
            + vessel_heading_rate
        )
        return SPEED * math.cos(state[2]), SPEED * math.sin(state[2]), heading_rate

    start = [reference.north, reference.east, reference.course]
    solution = solve_ivp(rates, (0.0, 60.0), start, method="DOP853", rtol=1e-11, atol=1e-11)
    for _ in range(1200):
        reference.step(vessel_heading_rate)
    # Integration tolerance 1e-11 of up to 1 km in each of some hundred steps.
    assert (reference.north, reference.east, reference.course) == pytest.approx(
        solution.y[:, -1], rel=0.0, abs=1e-6
    )
    assert reference.heading_rate == pytest.approx(
        rates(60.0, solution.y[:, -1])[2], rel=0.0, abs=1e-12
    )


@pytest.mark.parametrize("phase", [0.0, 0.5, 0.5 * math.pi, -2.0])
def test_the_reference_starts_on_the_course_of_equation_7(phase):
    oscillation, reference = make(phase)
    # Rounding.
    assert reference.course == pytest.approx(COURSE + oscillation.eta * math.cos(phase), abs=1e-15)
    # And turns as equation (2) says from there on.
    assert reference.heading_rate == pytest.approx(
        -oscillation.amplitude * math.sin(phase), abs=1e-15
    )


ORBIT = JoinedOrbit(
    shape=Sinusoid(), orbit=paper_oscillation(0.5), vessel_course=0.3, time_step=TIME_STEP
)
JOINED_CENTRE = (-214.0, 20.0)
TURN_RADIUS = SPEED / HEADING_RATE_MAX


def nearest(place, course):
    return ORBIT.nearest(
        *JOINED_CENTRE, north=place[0], east=place[1], course=course, turn_radius=TURN_RADIUS
    )


def effort(reference, place, course):
    """Return the distance to a reference together with 1.5 turn radii per radian between the
    courses [m].
    """
    turn = math.remainder(reference.course - course, 2.0 * math.pi)
    return math.hypot(
        reference.north - place[0], reference.east - place[1], 1.5 * TURN_RADIUS * turn
    )


@examples(50)
@given(
    place=st.tuples(st.floats(-600.0, 200.0), st.floats(-300.0, 300.0)),
    course=courses,
    phase=st.floats(0.0, 2.0 * math.pi),
)
def test_no_phase_costs_less_than_the_nearest(place, course, phase):
    least = effort(nearest(place, course), place, course)
    # Phases are 5 degrees apart: by no more than one gets from half a step, over which the reference
    # flies V_r 0.0436/omega_0 and its course swings by no more than eta per radian of phase.
    step = math.radians(2.6)
    slack = math.hypot(SPEED / ORBIT.orbit.omega_0, 1.5 * TURN_RADIUS * ORBIT.orbit.eta) * step
    assert least <= effort(ORBIT.reference(phase, *JOINED_CENTRE), place, course) + slack


def test_a_closing_reference_stands_off_until_it_may_close_and_then_reaches_its_place():
    axis, standoff, rate = 2.5, 24.0, 4.0
    alone, inner = (make_reference(paper_oscillation(0.5), centre=JOINED_CENTRE) for _ in range(2))
    closing = ClosingReference(inner, axis=axis, standoff=standoff, rate=rate, time_step=TIME_STEP)

    def off():
        return closing.north - alone.north, closing.east - alone.east

    away = (math.cos(axis), math.sin(axis))
    for step in range(240):
        closing.closing = step >= 100
        # 5 s outside, then in at 4 m/s: 6 s. Roundings of 200 m.
        left = min(24.0, max(0.0, 24.0 - rate * TIME_STEP * max(0, step - 100)))
        assert off() == pytest.approx((left * away[0], left * away[1]), abs=1e-9)
        assert (closing.course, closing.heading_rate, closing.speed) == (
            alone.course,
            alone.heading_rate,
            alone.speed,
        )
        alone.step()
        closing.step()
    assert closing.standoff == 0.0
