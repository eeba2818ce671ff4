"""The rigid body's state, its kinematics and its place on the globe, in SI and radians."""

import math
from dataclasses import dataclass, replace

from common.geodesy import ECCENTRICITY_SQUARED, EQUATORIAL_RADIUS

Vector = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidBodyState:
    """Position, attitude and motion of an aircraft, relative to still air unless stated otherwise.

    Attributes
    ----------
    latitude, longitude : geodetic [rad]
    altitude : above mean sea level [m]
    roll, pitch, yaw : 3-2-1 Euler angles of the body frame against north-east-down [rad]
    velocity_body : forward, right, down [m/s]
    rates_body : roll, pitch and yaw rate p, q, r [rad/s]
    """

    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float
    roll: float
    pitch: float
    yaw: float = 0.0
    velocity_body: Vector
    rates_body: Vector = (0.0, 0.0, 0.0)


def body_velocity(airspeed: float, alpha: float, beta: float) -> Vector:
    """Forward, right and down velocity [m/s] for airspeed [m/s] and angles of attack, sideslip."""
    return (
        airspeed * math.cos(alpha) * math.cos(beta),
        airspeed * math.sin(beta),
        airspeed * math.sin(alpha) * math.cos(beta),
    )


def level(vector: Vector, roll: float, pitch: float) -> Vector:
    """A body vector in the level frame that shares the body's yaw: ahead, right, down."""
    x, y, z = vector
    sin_roll, cos_roll = math.sin(roll), math.cos(roll)
    sin_pitch, cos_pitch = math.sin(pitch), math.cos(pitch)
    down_after_roll = y * sin_roll + z * cos_roll
    return (
        x * cos_pitch + down_after_roll * sin_pitch,
        y * cos_roll - z * sin_roll,
        -x * sin_pitch + down_after_roll * cos_pitch,
    )


def with_wind(state: RigidBodyState, wind: tuple[float, float]) -> RigidBodyState:
    """State over the ground of a state against the air, whose velocity is north and east [m/s]."""
    north, east = wind
    sin_roll, cos_roll = math.sin(state.roll), math.cos(state.roll)
    sin_pitch, cos_pitch = math.sin(state.pitch), math.cos(state.pitch)
    ahead = north * math.cos(state.yaw) + east * math.sin(state.yaw)
    right = east * math.cos(state.yaw) - north * math.sin(state.yaw)
    u, v, w = state.velocity_body
    return replace(
        state,
        velocity_body=(
            u + ahead * cos_pitch,
            v + ahead * sin_roll * sin_pitch + right * cos_roll,
            w + ahead * cos_roll * sin_pitch - right * sin_roll,
        ),
    )


def course_rate(
    velocity_body: Vector, acceleration_body: Vector, roll: float, pitch: float
) -> float:
    """Rate of the horizontal course [rad/s].

    Parameters
    ----------
    velocity_body : velocity [m/s]
    acceleration_body : acceleration against the earth, or specific force, which differs from it
        downwards only [m/s^2]
    roll, pitch : Euler angles [rad]

    Notes
    -----
    This is the rate of the direction of motion itself. psi + beta is often used in its place; at 45
    degrees of bank and an angle of attack of 0.08 rad the two differ by 0.06 rad, and so do their
    rates while the bank changes.
    """
    v_ahead, v_right, _ = level(velocity_body, roll, pitch)
    a_ahead, a_right, _ = level(acceleration_body, roll, pitch)
    return (v_ahead * a_right - v_right * a_ahead) / (v_ahead * v_ahead + v_right * v_right)


def euler_rates(rates_body: Vector, roll: float, pitch: float) -> Vector:
    """Rates of roll, pitch and yaw angle [rad/s] for body rates p, q, r [rad/s]."""
    p, q, r = rates_body
    yaw_rate = (q * math.sin(roll) + r * math.cos(roll)) / math.cos(pitch)
    return p + yaw_rate * math.sin(pitch), q * math.cos(roll) - r * math.sin(roll), yaw_rate


def turn_rates(yaw_rate: float, roll: float, pitch: float) -> Vector:
    """Body rates p, q, r [rad/s] of a turn at ``yaw_rate`` [rad/s], roll and pitch constant."""
    return (
        -yaw_rate * math.sin(pitch),
        yaw_rate * math.cos(pitch) * math.sin(roll),
        yaw_rate * math.cos(pitch) * math.cos(roll),
    )


_MERIDIAN_RADIUS = EQUATORIAL_RADIUS * (1.0 - ECCENTRICITY_SQUARED)
"""Radius of curvature of a meridian at the equator [m]."""

_NORTH_BY_LATITUDE = 0.5 * ECCENTRICITY_SQUARED
_NORTH_BY_LONGITUDE = 1.0 / (6.0 * (1.0 - ECCENTRICITY_SQUARED))
_EAST_BY_LATITUDE = (1.0 - ECCENTRICITY_SQUARED) / 3.0
"""Relative change of a degree's length per squared angle from the origin [1/rad^2]."""


class EquatorFrame:
    """North and east metres about latitude and longitude 0, at a fixed altitude.

    All flights fly there: at the equator local north stays true north, and JSBSim's axes have no
    pole. Where on earth a flight is meant to be (``common.physics.LocalFrame``) does not
    change how it flies.

    The mapping is azimuthal equidistant, to third order. With s = M phi (1 + e^2 phi^2/2) the
    length of the meridian, u = a lambda that of the equator, and K = 1/(a M) the curvature there,
    north is s (1 + K u^2/6) and east u (1 - K s^2/3). That is ``LocalFrame`` at the origin, to
    0.1 mm within 20 km.

    Parameters
    ----------
    altitude : [m]

    Attributes
    ----------
    north_scale, east_scale : metres per radian of latitude and of longitude at the origin
    """

    def __init__(self, altitude: float = 0.0) -> None:
        self.north_scale = _MERIDIAN_RADIUS + altitude
        self.east_scale = EQUATORIAL_RADIUS + altitude

    def to_local(self, latitude: float, longitude: float) -> tuple[float, float]:
        """North and east [m] of a latitude and longitude [rad]."""
        squared = latitude * latitude
        return (
            self.north_scale
            * latitude
            * (1.0 + _NORTH_BY_LATITUDE * squared + _NORTH_BY_LONGITUDE * longitude * longitude),
            self.east_scale * longitude * (1.0 - _EAST_BY_LATITUDE * squared),
        )

    def to_geodetic(self, north: float, east: float) -> tuple[float, float]:
        """Latitude and longitude [rad] of a local place [m]."""
        latitude, longitude = north / self.north_scale, east / self.east_scale
        for _ in range(3):
            # Each time the error shrinks by the square of the angle, 1e-5 at 20 km.
            off_north, off_east = self.to_local(latitude, longitude)
            latitude += (north - off_north) / self.north_scale
            longitude += (east - off_east) / self.east_scale
        return latitude, longitude
