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
from hypothesis import assume, given
from hypothesis import strategies as st

from gnc.estimation.navigation import AirMotion, TrueNavigation
from gnc.estimation.vessel import SteadyTarget
from gnc.mission.way import Approach, ApproachParameters, Egress, Transit, course_ahead
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


geometry = {
    "distance": st.floats(BLOCKED + 0.1, 1500.0),
    "bearing": courses,
    "target": courses,
    "course": courses,
    "speed": st.floats(0.0, 0.95 * SPEED),
    "heading": courses,
}


@given(**geometry)
@examples(200)
def test_the_straight_relative_way_never_enters_the_blocked_circle_from_outside(
    distance, bearing, target, course, speed, heading
):
    place = polar(distance, bearing)
    goal = polar(TARGET_DISTANCE, target)
    velocity = polar(speed, heading)
    transit = Transit(TURN_RADIUS)
    way = relative(course_of(transit, place, goal, velocity=velocity, course=course), velocity)
    # As far as the target where the way there is clear, or else past the tangent point, far enough
    # for all that is ahead.
    length = math.hypot(goal[0] - place[0], goal[1] - place[1]) if transit.side == 0 else 1e4
    # Rounding.
    assert nearest(place, way, length) >= BLOCKED - 1e-6


@given(**geometry)
@examples(100)
def test_the_relative_velocity_lies_along_the_way_to_the_target_where_that_is_clear(
    distance, bearing, target, course, speed, heading
):
    place = polar(distance, bearing)
    goal = polar(TARGET_DISTANCE, target)
    velocity = polar(speed, heading)
    transit = Transit(TURN_RADIUS)
    way = relative(course_of(transit, place, goal, velocity=velocity, course=course), velocity)
    to = (goal[0] - place[0], goal[1] - place[1])
    assume(transit.side == 0 and math.hypot(*to) > 1.0)
    # Cross and dot product: along it, not against it. Rounding.
    assert to[0] * way[1] - to[1] * way[0] == pytest.approx(0.0, abs=1e-9 * SPEED * math.hypot(*to))
    assert to[0] * way[0] + to[1] * way[1] > 0.0


