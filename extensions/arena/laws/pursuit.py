"""Pursuit of the reference itself, of a carrot on its path, and of the tangent of its path.

Pure pursuit, proportional navigation and constant bearing are textbook laws. Carrot chasing and
pure pursuit with line of sight (PLOS) are from P. B. Sujit, S. Saripalli, J. B. Sousa, "Unmanned
Aerial Vehicle Path Following", IEEE Control Systems Magazine 34(1), 2014; the symbols of their
gains are this project's. Line of sight with a look-ahead is the standard law of marine craft.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from extensions.arena.laws.path import PathLaw, PathMotion, turn_rate
from gnc.laws import ONLY_CIRCLES, ONLY_MOVING_POINTS, CheckedLaw
from gnc.numeric import limited, wrap
from gnc.reference.reference import Reference
from gnc.steering import Air, Motion
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, plus, scaled

_ORIGIN = (0.0, 0.0)
_SPEED_MIN = 1.0
"""Speed of the vehicle below which speed ratios are not formed [m/s]."""


def _to_reference(reference: Reference, own: Motion) -> Vector:
    return reference.north - own.north, reference.east - own.east


# ---------------------------------------------------------------- Pursuit of the reference itself


def pure_pursuit(to_target: Vector, course: float, speed: float, *, range_min: float) -> float:
    """Return omega = 2 V sin(angle)/distance [rad/s], the arc from the course to the target.

    Parameters
    ----------
    to_target : from the vehicle to the point [m]
    course, speed : of the vehicle [rad, m/s]; the angle off the course is kept within 90 degrees
    range_min : floor of the distance [m]
    """
    angle = limited(wrap(course_of(to_target) - course), 0.5 * math.pi)
    return 2.0 * speed * math.sin(angle) / max(norm(to_target), range_min)


def sight_rate(to_target: Vector, relative_velocity: Vector) -> float:
    """Return the rate of the line of sight [rad/s]; 0 on the target, where it is undefined.

    Parameters
    ----------
    to_target : from the vehicle to the point [m]
    relative_velocity : of the point less that of the vehicle [m/s]
    """
    squared = dot(to_target, to_target)
    return cross(to_target, relative_velocity) / squared if squared > 0.0 else 0.0


def collision_course(to_target: Vector, target_course: float, speed_ratio: float) -> float:
    """Return the course to the point at which the vehicle meets the target [rad].

    On this course the line of sight does not turn.

    Parameters
    ----------
    to_target : from the vehicle to the target [m]
    target_course : of the target [rad]
    speed_ratio : the target's speed over the vehicle's [-]
    """
    sight = course_of(to_target)
    return sight + math.asin(limited(speed_ratio * math.sin(target_course - sight), 1.0))


@dataclass(frozen=True, slots=True, kw_only=True)
class PurePursuitLaw(CheckedLaw):
    """Pure pursuit of the reference itself (M3).

    Attributes
    ----------
    range_min_m : floor of the distance, because the law is singular on the reference [m]
    """

    inputs: ClassVar[str] = "the reference's place (M3)"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS
    range_min_m: float = 30.0

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        to_target = _to_reference(reference, own)
        return pure_pursuit(to_target, own.course, own.speed, range_min=self.range_min_m)


@dataclass(frozen=True, slots=True, kw_only=True)
class ProportionalNavigationLaw(CheckedLaw):
    """Proportional navigation to the reference (M3); near the reference its demand has no bound.

    Attributes
    ----------
    navigation_constant : N, heading rate over the rate of the line of sight [-]
    """

    inputs: ClassVar[str] = "the reference's place and velocity (M3)"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS
    navigation_constant: float = 3.0

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        relative_velocity = minus(
            scaled(along(reference.course), reference.speed), scaled(along(own.course), own.speed)
        )
        to_target = _to_reference(reference, own)
        return self.navigation_constant * sight_rate(to_target, relative_velocity)


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantBearingLaw(CheckedLaw):
    """Constant bearing to the reference itself (M3).

    Attributes
    ----------
    bearing_gain_per_s : heading rate per angle from the course to the collision course [1/s]
    """

    inputs: ClassVar[str] = "the reference's place and velocity (M3)"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS
    bearing_gain_per_s: float = 1.0

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        ratio = reference.speed / max(own.speed, _SPEED_MIN)
        demanded = collision_course(_to_reference(reference, own), reference.course, ratio)
        return self.bearing_gain_per_s * wrap(demanded - own.course)


# ---------------------------------------------------------------- Pursuit of a carrot


def carrot_on_line(position: Vector, tangent: Vector, ahead: float) -> Vector:
    """Return the point of a line that is ``ahead`` [m] of the point nearest to the vehicle [m].

    Parameters
    ----------
    position : of the vehicle, from a point of the line as the result is [m]
    tangent : unit vector along the line
    ahead : distance along the line [m]
    """
    return plus(_ORIGIN, tangent, dot(position, tangent) + ahead)


def carrot_on_circle(
    position: Vector, centre: Vector, radius: float, side: int, ahead: float
) -> Vector:
    """Return the point of a circle at the angle ``ahead`` [rad] from the nearest point [m].

    Parameters
    ----------
    position : of the vehicle [m]
    centre, radius : of the circle [m]
    side : +1 clockwise, -1 anticlockwise
    ahead : angle about the centre [rad]
    """
    return plus(centre, along(course_of(minus(position, centre)) + side * ahead), radius)


def chase(position: Vector, velocity: Vector, target: Vector, gain: float) -> float:
    """Return the lateral acceleration a = gain V angle, positive to the right [m/s2].

    Parameters
    ----------
    position, velocity : of the vehicle [m, m/s]
    target : the carrot [m]
    gain : [1/s]
    """
    return gain * norm(velocity) * wrap(course_of(minus(target, position)) - course_of(velocity))


def plos(
    position: Vector,
    velocity: Vector,
    tangent: Vector,
    target: Vector,
    *,
    pursuit_gain: float,
    sight_gain: float,
) -> float:
    """Return the lateral acceleration a = k_1 V angle - k_2 V e, positive to the right [m/s2].

    Parameters
    ----------
    position, velocity : of the vehicle, from a point of the line [m, m/s]
    tangent : unit vector along the line
    target : the pursued end of the line, from that point [m]
    pursuit_gain, sight_gain : k_1 [1/s], k_2 [1/(m s)]
    """
    error = cross(tangent, position)
    return chase(position, velocity, target, pursuit_gain) - sight_gain * norm(velocity) * error


@dataclass(frozen=True, slots=True, kw_only=True)
class CarrotLaw(PathLaw):
    """Carrot chasing on the reference's tangent (M1).

    Attributes
    ----------
    carrot_ahead_m : distance of the carrot ahead of the nearest point of the tangent [m]
    carrot_gain_per_s : heading rate per angle from the course to the carrot [1/s]
    """

    inputs: ClassVar[str] = "tangent of the path over the ground (M1)"
    carrot_ahead_m: float = 40.0
    carrot_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        target = carrot_on_line(motion.position, motion.tangent, self.carrot_ahead_m)
        acceleration = chase(motion.position, motion.velocity, target, self.carrot_gain_per_s)
        return turn_rate(acceleration, motion.airspeed)


@dataclass(frozen=True, slots=True, kw_only=True)
class CarrotOrbitLaw(PathLaw):
    """Carrot chasing on a circle (M2).

    Attributes
    ----------
    carrot_angle_rad : angle of the carrot ahead of the vehicle, seen from the centre [rad]
    carrot_gain_per_s : heading rate per angle from the course to the carrot [1/s]
    """

    inputs: ClassVar[str] = "the circle in the frame of its centre (M2)"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_CIRCLES
    carrot_angle_rad: float = 0.2
    carrot_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        target = carrot_on_circle(motion.position, *motion.circle, self.carrot_angle_rad)
        acceleration = chase(motion.position, motion.velocity, target, self.carrot_gain_per_s)
        return turn_rate(acceleration, motion.airspeed)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlosLaw(PathLaw):
    """Pursuit of a point of the reference's tangent, and of the tangent itself (M1).

    Attributes
    ----------
    plos_ahead_m : distance of the pursued point ahead of the reference [m]
    plos_pursuit_per_s : k_1, heading rate per angle to the pursued point [1/s]
    plos_sight_per_m_s : k_2, heading rate per cross-track distance [1/(m s)]
    """

    inputs: ClassVar[str] = "tangent of the path over the ground (M1)"
    plos_ahead_m: float = 60.0
    plos_pursuit_per_s: float = 1.0
    plos_sight_per_m_s: float = 0.01

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        acceleration = plos(
            motion.position,
            motion.velocity,
            motion.tangent,
            plus(_ORIGIN, motion.tangent, self.plos_ahead_m),
            pursuit_gain=self.plos_pursuit_per_s,
            sight_gain=self.plos_sight_per_m_s,
        )
        return turn_rate(acceleration, motion.airspeed)


# ---------------------------------------------------------------- Line of sight with a look-ahead


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
    """Return omega [rad/s] to a point ``look_ahead`` along the tangent, with its turn fed forward.

    Parameters
    ----------
    position : of the vehicle from the path's point [m]
    course, speed : of the vehicle [rad, m/s]
    line_course, line_rate : course of the tangent and its rate [rad, rad/s]
    look_ahead : Delta [m]
    gain : k [1/s]
    """
    tangent = along(line_course)
    error = cross(tangent, position)
    ahead = dot(tangent, position)
    error_rate = speed * math.sin(course - line_course) - line_rate * ahead
    demanded = line_course - math.atan(error / look_ahead)
    feed_forward = line_rate - look_ahead * error_rate / (look_ahead * look_ahead + error * error)
    return feed_forward + gain * wrap(demanded - course)


@dataclass(frozen=True, slots=True, kw_only=True)
class LookAheadLineOfSightLaw(CheckedLaw):
    """Line-of-sight guidance of marine craft on the reference's tangent (M1).

    Attributes
    ----------
    sight_distance_m : look-ahead distance Delta along the tangent [m]
    sight_gain_per_s : k, heading rate per course error [1/s]
    """

    inputs: ClassVar[str] = "tangent of the path through the air (M1), and its turn rate"
    sight_distance_m: float = 30.0
    sight_gain_per_s: float = 1.0

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return look_ahead_line_of_sight(
            scaled(_to_reference(reference, own), -1.0),
            own.course,
            own.speed,
            reference.course,
            reference.heading_rate,
            look_ahead=self.sight_distance_m,
            gain=self.sight_gain_per_s,
        )
