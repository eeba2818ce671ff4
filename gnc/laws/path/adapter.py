"""What puts a law for paths to a moving point: the path that the point stands for, in the frame in
which that path is at rest.

M1, tangent: the path is at rest over the ground; its point is the reference, anew at every step.
M2, the frame of a centre: the path moves with the centre, and to the law it is a flight in wind
less the centre's velocity. Both are one computation. M3, the point itself, needs no path: such a
law takes the reference as it is.
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from gnc.laws.steering_law import STILL_AIR, Surroundings, check_parameters
from gnc.reference.reference import Reference
from gnc.vectors import Vector, along, cross, norm, plus, right_of, scaled

SPEED_MIN = 0.1
"""Speed of the reference over the ground below which its path has no direction there [m/s]: that
through the air is taken.
"""


class PathMotion(NamedTuple):
    """The vehicle beside a path, in the frame in which the path is at rest. Positions are from the
    path's point.

    Attributes
    ----------
    position : of the vehicle from the path's point, north and east [m]
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
        """Return centre [m], radius [m] and side (+1 clockwise) of the circle that the path is, at
        its point.
        """
        return (
            scaled(right_of(self.tangent), 1.0 / self.curvature),
            1.0 / abs(self.curvature),
            1 if self.curvature > 0.0 else -1,
        )


def path_motion(
    reference: Reference,
    to_north: float,
    to_east: float,
    course: float,
    speed: float,
    surroundings: Surroundings,
) -> PathMotion:
    """Return the vehicle beside the path that the reference stands for; parameters are those of
    ``SteeringLaw``.

    The reference moves at V_r through the air. Its velocity over the frame is the path's tangent,
    and the rate at which that turns over its speed is the path's curvature.
    """
    air, frame = surroundings.air, (surroundings.path_north, surroundings.path_east)
    wind = air.wind_north - frame[0], air.wind_east - frame[1]
    heading = along(reference.course)
    moving = plus(wind, heading, reference.speed)
    fast = norm(moving)
    if fast < SPEED_MIN:
        moving, fast = scaled(heading, reference.speed), reference.speed
    turning = scaled(right_of(heading), reference.heading_rate * reference.speed)
    return PathMotion(
        position=(-to_north, -to_east),
        velocity=plus(wind, along(course), speed),
        wind=wind,
        tangent=scaled(moving, 1.0 / fast),
        curvature=cross(moving, turning) / fast**3,
        airspeed=speed,
        heading=course,
        frame=frame,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class PathLaw(ABC):
    """Base of a steering law for paths. Its parameters are finite and above 0.

    Attributes
    ----------
    cannot : tasks that the law cannot do, each with the reason
    """

    cannot: ClassVar[dict[str, str]] = {}

    def __post_init__(self) -> None:
        check_parameters(self)

    @abstractmethod
    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s], from a fresh state."""

    def begin(self, surroundings: Surroundings, time_step: float) -> Any:  # noqa: ARG002
        """Return the law of one flight, in these surroundings, called every ``time_step`` [s]."""
        return BegunLaw(self.rate, surroundings)

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate in still air [rad/s]; parameters are those of
        ``SteeringLaw``.
        """
        return self.rate(path_motion(reference, to_north, to_east, course, speed, STILL_AIR))


class BegunLaw:
    """The law of one flight, in its surroundings.

    Parameters
    ----------
    rate : heading rate [rad/s] from the motion beside the path
    surroundings : of the flight
    """

    __slots__ = ("_rate", "_surroundings")

    def __init__(self, rate: Any, surroundings: Surroundings) -> None:
        self._rate, self._surroundings = rate, surroundings

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        rate: float = self._rate(
            path_motion(reference, to_north, to_east, course, speed, self._surroundings)
        )
        return rate


def turn_rate(acceleration: float, airspeed: float) -> float:
    """Return the heading rate of a coordinated turn [rad/s] with a lateral acceleration [m/s2] at
    an airspeed [m/s].
    """
    return acceleration / airspeed if airspeed > 0.0 else math.copysign(0.0, acceleration)
