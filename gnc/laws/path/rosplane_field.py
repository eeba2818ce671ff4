"""Vector fields for lines and circles as ROSplane flies them: a course command, and a roll fed
forward on a circle.

Source: R. W. Beard, T. W. McLain, Small Unmanned Aircraft, chapter 10, with the parameters of
ROSplane (BSD-3-Clause). Written from equations, not from code.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.path.adapter import PathLaw, PathMotion
from gnc.laws.steering_law import CIRCLES_ALONE, ON_OSCILLATION, steering_law
from gnc.numeric import wrap
from gnc.vectors import Vector, along, course_of, cross, minus, norm

_HALF_PI = 0.5 * math.pi
_G = 9.81
"""Gravity as ROSplane has it [m/s2]."""


def line_course(
    position: Vector,
    course: float,
    origin: Vector,
    line_course: float,
    *,
    gain: float,
    approach: float,
) -> float:
    """Return the course command for a line, as ROSplane flies it [rad].

    Parameters
    ----------
    position, course : of the vehicle [m, rad]
    origin, line_course : a point of the line [m], and its course [rad]
    gain : k_path [1/m]
    approach : chi_inf, course towards the line from far away [rad]
    """
    nearest = course + wrap(line_course - course)
    error = cross(along(nearest), minus(position, origin))
    return nearest - approach * math.atan(gain * error) / _HALF_PI


def orbit_course(
    position: Vector, centre: Vector, radius: float, side: int, *, gain: float
) -> float:
    """Return the course command for a circle, as ROSplane flies it, within a turn [rad].

    Parameters
    ----------
    position : of the vehicle [m]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    gain : k_orbit [-]
    """
    from_centre = minus(position, centre)
    off = (norm(from_centre) - radius) / radius
    return wrap(course_of(from_centre) + side * (_HALF_PI + math.atan(gain * off)))


def orbit_roll(airspeed: float, radius: float, side: int, course: float, heading: float) -> float:
    """Return ROSplane's roll feed-forward on a circle [rad], from airspeed [m/s], radius [m], side,
    course and heading [rad].
    """
    return side * math.atan(airspeed * airspeed / (_G * radius * math.cos(course - heading)))


@steering_law("rosplane_field")
@dataclass(frozen=True, slots=True, kw_only=True)
class RosplaneFieldLaw(PathLaw):
    """ROSplane's course command for the reference's tangent (M1), with a heading rate in proportion
    to the course error.

    Attributes
    ----------
    path_gain_per_m : k_path, how steeply the field turns with the distance from the line [1/m]
    path_approach_rad : chi_inf, course towards the line from far away [rad]
    course_gain_per_s : k_chi, heading rate per course error [1/s]
    """

    given: ClassVar[str] = "tangent of the path over the ground (M1)"
    path_gain_per_m: float = 0.05
    path_approach_rad: float = 0.5
    course_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        course = course_of(motion.velocity)
        command = line_course(
            motion.position,
            course,
            (0.0, 0.0),
            course_of(motion.tangent),
            gain=self.path_gain_per_m,
            approach=self.path_approach_rad,
        )
        return self.course_gain_per_s * wrap(command - course)


@steering_law("rosplane_orbit")
@dataclass(frozen=True, slots=True, kw_only=True)
class RosplaneOrbitLaw(PathLaw):
    """ROSplane's course command for a circle in the frame of its centre (M2), with its roll fed
    forward.

    Attributes
    ----------
    orbit_gain : k_orbit, how steeply the field turns with the distance from the circle, in radii
        [-]
    course_gain_per_s : k_chi, heading rate per course error [1/s]
    """

    given: ClassVar[str] = "the circle in the frame of its centre (M2)"
    cannot: ClassVar[dict[str, str]] = {ON_OSCILLATION: CIRCLES_ALONE}
    orbit_gain: float = 4.0
    course_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        course, (centre, radius, side) = course_of(motion.velocity), motion.circle
        command = orbit_course(motion.position, centre, radius, side, gain=self.orbit_gain)
        roll = orbit_roll(motion.airspeed, radius, side, course, motion.heading)
        return (
            self.course_gain_per_s * wrap(command - course) + _G * math.tan(roll) / motion.airspeed
        )
