"""A reference that is joined where it is nearest, somewhat outside of its place."""

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

from gnc.reference.reference import ClosingReference, JoinedOrbit
from gnc.reference.shapes import Sinusoid

ORBIT = JoinedOrbit(
    shape=Sinusoid(), orbit=paper_oscillation(0.5), vessel_course=0.3, time_step=TIME_STEP
)
CENTRE = (-214.0, 20.0)
TURN_RADIUS = SPEED / HEADING_RATE_MAX


def nearest(place, course):
    return ORBIT.nearest(
        *CENTRE, north=place[0], east=place[1], course=course, turn_radius=TURN_RADIUS
    )


def effort(reference, place, course):
    """Return the distance to a reference together with 1.5 turn radii per radian between the
    courses [m].
    """
    turn = math.remainder(reference.course - course, 2.0 * math.pi)
    return math.hypot(
        reference.north - place[0], reference.east - place[1], 1.5 * TURN_RADIUS * turn
    )


@pytest.mark.parametrize("phase", [0.0, 1.1, 2.9, 4.4])
def test_a_vehicle_on_the_orbit_is_met_where_it_is(phase):
    there = ORBIT.reference(phase, *CENTRE)
    found = nearest((there.north, there.east), there.course)
    # Phases are 5 degrees apart, so half of that, over which the reference flies V_r
    # 0.0436/omega_0.
    assert (
        math.hypot(found.north - there.north, found.east - there.east)
        < SPEED * math.radians(2.6) / ORBIT.orbit.omega_0
    )
    # Its course swings by no more than eta per radian of phase.
    assert abs(found.course - there.course) < ORBIT.orbit.eta * math.radians(2.6)


@examples(50)
@given(
    place=st.tuples(st.floats(-600.0, 200.0), st.floats(-300.0, 300.0)),
    course=courses,
    phase=st.floats(0.0, 2.0 * math.pi),
)
def test_no_phase_costs_less_than_the_nearest(place, course, phase):
    least = effort(nearest(place, course), place, course)
    # By no more than one gets from half a step of 2.5 degrees: way and turn of
    # ``test_a_vehicle_on_the_orbit_...``.
    step = math.radians(2.6)
    slack = math.hypot(SPEED / ORBIT.orbit.omega_0, 1.5 * TURN_RADIUS * ORBIT.orbit.eta) * step
    assert least <= effort(ORBIT.reference(phase, *CENTRE), place, course) + slack


def test_of_two_ways_through_a_place_the_one_on_the_vehicles_course_is_taken():
    # The orbit passes near its centre twice in a period, once to the right and once to the left.
    right, left = (nearest(CENTRE, 0.3 + side * 1.0).course for side in (1.0, -1.0))
    assert right > 0.3 > left


def test_a_closing_reference_stands_off_until_it_may_close_and_then_reaches_its_place():
    axis, standoff, rate = 2.5, 24.0, 4.0
    alone, inner = (make_reference(paper_oscillation(0.5), centre=CENTRE) for _ in range(2))
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
