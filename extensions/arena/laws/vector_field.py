"""Vector fields for lines and circles: a course for every place.

There are two kinds of laws. The first commands the heading rate that turns the vehicle into the
field: D. R. Nelson, D. B. Barber, T. W. McLain, R. W. Beard, "Vector Field Path Following for
Miniature Air Vehicles", IEEE TRO 23(3), 2007. The second, ROSplane, commands the course of the
field: R. W. Beard, T. W. McLain, Small Unmanned Aircraft, chapter 10, with the parameters of
ROSplane (BSD-3-Clause). Written from equations, not from code.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from extensions.arena.laws.path import PathLaw, PathMotion
from gnc.laws import ONLY_CIRCLES, CheckedLaw
from gnc.numeric import limited, wrap
from gnc.reference.reference import Reference
from gnc.steering import Air, DesiredCourse, Motion, heading_for
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, scaled

_HALF_PI = 0.5 * math.pi


# ---------------------------------------------------------------- Nelson, Barber, McLain, Beard


def line_field(
    position: Vector,
    velocity: Vector,
    line_course: float,
    *,
    gain: float,
    approach: float,
    line_rate: float = 0.0,
) -> DesiredCourse:
    """Return the field of a line, which may turn about one of its points.

    Parameters
    ----------
    position, velocity : of the vehicle, from that point [m, m/s]
    line_course : course of the line [rad]
    gain : k [1/m]
    approach : chi_inf [rad]
    line_rate : rate of the line's course [rad/s]
    """
    tangent = along(line_course)
    error = cross(tangent, position)
    error_rate = cross(tangent, velocity) - line_rate * dot(tangent, position)
    slope = approach / _HALF_PI
    return DesiredCourse(
        course=line_course - slope * math.atan(gain * error),
        rate=line_rate - slope * gain * error_rate / (1.0 + (gain * error) ** 2),
    )


def orbit_field(
    position: Vector, velocity: Vector, centre: Vector, radius: float, side: int, *, gain: float
) -> DesiredCourse:
    """Return the field of a circle, a course of the velocity relative to its centre.

    Parameters
    ----------
    position : of the vehicle [m]
    velocity : of the vehicle relative to the centre [m/s]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    gain : k [1/m]
    """
    from_centre = minus(position, centre)
    distance = norm(from_centre)
    bearing = course_of(from_centre)
    outward = along(bearing)
    bearing_rate = cross(outward, velocity) / distance if distance > 0.0 else 0.0
    error = gain * (distance - radius)
    return DesiredCourse(
        course=bearing + side * (_HALF_PI + math.atan(error)),
        rate=bearing_rate + side * gain * dot(outward, velocity) / (1.0 + error * error),
    )


def field_heading_rate(field: DesiredCourse, course: float, *, kappa: float, width: float) -> float:
    """Return the heading rate that turns the vehicle into a field, u of Nelson et al. [rad/s].

    Parameters
    ----------
    field : at the place of the vehicle
    course : of the vehicle [rad]
    kappa : largest part for the course error [rad/s]
    width : eps, course error beyond which that part is the largest [rad]
    """
    return field.rate - kappa * limited(wrap(course - field.course) / width, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class VectorFieldLaw(CheckedLaw):
    """The vector field of the reference's tangent, which turns with the reference (M1).

    Attributes
    ----------
    field_gain_per_m : k, how steeply the field turns with the distance from the path [1/m]
    field_approach_rad : chi_inf, course towards the tangent from far away [rad]
    field_rate_rad_s : kappa, largest part of the heading rate for the course error [rad/s]
    field_width_rad : eps, course error beyond which that part is the largest [rad]
    """

    inputs: ClassVar[str] = "tangent of the path through the air (M1), and its turn rate"
    field_gain_per_m: float = 0.05
    field_approach_rad: float = _HALF_PI
    field_rate_rad_s: float = _HALF_PI
    field_width_rad: float = 1.0

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        to_reference = reference.north - own.north, reference.east - own.east
        field = line_field(
            scaled(to_reference, -1.0),
            scaled(along(own.course), own.speed),
            reference.course,
            gain=self.field_gain_per_m,
            approach=self.field_approach_rad,
            line_rate=reference.heading_rate,
        )
        return field_heading_rate(
            field, own.course, kappa=self.field_rate_rad_s, width=self.field_width_rad
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitFieldLaw(PathLaw):
    """The vector field of a circle in the frame of its centre (M2).

    Attributes
    ----------
    field_gain_per_m : k, how steeply the field turns with the distance from the path [1/m]
    field_rate_rad_s : kappa, largest part of the heading rate for the course error [rad/s]
    field_width_rad : eps, course error beyond which that part is the largest [rad]
    """

    inputs: ClassVar[str] = "the circle in the frame of its centre (M2); wind"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_CIRCLES
    field_gain_per_m: float = 0.05
    field_rate_rad_s: float = _HALF_PI
    field_width_rad: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s].

        A centre that is as fast as the vehicle is followed, not circled.
        """
        drift = scaled(motion.wind, -1.0)
        if norm(drift) < motion.airspeed:
            relative = orbit_field(
                motion.position, motion.velocity, *motion.circle, gain=self.field_gain_per_m
            )
            field = heading_for(relative.course, relative.rate, motion.airspeed, drift)
        else:
            field = DesiredCourse(course_of(drift), 0.0)
        return field_heading_rate(
            field, motion.heading, kappa=self.field_rate_rad_s, width=self.field_width_rad
        )


