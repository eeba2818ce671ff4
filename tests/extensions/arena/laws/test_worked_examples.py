"""The other laws against the worked examples of guidance-laws.md, to their printed digits."""

import math

import pytest

from extensions.arena.laws.lgvf import circle_course, heading_rate, lgvf
from extensions.arena.laws.park import park_l1, point_on_circle, point_on_line
from extensions.arena.laws.pursuit import (
    carrot_on_circle,
    carrot_on_line,
    chase,
    collision_course,
    look_ahead_line_of_sight,
    plos,
    pure_pursuit,
    sight_rate,
)
from extensions.arena.laws.vector_field import (
    field_heading_rate,
    line_course,
    line_field,
    orbit_course,
    orbit_field,
    orbit_roll,
)
from gnc.laws import line_of_sight_law
from gnc.steering import DesiredCourse
from gnc.vectors import along, course_of, minus, scaled

ORIGIN = (0.0, 0.0)
QUARTER = 0.5 * math.pi
# Half a digit of the seven that are printed.
PRINTED = 5e-7


def test_parks_law():
    # Section 3: on a line eta = -0.3398369 and a = -4.444444; on a circle q = (-49.88877, 86.66667)
    # and a = 7.407407.
    beside, outside = (0.0, 20.0), (0.0, 120.0)
    ahead = point_on_line(beside, 0.0, 60.0)
    assert course_of(minus(ahead, beside)) == pytest.approx(-0.3398369, abs=PRINTED)
    assert park_l1(beside, (20.0, 0.0), ahead) == pytest.approx(-4.444444, abs=PRINTED)
    ahead = point_on_circle(outside, ORIGIN, 100.0, 1, 60.0)
    assert ahead == pytest.approx((-49.88877, 86.66667), abs=5e-6)
    assert park_l1(outside, (-20.0, 0.0), ahead) == pytest.approx(7.407407, abs=PRINTED)


def test_fields_of_lines_and_circles():
    beside, outside, circle = (0.0, 20.0), (150.0, 0.0), (ORIGIN, 100.0, 1)
    # Section 4.1, ROSplane: chi_c = -0.25; orbit 2.677945, feed-forward 0.3871671.
    command = line_course(beside, 0.3, 0.0, gain=0.05, approach=0.5)
    assert command == pytest.approx(-0.25, abs=1e-12)
    assert orbit_course(outside, *circle, gain=4.0) == pytest.approx(2.677945, abs=PRINTED)
    assert orbit_roll(20.0, 100.0, 1, 0.0, 0.0) == pytest.approx(0.3871671, abs=PRINTED)
    # Section 4.2, the vector field: chi_d = -0.785398, u = -1.681616.
    field = line_field(beside, scaled(along(0.3), 15.0), 0.0, gain=0.05, approach=QUARTER)
    assert field.course == pytest.approx(-0.785398, abs=PRINTED)
    rate = field_heading_rate(field, 0.3, kappa=QUARTER, width=1.0)
    assert rate == pytest.approx(-1.681616, abs=PRINTED)
    # Section 5a, LGVF: psi_d = 1.706281, rate 0.1468943, omega = 0.8531753.
    field = lgvf(outside, 1.0, 15.0, *circle, (5.0, 0.0), (0.0, 2.0))
    assert field == pytest.approx((1.706281, 0.1468943), abs=PRINTED)
    assert heading_rate(field, 1.0, 1.0) == pytest.approx(0.8531753, abs=PRINTED)
    # And along the field 4 V R^3/(r^2 + R^2)^2. Rounding.
    field = lgvf(outside, circle_course(outside, 100.0, 1), 15.0, *circle, ORIGIN, ORIGIN)
    expected = 4.0 * 15.0 * 100.0**3 / (150.0**2 + 100.0**2) ** 2
    assert field.rate == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("side", [1, -1])
def test_rates_of_the_fields_are_their_changes_along_the_way(side):
    position, velocity, drift, step = (60.0, 90.0), (9.0, -12.0), (3.0, 2.0), 1e-5
    through_air = velocity[0] + drift[0], velocity[1] + drift[1]

    def orbit(place):
        return orbit_field(place, velocity, ORIGIN, 100.0, side, gain=0.05)

    def lyapunov(place):
        heading, airspeed = course_of(through_air), math.hypot(*through_air)
        return lgvf(place, heading, airspeed, ORIGIN, 100.0, side, drift, ORIGIN)

    def line(place):
        # A line that turns at 0.1 rad/s, seen after the time that the way has taken.
        course = 0.4 + 0.1 * (place[0] - position[0]) / velocity[0]
        return line_field(place, velocity, course, gain=0.05, approach=1.2, line_rate=0.1)

    def sight(place):
        # Without its gain the law turns as the course that it demands; with it, by the rest, too.
        course = 0.4 + 0.1 * (place[0] - position[0]) / velocity[0]
        way = course_of(velocity), math.hypot(*velocity)
        rate, more = (
            look_ahead_line_of_sight(place, *way, course, 0.1, look_ahead=30.0, gain=gain)
            for gain in (0.0, 1.0)
        )
        return DesiredCourse(way[0] + more - rate, rate)

    for field in (orbit, lyapunov, line, sight):
        before, after = (
            field((position[0] + by * velocity[0], position[1] + by * velocity[1])).course
            for by in (-step, step)
        )
        # A central difference over 2e-5 s: rounding of 1e-16/1e-5.
        expected = (after - before) / (2.0 * step)
        assert field(position).rate == pytest.approx(expected, abs=1e-9), field


def test_the_pursuits():
    course, speed, target, target_course, target_speed = 0.2, 15.0, (50.0, 30.0), 1.0, 10.0
    relative = minus(scaled(along(target_course), target_speed), scaled(along(course), speed))
    # Section 6: lam-dot, proportional pursuit, geometric, constant bearing.
    assert sight_rate(target, relative) == pytest.approx(0.1619626, abs=PRINTED)
    assert line_of_sight_law(*target, course, 1.0) == pytest.approx(0.3404195, abs=PRINTED)
    found = pure_pursuit(target, course, speed, range_min=20.0)
    assert found == pytest.approx(0.1717812, abs=PRINTED)
    found = collision_course(target, target_course, target_speed / speed) - course
    assert found == pytest.approx(0.6406232, abs=PRINTED)


def test_a_carrot_is_ahead_of_the_nearest_point():
    # Section 6: s = 10 along the line, delta 40; on the circle phi = 0, lambda a quarter of a turn
    # to the right.
    assert carrot_on_line((10.0, 5.0), (1.0, 0.0), 40.0) == (50.0, 0.0)
    found = carrot_on_circle((150.0, 0.0), ORIGIN, 100.0, 1, QUARTER)
    assert found == pytest.approx((0.0, 100.0))
    found = chase(ORIGIN, (10.0, 0.0), (10.0, 10.0), 2.0)
    assert found == pytest.approx(2.0 * 10.0 * 0.5 * QUARTER)
    # k_1 V (-45 degrees) - k_2 V e.
    gains = {"pursuit_gain": 1.0, "sight_gain": 0.1}
    found = plos((0.0, 3.0), (10.0, 0.0), (1.0, 0.0), (3.0, 0.0), **gains)
    assert found == pytest.approx(-10.0 * 0.5 * QUARTER - 0.1 * 10.0 * 3.0)
