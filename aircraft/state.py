"""State, kinematics and position of the rigid body, in SI and radians."""

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
    roll, pitch, yaw : 3-2-1 Euler angles of the body frame relative to north-east-down [rad]
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
    """Velocity forward, right and down [m/s] from airspeed [m/s], alpha and beta [rad]."""
    return (
        airspeed * math.cos(alpha) * math.cos(beta),
        airspeed * math.sin(beta),
        airspeed * math.sin(alpha) * math.cos(beta),
    )


def level(vector: Vector, roll: float, pitch: float) -> Vector:
    """A body vector in the level frame with the body's yaw: ahead, right, down."""
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
    """State relative to the ground, from the state in the air and the wind north and east [m/s]."""
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
    acceleration_body : acceleration relative to the earth [m/s^2]; the specific force may stand for
        it, because the two differ only in the vertical
    roll, pitch : Euler angles [rad]

    Notes
    -----
    The course is the direction of the motion itself, not psi + beta, which is often used instead.
    At 45 degrees of bank and an angle of attack of 0.08 rad the two angles differ by 0.06 rad, so
    their rates differ while the bank changes.
    """
    v_ahead, v_right, _ = level(velocity_body, roll, pitch)
    a_ahead, a_right, _ = level(acceleration_body, roll, pitch)
    return (v_ahead * a_right - v_right * a_ahead) / (v_ahead * v_ahead + v_right * v_right)


def euler_rates(rates_body: Vector, roll: float, pitch: float) -> Vector:
    """Rates of the roll, pitch and yaw angles [rad/s] from the body rates p, q, r [rad/s]."""
    p, q, r = rates_body
    yaw_rate = (q * math.sin(roll) + r * math.cos(roll)) / math.cos(pitch)
    return p + yaw_rate * math.sin(pitch), q * math.cos(roll) - r * math.sin(roll), yaw_rate


def turn_rates(yaw_rate: float, roll: float, pitch: float) -> Vector:
    """Body rates p, q, r [rad/s] of a turn at ``yaw_rate`` [rad/s] with constant roll and pitch."""
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
"""Coefficients of the third-order terms of ``EquatorFrame`` [1/rad^2]."""


class EquatorFrame:
    """Frame with north and east in metres from latitude and longitude 0, at a fixed altitude.

    All flights take place there: at the equator local north is true north, and JSBSim's axes are
    far from the poles. The real position of a scenario (``common.geodesy.LocalFrame``) does not
    influence a flight.

    The mapping is azimuthal equidistant, to third order. Let s = M phi (1 + e^2 phi^2/2) be the
    length along the meridian, u = a lambda the length along the equator, and K = 1/(a M) the
    curvature. Then north is s (1 + K u^2/6) and east is u (1 - K s^2/3). Within 20 km this agrees
    with ``LocalFrame`` to 0.1 mm.

    Parameters
    ----------
    altitude : altitude above the ellipsoid [m]

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
        """Latitude and longitude [rad] of a local position [m]."""
        latitude, longitude = north / self.north_scale, east / self.east_scale
        for _ in range(3):
            # Each iteration multiplies the error by the square of the angle, 1e-5 at 20 km.
            off_north, off_east = self.to_local(latitude, longitude)
            latitude += (north - off_north) / self.north_scale
            longitude += (east - off_east) / self.east_scale
        return latitude, longitude
