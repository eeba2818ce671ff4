import math

import pytest
from gnc_cases import SPEED, courses, examples
from hypothesis import assume, given
from hypothesis import strategies as st

from gnc.mission.transit import Transit

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
    place, goal, velocity = (
        polar(distance, bearing),
        polar(TARGET_DISTANCE, target),
        polar(speed, heading),
    )
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
    place, goal, velocity = (
        polar(distance, bearing),
        polar(TARGET_DISTANCE, target),
        polar(speed, heading),
    )
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
    def asked(side, nudge=0.0):
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
    assume(len({asked(1, nudge)[0] for nudge in (-1e-6, 0.0, 1e-6)}) == 1)
    (one, found), (other, mirrored) = asked(1), asked(-1)
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
