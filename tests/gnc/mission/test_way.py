"""The way to the centre of oscillation, round the vessel, and the way out."""

import math

import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    SPEED,
    TIME_STEP,
    courses,
    examples,
    motion,
    tracking_parameters,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.estimation.navigation import AirMotion, TrueNavigation
from gnc.estimation.vessel import SteadyTarget
from gnc.mission.way import Approach, ApproachParameters, Egress, Transit
from gnc.unicycle import unicycle_move

BLOCKED, ROUND = 203.0, 234.0
TARGET_DISTANCE = 240.0
TURN_RADIUS = 38.6


def course_of(transit, place, target, *, velocity=(0.0, 0.0), course=0.0):
    return transit.course(
        place[0],
        place[1],
        target[0],
        target[1],
        blocked_radius=BLOCKED,
        round_radius=ROUND,
        velocity_north=velocity[0],
        velocity_east=velocity[1],
        course=course,
        speed=SPEED,
    )


def polar(distance, bearing):
    return distance * math.cos(bearing), distance * math.sin(bearing)


def relative(course, velocity):
    """Return the vehicle's velocity as the disc sees it."""
    return SPEED * math.cos(course) - velocity[0], SPEED * math.sin(course) - velocity[1]


def nearest(place, way, length):
    """Return how close to the origin a straight way comes."""
    size = math.hypot(*way)
    along = min(max(-(place[0] * way[0] + place[1] * way[1]) / size, 0.0), length)
    return math.hypot(place[0] + along * way[0] / size, place[1] + along * way[1] / size)


@given(
    distance=st.floats(BLOCKED + 0.1, 1500.0),
    bearing=courses,
    target=courses,
    course=courses,
    speed=st.floats(0.0, 0.95 * SPEED),
    heading=courses,
)
@examples(200)
def test_the_straight_relative_way_never_enters_the_blocked_circle_from_outside(
    distance, bearing, target, course, speed, heading
):
    place = polar(distance, bearing)
    goal = polar(TARGET_DISTANCE, target)
    velocity = polar(speed, heading)
    transit = Transit(TURN_RADIUS)
    way = relative(course_of(transit, place, goal, velocity=velocity, course=course), velocity)
    to, length = (goal[0] - place[0], goal[1] - place[1]), 1e4
    if transit.side == 0:
        # The way to the target is clear, and is flown along it, not against it. Rounding.
        length = math.hypot(*to)
        assert to[0] * way[1] - to[1] * way[0] == pytest.approx(0.0, abs=1e-9 * SPEED * length)
        assert to[0] * way[0] + to[1] * way[1] >= 0.0
    # As far as the target, or else past the tangent point, far enough for all that is ahead.
    assert nearest(place, way, length) >= BLOCKED - 1e-6


@pytest.mark.parametrize(
    ("bearing", "speed_ratio"), [(0.0, 0.0), (0.7, 0.9), (2.0, 0.5), (-1.3, 0.9)]
)
def test_following_it_leads_round_a_moving_disc_to_the_target_and_never_inside(
    bearing, speed_ratio
):
    transit = Transit(TURN_RADIUS)
    velocity = (speed_ratio * SPEED, 0.0)
    x, y = polar(700.0, bearing)
    target = (-TARGET_DISTANCE, 0.0)
    closest, course = math.inf, 0.0
    for _ in range(6000):
        course = course_of(transit, (x, y), target, velocity=velocity, course=course)
        v_x, v_y = relative(course, velocity)
        x, y = x + 0.1 * v_x, y + 0.1 * v_y
        closest = min(closest, math.hypot(x, y))
        if math.hypot(x - target[0], y - target[1]) < 5.0:
            break
    assert math.hypot(x - target[0], y - target[1]) < 5.0
    # Euler steps of up to 3.7 m along a tangent only lead outwards; the straight way in at the end
    # is checked by its whole length.
    assert closest >= BLOCKED - 1e-6


PARAMETERS = ApproachParameters(
    blocked_radius=201.0, round_radius=232.0, join_distance=150.0, tracked=12.0, airspeed=21.0
)
CENTRE = (-240.0, 0.0)
AXIS = math.pi


VESSEL = SteadyTarget(0.0, 0.0)


def vehicle(place, course=0.0):
    own = TrueNavigation()
    own.update(motion(*place, course))
    return own


class Way:
    """The approach of a vehicle at a place, to a vessel at rest at the origin."""

    def __init__(self, place, course=0.0):
        self.own = vehicle(place, course)
        self.approach = Approach(PARAMETERS, tracking_parameters(), SPEED)

    def command(self, *, guarding=False):
        return self.approach.command(
            self.own, VESSEL, *CENTRE, 0.0, additional_range=0.0, guarding=guarding
        )


