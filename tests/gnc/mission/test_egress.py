import math

import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, TIME_STEP, courses, examples
from hypothesis import given
from hypothesis import strategies as st

from gnc.mission.egress import Egress
from gnc.unicycle import unicycle_move


def fly(x, y, course, heading_rate=0.0, duration=30.0):
    """Return distances from the vessel, and heading rates, of a vehicle that answers at once and
    leaves a vessel at rest.
    """
    egress, distances, turns = Egress(HEADING_RATE_MAX), [], []
    for _ in range(round(duration / TIME_STEP)):
        heading_rate = egress.command(x, y, course, heading_rate)
        x, y, course = unicycle_move(x, y, course, SPEED, heading_rate, TIME_STEP)
        distances.append(math.hypot(x, y))
        turns.append(heading_rate)
    return distances, turns


@examples(60)
@given(bearing=courses, course=courses, distance=st.floats(150.0, 600.0))
def test_it_leads_straight_out_from_any_course(bearing, course, distance):
    distances, turns = fly(distance * math.cos(bearing), distance * math.sin(bearing), course)
    assert max(map(abs, turns)) <= HEADING_RATE_MAX
    # Half a turn takes pi/omega_max = 6.2 s, and what is left of the angle dies out at 2 omega_max:
    # straight out, at its speed.
    assert distances[-1] - distances[-201] == pytest.approx(200 * SPEED * TIME_STEP, rel=1e-3)
    assert abs(turns[-1]) < 1e-3 * HEADING_RATE_MAX


@pytest.mark.parametrize("turning", [0.3, -0.3])
def test_from_a_course_towards_the_vessel_it_keeps_to_the_turn_that_it_has_begun(turning):
    # Straight at it, either way is as far; a first step past the middle would make the other turn
    # the shorter one.
    _, turns = fly(400.0, 0.0, math.pi - math.copysign(0.01, turning), heading_rate=turning)
    assert turns[0] == math.copysign(HEADING_RATE_MAX, turning)
    first = round(4.0 / TIME_STEP)
    assert all(math.copysign(1.0, turn) == math.copysign(1.0, turning) for turn in turns[:first])


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_where_one_turn_is_shorter_it_is_taken_whatever_is_flown(side):
    # 120 degrees to go: to the right for a vehicle east of north by that.
    assert (
        Egress(HEADING_RATE_MAX).command(400.0, 0.0, -side * math.radians(120.0), -side * 0.4)
        == side * HEADING_RATE_MAX
    )
