"""How a law for paths is applied to a moving reference, which is a point and not a path.

There are three ways, and a law's ``inputs`` say which one it uses:

M1, tangent. The path is the tangent of the reference's track over the ground. It changes at every
step.
M2, the frame of the centre. The path is a circle that moves with its centre. The law computes in
the frame of the centre, where the wind is the true wind minus the velocity of the centre.
M3, the point. The law steers at the reference and needs no path.

M1 and M2 are the same computation in two frames: one is at rest over the ground, the other moves
with the centre.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

from gnc.laws import CheckedLaw
from gnc.reference.reference import Reference
from gnc.steering import Air, Motion
from gnc.vectors import Vector, along, cross, norm, plus, right_of, scaled

_SPEED_MIN = 0.1
"""Speed of the reference below which its velocity in the path's frame has no direction [m/s]."""


class PathMotion(NamedTuple):
    """The vehicle beside a path, in the frame in which the path is at rest.

    Attributes
    ----------
    position : of the vehicle from the path's point [m]
    velocity, wind : of the vehicle and of the air [m/s]
    tangent : of the path at its point, a unit vector
    curvature : of the path there, positive to the right [1/m]
    airspeed, heading : of the vehicle [m/s, rad]
    frame : velocity of the frame over the ground [m/s]
    """

    position: Vector
    velocity: Vector
    wind: Vector
    tangent: Vector
    curvature: float
    airspeed: float
    heading: float
    frame: Vector

    @property
    def circle(self) -> tuple[Vector, float, int]:
        """Centre [m], radius [m] and side (+1 clockwise) of the circle of the path's curvature."""
        return (
            scaled(right_of(self.tangent), 1.0 / self.curvature),
            1.0 / abs(self.curvature),
            1 if self.curvature > 0.0 else -1,
        )


def path_motion(reference: Reference, own: Motion, air: Air) -> PathMotion:
    """Return the vehicle beside the path of the reference.

    The reference moves at V_r through the air. Its velocity in the path's frame has the direction
    of the tangent. The curvature is the turn rate of that velocity over its magnitude. If the
    reference is at rest in that frame, its velocity through the air is used instead. Parameters are
    those of ``SteeringLaw``.
    """
    to_reference = reference.north - own.north, reference.east - own.east
    frame = air.path_north, air.path_east
    wind = air.wind_north - air.path_north, air.wind_east - air.path_east
    heading = along(reference.course)
    velocity = plus(wind, heading, reference.speed)
    speed = norm(velocity)
    if speed < _SPEED_MIN:
        velocity = scaled(heading, reference.speed)
        speed = reference.speed
    acceleration = scaled(right_of(heading), reference.heading_rate * reference.speed)
    return PathMotion(
        position=scaled(to_reference, -1.0),
        velocity=plus(wind, along(own.course), own.speed),
        wind=wind,
        tangent=scaled(velocity, 1.0 / speed),
        curvature=cross(velocity, acceleration) / speed**3,
        airspeed=own.speed,
        heading=own.course,
        frame=frame,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLaw(CheckedLaw, ABC):
    """Base of a steering law for paths."""

    unsupported_tasks: ClassVar[dict[str, str]] = {}

    @abstractmethod
    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""

    def heading_rate(self, reference: Reference, own: Motion, air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return self.rate(path_motion(reference, own, air))


def turn_rate(acceleration: float, airspeed: float) -> float:
    """Return the heading rate [rad/s] of a lateral acceleration [m/s2] at an airspeed [m/s]."""
    return acceleration / airspeed if airspeed > 0.0 else math.copysign(0.0, acceleration)
