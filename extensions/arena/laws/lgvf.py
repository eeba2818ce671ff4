"""The Lyapunov guidance vector field: a standoff circle about a moving centre, in wind.

Sources: D. A. Lawrence, E. W. Frew, W. J. Pisano, "Lyapunov Vector Fields for Autonomous Unmanned
Aircraft Flight Control", JGCD 31(5), 2008; E. W. Frew, D. A. Lawrence, S. Morris, "Coordinated
Standoff Tracking of Moving Targets Using Lyapunov Guidance Vector Fields", JGCD 31(2), 2008. Wind
and the feedback of the heading are additions of this project.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from extensions.arena.laws.path import PathLaw, PathMotion
from gnc.laws import ONLY_CIRCLES
from gnc.numeric import wrap
from gnc.steering import DesiredCourse, heading_for
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, scaled


def circle_course(from_centre: Vector, radius: float, side: int) -> float:
    """Return the field's course relative to the centre, bearing + 2 side atan(r/R) [rad].

    Parameters
    ----------
    from_centre : from the centre to the vehicle [m]
    radius : R [m]
    side : +1 clockwise, -1 anticlockwise
    """
    return course_of(from_centre) + 2.0 * side * math.atan(norm(from_centre) / radius)


def lgvf(
    position: Vector,
    heading: float,
    airspeed: float,
    centre: Vector,
    radius: float,
    side: int,
    centre_velocity: Vector,
    wind: Vector,
) -> DesiredCourse:
    """Return the heading of the field, and its rate.

    Parameters
    ----------
    position, heading : of the vehicle [m, rad]
    airspeed : V_a [m/s]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    centre_velocity, wind : over the ground [m/s]

    Raises
    ------
    InfeasibleError : the centre is as fast through the air as the vehicle
    """
    from_centre = minus(position, centre)
    drift = minus(centre_velocity, wind)
    course = circle_course(from_centre, radius, side)
    relative = minus(scaled(along(heading), airspeed), drift)
    r = norm(from_centre)
    outward = along(course_of(from_centre))
    turn = cross(outward, relative) / r if r > 0.0 else 0.0
    course_rate = turn + 2.0 * side * radius * dot(outward, relative) / (radius * radius + r * r)
    return heading_for(course, course_rate, airspeed, drift)


def heading_rate(field: DesiredCourse, heading: float, gain: float) -> float:
    """Return the heading rate that turns a vehicle into the field [rad/s]; gain [1/s]."""
    return field.rate + gain * wrap(field.course - heading)


@dataclass(frozen=True, slots=True, kw_only=True)
class LgvfLaw(PathLaw):
    """The Lyapunov guidance vector field on a circle in the frame of its centre (M2).

    Attributes
    ----------
    lgvf_gain_per_s : feedback gain k, heading rate per course error [1/s]
    """

    inputs: ClassVar[str] = "the circle in the frame of its centre (M2); wind"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_CIRCLES
    lgvf_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s].

        A centre that is as fast as the vehicle is followed, not circled.
        """
        if norm(motion.wind) >= motion.airspeed:
            field = DesiredCourse(course_of(motion.wind) + math.pi, 0.0)
        else:
            field = lgvf(
                motion.position,
                motion.heading,
                motion.airspeed,
                *motion.circle,
                centre_velocity=(0.0, 0.0),
                wind=motion.wind,
            )
        return heading_rate(field, motion.heading, self.lgvf_gain_per_s)
