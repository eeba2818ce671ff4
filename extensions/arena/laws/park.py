"""The law of Park, Deyst and How: steer at the point of the path that is L1 ahead.

Source: S. Park, J. Deyst, J. P. How, "A New Nonlinear Guidance Logic for Trajectory Tracking", AIAA
2004-4900; "Performance and Lyapunov Stability of a Nonlinear Path-Following Guidance Method", JGCD
30(6), 2007.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from extensions.arena.laws.path import PathLaw, PathMotion, turn_rate
from gnc.laws import ONLY_CIRCLES, ONLY_MOVING_POINTS
from gnc.numeric import clip, wrap
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, plus, scaled


def park_l1(position: Vector, velocity: Vector, target: Vector, *, range_min: float = 0.0) -> float:
    """Return the lateral acceleration, 2 v^2 sin(eta)/L1, positive to the right [m/s2].

    Unlike the law of Park, Deyst and How it limits eta to 90 degrees: their command decreases again
    for a target behind the vehicle.

    Parameters
    ----------
    position, velocity : of the vehicle, north and east [m, m/s]
    target : the point to steer at [m]; the range to it is L1
    range_min : floor of the range [m]
    """
    to_target = minus(target, position)
    range_ = max(norm(to_target), range_min)
    if range_ == 0.0:
        return 0.0
    eta = clip(wrap(course_of(to_target) - course_of(velocity)), -0.5 * math.pi, 0.5 * math.pi)
    return 2.0 * dot(velocity, velocity) * math.sin(eta) / range_


def point_on_line(position: Vector, course: float, distance: float) -> Vector:
    """Return the point of a line ahead of the vehicle and at ``distance`` from it [m].

    If the whole line is farther away, this is its nearest point.

    Parameters
    ----------
    position : of the vehicle, from a point of the line as the result is [m]
    course : of the line [rad]
    distance : L1 [m]
    """
    tangent = along(course)
    error = cross(tangent, position)
    ahead = math.sqrt(max(distance * distance - error * error, 0.0))
    return plus((0.0, 0.0), tangent, dot(tangent, position) + ahead)


def point_on_circle(
    position: Vector, centre: Vector, radius: float, side: int, distance: float
) -> Vector:
    """Return the point of a circle ahead of the vehicle and at ``distance`` from it [m].

    If no point of the circle has that distance, this is its nearest point.

    Parameters
    ----------
    position : of the vehicle [m]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    distance : L1 [m]
    """
    from_centre = minus(position, centre)
    d = norm(from_centre)
    ahead = 0.0
    if d > 0.0 and abs(d - radius) <= distance <= d + radius:
        ahead = math.acos(
            clip((d * d + radius * radius - distance * distance) / (2.0 * d * radius), -1.0, 1.0)
        )
    return plus(centre, along(course_of(from_centre) + side * ahead), radius)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParkL1Law(PathLaw):
    """Base of the laws of Park, Deyst and How; they differ in the point to steer at.

    Attributes
    ----------
    l1_distance_m : look-ahead distance L1 [m]
    """

    l1_distance_m: float = 60.0

    def target(self, motion: PathMotion) -> Vector:
        """Return the point to steer at, from the path's point [m]."""
        raise NotImplementedError

    def range_min(self) -> float:
        """Return the floor of the range [m]."""
        return 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        acceleration = park_l1(
            motion.position, motion.velocity, self.target(motion), range_min=self.range_min()
        )
        return turn_rate(acceleration, motion.airspeed)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParkL1TangentLaw(ParkL1Law):
    """Park's law on the reference's tangent (M1); attributes are those of ``ParkL1Law``."""

    inputs: ClassVar[str] = "tangent of the path over the ground (M1); velocity over the ground"

    def target(self, motion: PathMotion) -> Vector:
        """Return the point of the tangent at L1 from the vehicle, from the path's point [m]."""
        return point_on_line(motion.position, course_of(motion.tangent), self.l1_distance_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParkL1AheadLaw(ParkL1Law):
    """Park's law to the point L1 ahead of the reference, on its tangent (M3).

    Attributes are those of ``ParkL1Law``.
    """

    inputs: ClassVar[str] = "a point ahead of the reference (M3); velocity over the ground"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS

    def target(self, motion: PathMotion) -> Vector:
        """Return the point L1 ahead, from the path's point [m]."""
        return scaled(motion.tangent, self.l1_distance_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class ParkL1PointLaw(ParkL1Law):
    """Park's law to the reference itself (M3), with L1 as the floor of the range.

    Attributes are those of ``ParkL1Law``.
    """

    inputs: ClassVar[str] = "the reference's place (M3); velocity over the ground"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS
    l1_distance_m: float = 30.0

    def target(self, motion: PathMotion) -> Vector:  # noqa: ARG002
        """Return the path's point."""
        return 0.0, 0.0

    def range_min(self) -> float:
        """Return the floor of the range [m]."""
        return self.l1_distance_m


@dataclass(frozen=True, slots=True, kw_only=True)
class ParkL1OrbitLaw(ParkL1Law):
    """Park's law on a circle in the frame of its centre (M2); attributes of ``ParkL1Law``."""

    inputs: ClassVar[str] = "the circle in the frame of its centre (M2)"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_CIRCLES

    def target(self, motion: PathMotion) -> Vector:
        """Return the point of the circle at L1 from the vehicle, from the path's point [m]."""
        return point_on_circle(motion.position, *motion.circle, self.l1_distance_m)
