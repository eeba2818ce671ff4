"""Geometric pure pursuit: the arc that leads from the vehicle's course to the reference point."""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.steering_law import NO_CIRCLE, ON_CIRCLE, check_parameters, steering_law
from gnc.numeric import limited, wrap
from gnc.reference.reference import Reference
from gnc.vectors import Vector, course_of, norm


def pure_pursuit(to_target: Vector, course: float, speed: float, *, range_min: float) -> float:
    """Return omega = 2 V sin(angle)/distance [rad/s], with the angle kept within a quarter of a
    turn. A pure function.

    Parameters
    ----------
    to_target : from the vehicle to the point [m]
    course, speed : of the vehicle [rad, m/s]
    range_min : floor of the distance [m]
    """
    angle = limited(wrap(course_of(to_target) - course), 0.5 * math.pi)
    return 2.0 * speed * math.sin(angle) / max(norm(to_target), range_min)


@steering_law("pure_pursuit")
@dataclass(frozen=True, slots=True, kw_only=True)
class PurePursuitLaw:
    """Pure pursuit of the reference itself (M3).

    Attributes
    ----------
    range_min_m : least distance that the law reckons with: it is singular on the reference [m]
    """

    given: ClassVar[str] = "the reference's place (M3)"
    range_min_m: float = 30.0
    cannot: ClassVar[dict[str, str]] = {ON_CIRCLE: NO_CIRCLE}

    def __post_init__(self) -> None:
        check_parameters(self)

    def heading_rate(
        self,
        reference: Reference,  # noqa: ARG002
        to_north: float,
        to_east: float,
        course: float,
        speed: float,
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return pure_pursuit((to_north, to_east), course, speed, range_min=self.range_min_m)