@given(**geometry)
@examples(100)
def test_mirrored_geometry_gives_the_mirrored_course(
    distance, bearing, target, course, speed, heading
):
    def found_on(side, nudge=0.0):
        transit = Transit(TURN_RADIUS)
        found = course_of(
            transit,
            polar(distance, side * bearing),
            polar(TARGET_DISTANCE, side * (target + nudge)),
            velocity=polar(speed, side * heading),
            course=side * (course + nudge),
        )
        return transit.side, found

    # Where both sides are as long, or the way is just clear, the first is taken, mirrored or not: a
    # hair's breadth decides.
    assume(len({found_on(1, nudge)[0] for nudge in (-1e-6, 0.0, 1e-6)}) == 1)
    (one, found), (other, mirrored) = found_on(1), found_on(-1)
    assert one == -other
    assert math.remainder(found + mirrored, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("sign", [1, -1])
def test_it_passes_on_the_shorter_side(sign):
    # Ahead of the disc, north of it, and 30 degrees to one side; the target is south. Straight
    # there is through the disc.
    transit = Transit(TURN_RADIUS)
    bearing = sign * math.radians(30.0)
    found = course_of(
        transit, polar(600.0, bearing), (-TARGET_DISTANCE, 0.0), course=bearing + math.pi
    )
    # On the east side clockwise as seen from above, on the west side the other way; either way the
    # tangent of the round circle.
    assert transit.side == sign
    expected = bearing + math.pi - sign * math.asin(ROUND / 600.0)
    assert math.remainder(found - expected, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_of_two_ways_nearly_as_long_it_takes_the_one_that_it_need_not_turn_to(sign):
    # From 0.02 rad to the other side, so that the way round on this one is 0.04 rad of the round
    # circle longer; it heads there.
    transit, bearing = Transit(TURN_RADIUS), -sign * 0.02
    lean = math.asin(ROUND / 600.0)
    course_of(
        transit,
        polar(600.0, bearing),
        (-TARGET_DISTANCE, 0.0),
        course=bearing + math.pi - sign * lean,
    )
    assert transit.side == sign


def test_it_keeps_the_side_that_it_has_chosen_until_the_way_is_clear():
    transit = Transit(TURN_RADIUS)
    target = (-TARGET_DISTANCE, 0.0)
    course_of(transit, polar(600.0, 0.1), target, course=math.pi)
    assert transit.side == 1
    # Now a little on the other side, where a fresh look would choose the other way.
    course_of(transit, polar(600.0, -0.1), target, course=math.pi)
    assert transit.side == 1
    course_of(transit, polar(600.0, 3.0), target, course=math.pi)
    assert transit.side == 0


@pytest.mark.parametrize("bearing", [0.0, 0.7, 2.0, -1.3])
@pytest.mark.parametrize("speed_ratio", [0.0, 0.5, 0.9])
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


@pytest.mark.parametrize(
    ("distance", "outwards"),
    # Of the relative velocity, sin 0.6 leads outwards until a turn radius is left to the circle,
    # then proportionally less.
    [
        (10.0, 0.5646),
        (100.0, 0.5646),
        (ROUND - TURN_RADIUS, 0.5646),
        (ROUND - 0.5 * TURN_RADIUS, 0.2955),
        (ROUND - 1e-6, 0.0),
    ],
)
def test_inside_the_circle_it_leads_outwards(distance, outwards):
    place = polar(distance, 0.4)
    way = relative(course_of(Transit(TURN_RADIUS), place, (-TARGET_DISTANCE, 0.0)), (0.0, 0.0))
    assert (place[0] * way[0] + place[1] * way[1]) / (distance * SPEED) == pytest.approx(
        outwards, abs=1e-4
    )


PARAMETERS = ApproachParameters(
    blocked_radius=201.0, round_radius=232.0, join_distance=150.0, tracked=12.0, airspeed=21.0
)
CENTRE = (-240.0, 0.0)
AXIS = math.pi


VESSEL = SteadyTarget(0.0, 0.0)


def vehicle(place, course=0.0, *, heading_rate=0.0):
    own = TrueNavigation()
    own.update(motion(*place, course, SPEED, heading_rate))
    return own


class Way:
    """The approach of a vehicle at a place, to a vessel at rest at the origin."""

    def __init__(self, place, course=0.0, *, lag=0.0, heading_rate=0.0):
        self.own = vehicle(place, course, heading_rate=heading_rate)
        self.approach = Approach(PARAMETERS, tracking_parameters(lag=lag), SPEED)

    def command(self, last=0.0, *, additional_range=0.0, guarding=False):
        return self.approach.command(
            self.own, VESSEL, *CENTRE, last, additional_range=additional_range, guarding=guarding
        )

    def should_track(self, centre=CENTRE, *, error=0.0, tracking=False, guarding=False):
        return self.approach.should_track(
            self.own, VESSEL, *centre, AXIS, error=error, tracking=tracking, guarding=guarding
        )


@pytest.mark.parametrize(
    ("place", "from_afar", "once_tracking"),
    [
        # 150 m from the centre, and 225 m once tracking.
        ((-389.0, 0.0), True, True),
        ((-391.0, 0.0), False, True),
        ((-464.0, 0.0), False, True),
        ((-466.0, 0.0), False, False),
    ],
)
def test_tracking_begins_nearer_to_the_centre_than_it_ends(place, from_afar, once_tracking):
    assert Way(place).should_track() is from_afar
    assert Way(place).should_track(tracking=True) is once_tracking


@pytest.mark.parametrize(
    ("aspect", "from_afar", "once_tracking"),
    [(1.15, True, True), (1.25, False, True), (1.85, False, True), (1.95, False, False)],
)
def test_tracking_begins_nearer_to_the_plumes_axis_than_it_ends(aspect, from_afar, once_tracking):
    # 1.2 and 1.9 rad off the axis; near enough to the vessel that a centre 100 m astern of it is
    # within 150 m at any aspect.
    way = Way((-20.0 * math.cos(aspect), 20.0 * math.sin(aspect)))
    centre = (-100.0, 0.0)
    assert way.should_track(centre, tracking=False) is from_afar
    assert way.should_track(centre, tracking=True) is once_tracking


@pytest.mark.parametrize(("error", "tracked_on"), [(35.0, True), (37.0, False)])
def test_the_guard_holds_off_who_joins_and_who_has_lost_the_reference(error, tracked_on):
    place = (-300.0, 0.0)
    assert Way(place).should_track(error=error)
    assert not Way(place).should_track(error=error, guarding=True)
    # Lost: three times 12 m away.
    assert Way(place).should_track(error=error, tracking=True, guarding=True) is tracked_on
    assert Way(place).should_track(error=error, tracking=True)


def test_the_command_turns_to_the_centre_and_within_omega_max():
    # 0.1 rad off: twice omega_max per radian.
    found = Way((-600.0, 0.0), 0.1).command()
    assert found == pytest.approx(-2.0 * HEADING_RATE_MAX * 0.1, rel=1e-9)
    for course in (-3.0, -1.0, 1.0, 3.0):
        found = Way((-600.0, 0.0), course).command()
        assert found == math.copysign(HEADING_RATE_MAX, -course)


def test_it_leads_round_the_vessel_from_ahead():
    # Straight astern from 600 m ahead lies the vessel.
    towards = Way((600.0, 10.0), math.pi)
    assert abs(towards.command()) > 0.1
    # The farther the larger the area that it has to go round.
    assert abs(towards.command(additional_range=60.0)) > abs(towards.command())


def test_it_turns_from_the_course_that_it_will_have_when_the_command_acts():
    late = Way((-600.0, 0.0), 0.1, lag=0.4, heading_rate=0.2)
    # Linear from 0.2 to 0.1 rad/s in 0.4 s: 0.06 rad.
    assert course_ahead(late.own, 0.1, 0.4) == pytest.approx(0.16, abs=1e-12)
    assert late.command(0.1) == pytest.approx(-2.0 * HEADING_RATE_MAX * 0.16, rel=1e-9)


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


def test_it_flies_abeam_no_farther_than_it_goes_round_the_vessel():
    # 232 m; and not where the way does not lead through the course to the vessel.
    quarter_turn = 0.5 * math.pi / HEADING_RATE_MAX
    assert held(Way((-205.0, -112.0), 0.0), 2.0 * quarter_turn) == HEADING_RATE_MAX
    assert held(Way((-180.0, -100.0), math.pi), 2.0 * quarter_turn) == -HEADING_RATE_MAX


def test_tracking_does_not_begin_while_it_flies_abeam():
    beside = Way((-180.0, -100.0), 0.0)
    assert beside.should_track()
    held(beside, math.pi / HEADING_RATE_MAX)
    assert not beside.should_track()


def test_whom_the_guard_threw_back_joins_from_half_as_far_but_not_from_nearer_than_counts_as_lost():
    found, reached = Way((-390.0 + 1.0, 0.0)), []
    for _ in range(4):
        reached.append([off for off in (149.0, 74.0, 37.0, 35.0) if joins_from(found, off)])
        found.approach.halve_join_distance()
    # 150, 75, 37.5 and 36 m: three times 12.
    assert reached == [[149.0, 74.0, 37.0, 35.0], [74.0, 37.0, 35.0], [37.0, 35.0], [35.0]]


def joins_from(found, off):
    # The vehicle is 389 m astern.
    return found.should_track((-389.0 + off, 0.0))


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


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_where_one_turn_is_shorter_it_is_taken_from_any_turn(side):
    # 120 degrees to go: to the right for a vehicle east of north by that.
    own = AirMotion(
        ground_north=400.0,
        ground_east=0.0,
        course=-side * math.radians(120.0),
        heading_rate=-side * 0.4,
    )
    egress = Egress(tracking_parameters(), SPEED, 15.0)
    assert egress.command(own, VESSEL, 0.0) == side * HEADING_RATE_MAX
