"""Carrot chasing, and pure pursuit with line of sight, as Sujit, Saripalli and Sousa compare them.

Source: P. B. Sujit, S. Saripalli, J. B. Sousa, "Unmanned Aerial Vehicle Path Following", IEEE
Control Systems Magazine 34(1),
2014. The symbols for the gains are this project's.
"""

from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.path.adapter import PathLaw, PathMotion, turn_rate
from gnc.laws.steering_law import CIRCLES_ALONE, ON_OSCILLATION, steering_law
from gnc.numeric import wrap
from gnc.vectors import Vector, along, course_of, cross, dot, minus, norm, plus


def carrot_on_line(position: Vector, origin: Vector, tangent: Vector, ahead: float) -> Vector:
    """Return the point of a line that is ``ahead`` [m] of the vehicle's nearest [m]; vectors in m,
    the tangent a unit vector.
    """
    return plus(origin, tangent, dot(minus(position, origin), tangent) + ahead)


def carrot_on_circle(
    position: Vector, centre: Vector, radius: float, side: int, ahead: float
) -> Vector:
    """Return the point of a circle that is an angle ``ahead`` [rad] of the vehicle's nearest [m];
    side +1 is clockwise.
    """
    return plus(centre, along(course_of(minus(position, centre)) + side * ahead), radius)


def chase(position: Vector, velocity: Vector, target: Vector, gain: float) -> float:
    """Return a = gain V angle, positive to the right [m/s2], from position [m], velocity [m/s], the
    carrot [m], and gain [1/s].
    """
    return gain * norm(velocity) * wrap(course_of(minus(target, position)) - course_of(velocity))


def plos(
    position: Vector,
    velocity: Vector,
    origin: Vector,
    tangent: Vector,
    target: Vector,
    *,
    pursuit_gain: float,
    sight_gain: float,
) -> float:
    """Return a = k_1 V angle - k_2 V e, positive to the right [m/s2]. A pure function.

    Parameters
    ----------
    position, velocity : of the vehicle [m, m/s]
    origin, tangent : a point of the line [m], and its unit tangent
    target : the end of the line, which is pursued [m]
    pursuit_gain, sight_gain : k_1 [1/s], k_2 [1/(m s)]
    """
    error = cross(tangent, minus(position, origin))
    return chase(position, velocity, target, pursuit_gain) - sight_gain * norm(velocity) * error


@steering_law("carrot")
@dataclass(frozen=True, slots=True, kw_only=True)
class CarrotLaw(PathLaw):
    """Carrot chasing on the reference's tangent (M1).

    Attributes
    ----------
    carrot_ahead_m : distance of the carrot ahead of the nearest point of the tangent [m]
    carrot_gain_per_s : heading rate per angle between the course and the bearing of the carrot
        [1/s]
    """

    given: ClassVar[str] = "tangent of the path over the ground (M1)"
    carrot_ahead_m: float = 40.0
    carrot_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        target = carrot_on_line(motion.position, (0.0, 0.0), motion.tangent, self.carrot_ahead_m)
        return turn_rate(
            chase(motion.position, motion.velocity, target, self.carrot_gain_per_s), motion.airspeed
        )


@steering_law("carrot_orbit")
@dataclass(frozen=True, slots=True, kw_only=True)
class CarrotOrbitLaw(PathLaw):
    """Carrot chasing on a circle (M2).

    Attributes
    ----------
    carrot_angle_rad : angle of the carrot ahead of the vehicle's bearing from the centre [rad]
    carrot_gain_per_s : heading rate per angle between the course and the bearing of the carrot
        [1/s]
    """

    given: ClassVar[str] = "the circle in the frame of its centre (M2)"
    cannot: ClassVar[dict[str, str]] = {ON_OSCILLATION: CIRCLES_ALONE}
    carrot_angle_rad: float = 0.2
    carrot_gain_per_s: float = 1.0

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        target = carrot_on_circle(motion.position, *motion.circle, self.carrot_angle_rad)
        return turn_rate(
            chase(motion.position, motion.velocity, target, self.carrot_gain_per_s), motion.airspeed
        )


@steering_law("plos")
@dataclass(frozen=True, slots=True, kw_only=True)
class PlosLaw(PathLaw):
    """Pursuit of a point of the reference's tangent, with the distance from the tangent beside it
    (M1).

    Attributes
    ----------
    plos_ahead_m : distance of the pursued point ahead of the reference [m]
    plos_pursuit_per_s : gain k_1 of the pursuit, heading rate per angle to the pursued point [1/s]
    plos_sight_per_m_s : gain k_2 of the line of sight, heading rate per cross-track distance
        [1/(m s)]
    """

    given: ClassVar[str] = "tangent of the path over the ground (M1)"
    plos_ahead_m: float = 60.0
    plos_pursuit_per_s: float = 1.0
    plos_sight_per_m_s: float = 0.01

    def rate(self, motion: PathMotion) -> float:
        """Return the demanded heading rate [rad/s]."""
        acceleration = plos(
            motion.position,
            motion.velocity,
            (0.0, 0.0),
            motion.tangent,
            plus((0.0, 0.0), motion.tangent, self.plos_ahead_m),
            pursuit_gain=self.plos_pursuit_per_s,
            sight_gain=self.plos_sight_per_m_s,
        )
        return turn_rate(acceleration, motion.airspeed)