@pytest.mark.parametrize(
    ("north", "error", "from_afar", "once_tracking", "once_tracking_held"),
    [
        # 150 m from the centre, and 225 m once tracking.
        (-389.0, 0.0, True, True, True),
        (-391.0, 0.0, False, True, True),
        (-464.0, 0.0, False, True, True),
        (-466.0, 0.0, False, False, False),
        # Held off by the guard, the reference is lost when it is three times 12 m away.
        (-300.0, 35.0, True, True, True),
        (-300.0, 37.0, True, True, False),
    ],
)
def test_tracking_begins_nearer_to_the_centre_than_it_ends_and_not_while_the_guard_acts(
    north, error, from_afar, once_tracking, once_tracking_held
):
    def should_track(tracking, guarding):
        return Way((north, 0.0)).approach.should_track(
            vehicle((north, 0.0)),
            VESSEL,
            *CENTRE,
            AXIS,
            error=error,
            tracking=tracking,
            guarding=guarding,
        )

    assert should_track(False, False) is from_afar
    assert should_track(False, True) is False
    assert should_track(True, False) is once_tracking
    assert should_track(True, True) is once_tracking_held


def held(found, duration):
    """Return the command after the keep-out guard has turned the vehicle away for so long [s]."""
    for _ in range(round(duration / TIME_STEP)):
        found.command(guarding=True)
    return found.command()


@pytest.mark.parametrize(("east", "side"), [(-100.0, 1.0), (100.0, -1.0)])
def test_held_by_the_guard_on_a_course_beside_the_vessel_it_flies_abeam(east, side):
    # The way to the centre is the shorter one round by the vessel, 30 degrees to that side.
    beside = Way((-180.0, east), 0.0)
    assert beside.command() == side * HEADING_RATE_MAX
    quarter_turn = 0.5 * math.pi / HEADING_RATE_MAX
    assert held(beside, 0.9 * quarter_turn) == side * HEADING_RATE_MAX
    # Abeam is 61 degrees to the other side of a vessel that lies 29 degrees to this one.
    assert held(beside, 0.2 * quarter_turn) == -side * HEADING_RATE_MAX
    off = math.atan2(100.0, 180.0) - 0.5 * math.pi
    slow = Way((-180.0, east), side * (off + 0.05))
    assert held(slow, 1.1 * quarter_turn) == pytest.approx(
        -side * 2.0 * HEADING_RATE_MAX * 0.05, rel=1e-9
    )


def fly_out(x, y, course, heading_rate=0.0, duration=30.0):
    """Return distances from the vessel, and heading rates, of a vehicle that answers at once and
    leaves a vessel at rest.
    """
    egress = Egress(tracking_parameters(), SPEED, 15.0)
    distances = []
    turns = []
    for _ in range(round(duration / TIME_STEP)):
        own = AirMotion(ground_north=x, ground_east=y, course=course, heading_rate=heading_rate)
        heading_rate = egress.command(own, VESSEL, heading_rate)
        x, y, course = unicycle_move(x, y, course, SPEED, heading_rate, TIME_STEP)
        distances.append(math.hypot(x, y))
        turns.append(heading_rate)
    return distances, turns


@examples(60)
@given(bearing=courses, course=courses, distance=st.floats(150.0, 600.0))
def test_it_leads_straight_out_from_any_course(bearing, course, distance):
    distances, turns = fly_out(distance * math.cos(bearing), distance * math.sin(bearing), course)
    assert max(map(abs, turns)) <= HEADING_RATE_MAX
    # Half a turn takes pi/omega_max = 6.2 s, and what is left of the angle dies out at 2 omega_max:
    # straight out, at its speed.
    assert distances[-1] - distances[-201] == pytest.approx(200 * SPEED * TIME_STEP, rel=1e-3)
    assert abs(turns[-1]) < 1e-3 * HEADING_RATE_MAX


@pytest.mark.parametrize("turning", [0.3, -0.3])
def test_from_a_course_towards_the_vessel_it_keeps_to_the_turn_that_it_has_begun(turning):
    # Straight at it, either way is as far; a first step past the middle would make the other turn
    # the shorter one.
    _, turns = fly_out(400.0, 0.0, math.pi - math.copysign(0.01, turning), heading_rate=turning)
    assert turns[0] == math.copysign(HEADING_RATE_MAX, turning)
    first = round(4.0 / TIME_STEP)
    assert all(math.copysign(1.0, turn) == math.copysign(1.0, turning) for turn in turns[:first])
