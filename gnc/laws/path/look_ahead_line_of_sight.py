"""Line-of-sight guidance of marine craft: a course towards the path's tangent, with the reference's
turn fed forward.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.steering_law import check_parameters, steering_law
from gnc.numeric import wrap
from gnc.reference.reference import Reference
from gnc.vectors import Vector, along, cross, dot


def look_ahead_line_of_sight(
    position: Vector,
    course: float,
    speed: float,
    line_course: float,
    line_rate: float,
    *,
    look_ahead: float,
    gain: float,
) -> float:
    """Return omega [rad/s]. A pure function.

    Parameters
    ----------
    position : of the vehicle from the path's point [m]
    course, speed : of the vehicle [rad, m/s]
    line_course, line_rate : course of the tangent and its rate [rad, rad/s]
    look_ahead : Delta [m]
    gain : k [1/s]
    """
    tangent = along(line_course)
    error, ahead = cross(tangent, position), dot(tangent, position)
    error_rate = speed * math.sin(course - line_course) - line_rate * ahead
    demanded = line_course - math.atan(error / look_ahead)
    feed_forward = line_rate - look_ahead * error_rate / (look_ahead * look_ahead + error * error)
    return feed_forward + gain * wrap(demanded - course)


@steering_law("look_ahead_line_of_sight")
@dataclass(frozen=True, slots=True, kw_only=True)
class LookAheadLineOfSightLaw:
    """Line-of-sight guidance on the reference's tangent (M1).

    Attributes
    ----------
    sight_distance_m : look-ahead distance Delta along the tangent [m]
    sight_gain_per_s : gain k, heading rate per course error [1/s]
    """

    given: ClassVar[str] = "tangent of the path through the air (M1), and its turn rate"
    sight_distance_m: float = 30.0
    sight_gain_per_s: float = 1.0

    def __post_init__(self) -> None:
        check_parameters(self)

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return look_ahead_line_of_sight(
            (-to_north, -to_east),
            course,
            speed,
            reference.course,
            reference.heading_rate,
            look_ahead=self.sight_distance_m,
            gain=self.sight_gain_per_s,
        )
