"""Vectors in the plane, north and east."""

import math

Vector = tuple[float, float]
"""North and east."""


def cross(a: Vector, b: Vector) -> float:
    """Return a x b: positive where ``b`` points to the right of ``a``."""
    return a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> float:
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1]


def norm(a: Vector) -> float:
    """Return the length."""
    return math.hypot(a[0], a[1])


def minus(a: Vector, b: Vector) -> Vector:
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1]


def plus(a: Vector, b: Vector, times: float = 1.0) -> Vector:
    """Return a + times b."""
    return a[0] + times * b[0], a[1] + times * b[1]


def scaled(a: Vector, by: float) -> Vector:
    """Return ``by`` a."""
    return a[0] * by, a[1] * by


def right_of(a: Vector) -> Vector:
    """Return ``a`` turned right by a quarter turn."""
    return -a[1], a[0]


def along(course: float) -> Vector:
    """Return the unit vector of a course [rad]."""
    return math.cos(course), math.sin(course)


def course_of(a: Vector) -> float:
    """Return the course of a vector [rad]."""
    return math.atan2(a[1], a[0])
