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
from gnc.vectors import along, course_of, minus, scaled

ORIGIN = (0.0, 0.0)
# Half a digit of the seven that are printed.
PRINTED = 5e-7


def test_parks_law_on_a_line():
    target = point_on_line((0.0, 20.0), 0.0, 60.0)
    # Section 3: eta = -0.3398369, a = -4.444444.
    assert course_of(minus(target, (0.0, 20.0))) == pytest.approx(-0.3398369, abs=PRINTED)
    assert park_l1((0.0, 20.0), (20.0, 0.0), target) == pytest.approx(-4.444444, abs=PRINTED)


def test_parks_law_on_a_circle():
    target = point_on_circle((0.0, 120.0), ORIGIN, 100.0, 1, 60.0)
    # Section 3: q = (-49.88877, 86.66667), a = 7.407407.
    assert target == pytest.approx((-49.88877, 86.66667), abs=5e-6)
    assert park_l1((0.0, 120.0), (-20.0, 0.0), target) == pytest.approx(7.407407, abs=PRINTED)


def test_rosplanes_courses():
    # Section 4.1: chi_c = -0.25; orbit 2.677945, feed-forward 0.3871671.
    assert line_course((0.0, 20.0), 0.3, 0.0, gain=0.05, approach=0.5) == pytest.approx(
        -0.25, abs=1e-12
    )
    assert orbit_course((150.0, 0.0), ORIGIN, 100.0, 1, gain=4.0) == pytest.approx(
        2.677945, abs=PRINTED
    )
    assert orbit_roll(20.0, 100.0, 1, 0.0, 0.0) == pytest.approx(0.3871671, abs=PRINTED)


def test_the_vector_field_of_a_line():
    field = line_field(
        (0.0, 20.0), scaled(along(0.3), 15.0), 0.0, gain=0.05, approach=0.5 * math.pi
    )
    # Section 4.2: chi_d = -0.785398, u = -1.681616.
    assert field.course == pytest.approx(-0.785398, abs=PRINTED)
    assert field_heading_rate(field, 0.3, kappa=0.5 * math.pi, width=1.0) == pytest.approx(
        -1.681616, abs=PRINTED
    )


@pytest.mark.parametrize("side", [1, -1])
def test_rates_of_the_fields_are_their_changes_along_the_way(side):
    position, velocity, step = (60.0, 90.0), (9.0, -12.0), 1e-5

    def moved(by):
        return (position[0] + by * velocity[0], position[1] + by * velocity[1])

    def slope(course):
        return (course(moved(step)) - course(moved(-step))) / (2.0 * step)

    # A central difference over 2e-5 s: rounding of 1e-16/1e-5.
    orbit = orbit_field(position, velocity, ORIGIN, 100.0, side, gain=0.05)
    assert orbit.rate == pytest.approx(
        slope(lambda p: orbit_field(p, velocity, ORIGIN, 100.0, side, gain=0.05).course), abs=1e-9
    )
    drift = (3.0, 2.0)
    heading = course_of((velocity[0] + drift[0], velocity[1] + drift[1]))
    airspeed = math.hypot(velocity[0] + drift[0], velocity[1] + drift[1])

    def field(p):
        return lgvf(p, heading, airspeed, ORIGIN, 100.0, side, drift, ORIGIN)

    assert field(position).rate == pytest.approx(slope(lambda p: field(p).course), abs=1e-9)


def test_the_lyapunov_guidance_vector_field():
    field = lgvf((150.0, 0.0), 1.0, 15.0, ORIGIN, 100.0, 1, (5.0, 0.0), (0.0, 2.0))
    # Section 5a: psi_d = 1.706281, rate 0.1468943, omega = 0.8531753.
    assert field == pytest.approx((1.706281, 0.1468943), abs=PRINTED)
    assert heading_rate(field, 1.0, 1.0) == pytest.approx(0.8531753, abs=PRINTED)


def test_along_the_lyapunov_field_the_course_turns_as_in_closed_form():
    radius, speed, position = 100.0, 15.0, (150.0, 0.0)
    course = circle_course(position, radius, 1)
    field = lgvf(position, course, speed, ORIGIN, radius, 1, ORIGIN, ORIGIN)
    # Section 5a: 4 V R^3/(r^2 + R^2)^2. Rounding.
    assert field.rate == pytest.approx(
        4.0 * speed * radius**3 / (150.0**2 + radius**2) ** 2, rel=1e-12
    )


def test_the_pursuits():
    course, speed, target, target_course, target_speed = 0.2, 15.0, (50.0, 30.0), 1.0, 10.0
    relative = minus(scaled(along(target_course), target_speed), scaled(along(course), speed))
    # Section 6: lam-dot, proportional pursuit, geometric, PN, constant bearing.
    assert sight_rate(target, relative) == pytest.approx(0.1619626, abs=PRINTED)
    assert line_of_sight_law(*target, course, 1.0) == pytest.approx(0.3404195, abs=PRINTED)
    assert pure_pursuit(target, course, speed, range_min=20.0) == pytest.approx(
        0.1717812, abs=PRINTED
    )
    assert 3.0 * sight_rate(target, relative) == pytest.approx(0.4858877, abs=PRINTED)
    assert collision_course(target, target_course, target_speed / speed) - course == pytest.approx(
        0.6406232, abs=PRINTED
    )


def test_a_carrot_is_ahead_of_the_nearest_point():
    # Section 6: s = 10 along the line, delta 40; on the circle phi = 0, lambda a quarter of a turn
    # to the right.
    assert carrot_on_line((10.0, 5.0), (1.0, 0.0), 40.0) == (50.0, 0.0)
    assert carrot_on_circle((150.0, 0.0), ORIGIN, 100.0, 1, 0.5 * math.pi) == pytest.approx(
        (0.0, 100.0)
    )
    assert chase(ORIGIN, (10.0, 0.0), (10.0, 10.0), 2.0) == pytest.approx(
        2.0 * 10.0 * 0.25 * math.pi
    )
    pursued = plos(
        (0.0, 3.0), (10.0, 0.0), (1.0, 0.0), (3.0, 0.0), pursuit_gain=1.0, sight_gain=0.1
    )
    # k_1 V (-45 degrees) - k_2 V e.
    assert pursued == pytest.approx(-10.0 * 0.25 * math.pi - 0.1 * 10.0 * 3.0)
