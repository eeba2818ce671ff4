"""Constant bearing: head for where the reference will be met, so that the line of sight keeps its
direction.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.steering_law import NO_CIRCLE, ON_CIRCLE, check_parameters, steering_law
from gnc.numeric import limited, wrap
from gnc.reference.reference import Reference
from gnc.vectors import Vector, course_of


def collision_course(to_target: Vector, target_course: float, speed_ratio: float) -> float:
    """Return the course on which the line of sight does not turn [rad]. A pure function.

    Parameters
    ----------
    to_target : from the vehicle to the point [m]
    target_course : of the point [rad]
    speed_ratio : the point's speed over the vehicle's [-]
    """
    sight = course_of(to_target)
    return sight + math.asin(limited(speed_ratio * math.sin(target_course - sight), 1.0))


@steering_law("constant_bearing")
@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantBearingLaw:
    """Constant bearing towards the reference itself (M3).

    Attributes
    ----------
    bearing_gain_per_s : heading rate per angle from the course to the course that meets the
        reference [1/s]
    """

    given: ClassVar[str] = "the reference's place and velocity (M3)"
    bearing_gain_per_s: float = 1.0
    cannot: ClassVar[dict[str, str]] = {ON_CIRCLE: NO_CIRCLE}

    def __post_init__(self) -> None:
        check_parameters(self)

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        ratio = reference.speed / max(speed, 1.0)
        return self.bearing_gain_per_s * wrap(
            collision_course((to_north, to_east), reference.course, ratio) - course
        )