# ---------------------------------------------------------------- ROSplane

_G = 9.81
"""Gravity as ROSplane has it [m/s2]."""


def line_course(
    position: Vector,
    course: float,
    line_course: float,
    *,
    gain: float,
    approach: float,
) -> float:
    """Return ROSplane's course command for a line [rad].

    Parameters
    ----------
    position, course : of the vehicle, from a point of the line [m, rad]
    line_course : course of the line [rad]
    gain : k_path [1/m]
    approach : chi_inf, course towards the line from far away [rad]
    """
    nearest = course + wrap(line_course - course)
    error = cross(along(nearest), position)
    return nearest - approach * math.atan(gain * error) / _HALF_PI


def orbit_course(
    position: Vector, centre: Vector, radius: float, side: int, *, gain: float
) -> float:
    """Return ROSplane's course command for a circle, between -pi and pi [rad].

    Parameters
    ----------
    position : of the vehicle [m]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    gain : k_orbit [-]
    """
    from_centre = minus(position, centre)
    error = (norm(from_centre) - radius) / radius
    return wrap(course_of(from_centre) + side * (_HALF_PI + math.atan(gain * error)))


def orbit_roll(airspeed: float, radius: float, side: int, course: float, heading: float) -> float:
    """Return ROSplane's roll feed-forward on a circle [rad].

    Parameters
    ----------
    airspeed : [m/s]
    radius : [m]
    side : +1 clockwise, -1 anticlockwise
    course, heading : of the vehicle [rad]
    """
    return side * math.atan(airspeed * airspeed / (_G * radius * math.cos(course - heading)))


@dataclass(frozen=True, slots=True, kw_only=True)
class RosplaneFieldLaw(PathLaw):
    """ROSplane's course command for the reference's tangent (M1).

    Attributes
    ----------
    path_gain_per_m : k_path, how steeply the field turns with the distance from the line [1/m]
    path_approach_rad : chi_inf, course towards the line from far away [rad]
    course_gain_per_s : k_chi, heading rate per course error [1/s]
    """

    inputs: ClassVar[str] = "tangent of the path over the ground (M1)"
    path_gain_per_m: float = 0.05
    path_approach_rad: float = 0.5
    course_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        course = course_of(motion.velocity)
        command = line_course(
            motion.position,
            course,
            course_of(motion.tangent),
            gain=self.path_gain_per_m,
            approach=self.path_approach_rad,
        )
        return self.course_gain_per_s * wrap(command - course)


@dataclass(frozen=True, slots=True, kw_only=True)
class RosplaneOrbitLaw(PathLaw):
    """ROSplane's course command for a circle in its centre's frame (M2), with its roll fed forward.

    Attributes
    ----------
    orbit_gain : k_orbit, how steeply the field turns with the distance from the circle in radii [-]
    course_gain_per_s : k_chi, heading rate per course error [1/s]
    """

    inputs: ClassVar[str] = "the circle in the frame of its centre (M2)"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_CIRCLES
    orbit_gain: float = 4.0
    course_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        course = course_of(motion.velocity)
        centre, radius, side = motion.circle
        command = orbit_course(motion.position, centre, radius, side, gain=self.orbit_gain)
        roll = orbit_roll(motion.airspeed, radius, side, course, motion.heading)
        feed_forward = _G * math.tan(roll) / motion.airspeed
        return self.course_gain_per_s * wrap(command - course) + feed_forward
