"""Vector fields for lines and circles: a course for every place, and the law that turns the vehicle
to it.

Sources: D. R. Nelson, D. B. Barber, T. W. McLain, R. W. Beard, "Vector Field Path Following for
Miniature Air Vehicles", IEEE TRO 23(3), 2007; R. W. Beard, T. W. McLain, Small Unmanned Aircraft,
chapter 10.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from gnc.laws.path.adapter import PathLaw, PathMotion
from gnc.laws.path.lgvf import heading_for
from gnc.laws.steering_law import CIRCLES_ALONE, ON_OSCILLATION, check_parameters, steering_law
from gnc.numeric import limited, wrap
from gnc.reference.reference import Reference
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, scaled

_HALF_PI = 0.5 * math.pi


class Field(NamedTuple):
    """A field where the vehicle is.

    Attributes
    ----------
    course : chi_d [rad]
    rate : how fast it turns as the vehicle moves [rad/s]
    """

    course: float
    rate: float


def line_field(
    position: Vector,
    velocity: Vector,
    origin: Vector,
    line_course: float,
    *,
    gain: float,
    approach: float,
    line_rate: float = 0.0,
) -> Field:
    """Return the field of a line that may turn about ``origin``, and its rate along the vehicle's
    way.

    Parameters
    ----------
    position, velocity : of the vehicle [m, m/s]
    origin, line_course : a point of the line [m], and its course [rad]
    gain : k [1/m]
    approach : chi_inf [rad]
    line_rate : of the line's course [rad/s]
    """
    tangent, off = along(line_course), minus(position, origin)
    error = cross(tangent, off)
    error_rate = cross(tangent, velocity) - line_rate * dot(tangent, off)
    slope = approach / _HALF_PI
    return Field(
        course=line_course - slope * math.atan(gain * error),
        rate=line_rate - slope * gain * error_rate / (1.0 + (gain * error) ** 2),
    )


def orbit_field(
    position: Vector, velocity: Vector, centre: Vector, radius: float, side: int, *, gain: float
) -> Field:
    """Return the field of a circle, the course of the velocity relative to its centre, and its rate
    along the vehicle's way.

    Parameters
    ----------
    position : of the vehicle [m]
    velocity : of the vehicle relative to the centre [m/s]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    gain : k [1/m]
    """
    from_centre = minus(position, centre)
    d, bearing = norm(from_centre), course_of(from_centre)
    outward = along(bearing)
    turn = cross(outward, velocity) / d if d > 0.0 else 0.0
    off = gain * (d - radius)
    return Field(
        course=bearing + side * (_HALF_PI + math.atan(off)),
        rate=turn + side * gain * dot(outward, velocity) / (1.0 + off * off),
    )


def field_heading_rate(field: Field, course: float, *, kappa: float, width: float) -> float:
    """Return the heading rate that turns the vehicle into a field, u of the paper [rad/s].

    Parameters
    ----------
    field : where the vehicle is
    course : of the vehicle [rad]
    kappa : largest heading rate that the course error adds [rad/s]
    width : eps, course error from which on it adds that [rad]
    """
    return field.rate - kappa * limited(wrap(course - field.course) / width, 1.0)


@steering_law("vector_field")
@dataclass(frozen=True, slots=True, kw_only=True)
class VectorFieldLaw:
    """The paper's law on the reference's tangent, which turns with the reference (M1).

    Attributes
    ----------
    field_gain_per_m : gain k, how steeply the field turns with the distance from the path [1/m]
    field_approach_rad : chi_inf, course towards the tangent from far away [rad]
    field_rate_rad_s : kappa, largest heading rate that the course error adds [rad/s]
    field_width_rad : eps, course error from which on it adds that [rad]
    """

    given: ClassVar[str] = "tangent of the path through the air (M1), and its turn rate"
    field_gain_per_m: float = 0.05
    field_approach_rad: float = _HALF_PI
    field_rate_rad_s: float = _HALF_PI
    field_width_rad: float = 1.0

    def __post_init__(self) -> None:
        check_parameters(self)

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        field = line_field(
            (-to_north, -to_east),
            scaled(along(course), speed),
            (0.0, 0.0),
            reference.course,
            gain=self.field_gain_per_m,
            approach=self.field_approach_rad,
            line_rate=reference.heading_rate,
        )
        return field_heading_rate(
            field, course, kappa=self.field_rate_rad_s, width=self.field_width_rad
        )


@steering_law("vector_field_orbit")
@dataclass(frozen=True, slots=True, kw_only=True)
class OrbitFieldLaw(PathLaw):
    """The paper's law on a circle in the frame of its centre (M2): its field is a course relative
    to the centre.

    Attributes
    ----------
    field_gain_per_m : gain k, how steeply the field turns with the distance from the path [1/m]
    field_rate_rad_s, field_width_rad : kappa and eps, as of ``VectorFieldLaw``
    """

    given: ClassVar[str] = "the circle in the frame of its centre (M2); wind"
    cannot: ClassVar[dict[str, str]] = {ON_OSCILLATION: CIRCLES_ALONE}
    field_gain_per_m: float = 0.05
    field_rate_rad_s: float = _HALF_PI
    field_width_rad: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]; a centre that is as fast as the vehicle is
        followed, not circled.
        """
        drift = scaled(motion.wind, -1.0)
        field = Field(course_of(drift), 0.0)
        if norm(drift) < motion.airspeed:
            relative = orbit_field(
                motion.position, motion.velocity, *motion.circle, gain=self.field_gain_per_m
            )
            field = Field(*heading_for(relative.course, relative.rate, motion.airspeed, drift))
        return field_heading_rate(
            field, motion.heading, kappa=self.field_rate_rad_s, width=self.field_width_rad
        )
