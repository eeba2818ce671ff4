"""Fields of MAVLink messages from quantities in SI, and back: the only place with units, signs and
frames.

Source: the message definitions of the dialect ``ardupilotmega`` (https://mavlink.io/en/messages).
Velocities are north, east, down; angles of places in 1e-7 deg, courses in 0.01 deg, heights in mm.
"""

import math
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from scenarios.world.ais.size import ShipSize, ship_size

_AIS_FLAGS = mavlink.AIS_FLAGS_POSITION_ACCURACY | mavlink.AIS_FLAGS_VALID_VELOCITY
_MORE_THAN_SAID = (
    mavlink.AIS_FLAGS_LARGE_BOW_DIMENSION
    | mavlink.AIS_FLAGS_LARGE_STERN_DIMENSION
    | mavlink.AIS_FLAGS_LARGE_PORT_DIMENSION
    | mavlink.AIS_FLAGS_LARGE_STARBOARD_DIMENSION
)
"""Flags of dimensions that are too large for their field."""

_AT_REST = 0.05
"""Speed below which a vessel has no course over the ground [m/s]."""

_UNKNOWN_16 = 0xFFFF

_CIRCLE = 36_000
"""[0.01 deg]"""

_ISA_LAPSE = 2.25577e-5
_ISA_EXPONENT = 4.25588
"""Density of the ICAO standard atmosphere below 11 km over that at sea level: (1 - a h)^b [1/m, -].
"""

_ROLL_ALONE = (
    mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_PITCH_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_YAW_RATE_IGNORE
    | mavlink.ATTITUDE_TARGET_TYPEMASK_THROTTLE_IGNORE
)
"""A SET_ATTITUDE_TARGET of roll alone. ArduPlane takes the roll of the quaternion where the bit of
the body's roll rate is not set, and takes pitch and yaw, too, where that of the attitude is not."""


def equivalent_over_true(altitude: float) -> float:
    """Return equivalent over true airspeed [-] at an altitude above the sea [m].

    Autopilots measure and command equivalent airspeed; the guidance knows true airspeed.
    """
    return math.sqrt((1.0 - _ISA_LAPSE * altitude) ** _ISA_EXPONENT)


def degrees_e7(angle: float) -> int:
    """Return a latitude or longitude [rad] in 1e-7 deg."""
    return round(1e7 * math.degrees(angle))


def from_degrees_e7(value: int) -> float:
    """Return a latitude or longitude in 1e-7 deg in rad."""
    return math.radians(1e-7 * value)


def centidegrees(angle: float) -> int:
    """Return a course or heading [rad] in 0.01 deg from 0 to 35999."""
    return round(100.0 * math.degrees(angle)) % 36000


def _signed_16(value: float) -> int:
    return max(-32768, min(32767, round(value)))


@dataclass(frozen=True, slots=True, kw_only=True)
class AircraftState:
    """Motion of an aircraft.

    Attributes
    ----------
    time : since the vehicle began [s]
    latitude, longitude : [rad]
    altitude, height : above the sea, and above home [m]
    velocity_north, velocity_east, climb : over the ground, by true north [m/s]
    roll, pitch, yaw : of the body; yaw from true north [rad]
    rates : p, q, r about the body's axes [rad/s]
    airspeed : equivalent [m/s]
    throttle : [-]
    """

    time: float
    latitude: float
    longitude: float
    altitude: float
    height: float
    velocity_north: float
    velocity_east: float
    climb: float
    roll: float
    pitch: float
    yaw: float
    rates: tuple[float, float, float]
    airspeed: float
    throttle: float

    @property
    def _milliseconds(self) -> int:
        return round(1e3 * self.time)

    @property
    def _ground_speed(self) -> float:
        return math.hypot(self.velocity_north, self.velocity_east)

    def attitude(self) -> Any:
        """Return ATTITUDE."""
        yaw = math.remainder(self.yaw, math.tau)
        return mavlink.MAVLink_attitude_message(
            self._milliseconds, self.roll, self.pitch, yaw, *self.rates
        )

    def global_position(self) -> Any:
        """Return GLOBAL_POSITION_INT."""
        return mavlink.MAVLink_global_position_int_message(
            self._milliseconds,
            degrees_e7(self.latitude),
            degrees_e7(self.longitude),
            round(1e3 * self.altitude),
            round(1e3 * self.height),
            _signed_16(100.0 * self.velocity_north),
            _signed_16(100.0 * self.velocity_east),
            _signed_16(-100.0 * self.climb),
            centidegrees(self.yaw),
        )

    def vfr_hud(self) -> Any:
        """Return VFR_HUD."""
        return mavlink.MAVLink_vfr_hud_message(
            self.airspeed,
            self._ground_speed,
            round(math.degrees(self.yaw)) % 360,
            max(0, min(100, round(100.0 * self.throttle))),
            self.altitude,
            self.climb,
        )

    def gps_raw(self) -> Any:
        """Return GPS_RAW_INT: a fix in three dimensions, of unknown precision."""
        course = math.atan2(self.velocity_east, self.velocity_north)
        return mavlink.MAVLink_gps_raw_int_message(
            round(1e6 * self.time),
            mavlink.GPS_FIX_TYPE_3D_FIX,
            degrees_e7(self.latitude),
            degrees_e7(self.longitude),
            round(1e3 * self.altitude),
            _UNKNOWN_16,
            _UNKNOWN_16,
            min(_UNKNOWN_16 - 1, round(100.0 * self._ground_speed)),
            centidegrees(course),
            255,
        )


def wind(north: float, east: float) -> Any:
    """Return WIND of air that moves north and east [m/s]; its direction is where it comes from."""
    from_deg = math.degrees(math.atan2(-east, -north)) % 360.0
    return mavlink.MAVLink_wind_message(from_deg, math.hypot(north, east), 0.0)


def system_status() -> Any:
    """Return SYS_STATUS of a vehicle whose sensors all work, and whose battery is not known."""
    sensors = (
        mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO
        | mavlink.MAV_SYS_STATUS_SENSOR_GPS
        | mavlink.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE
        | mavlink.MAV_SYS_STATUS_SENSOR_DIFFERENTIAL_PRESSURE
        | mavlink.MAV_SYS_STATUS_AHRS
    )
    return mavlink.MAVLink_sys_status_message(
        sensors, sensors, sensors, 0, _UNKNOWN_16, -1, -1, 0, 0, 0, 0, 0, 0
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class VesselState:
    """A vessel as it reports itself.

    Attributes
    ----------
    mmsi, name : of the vessel
    latitude, longitude : [rad]
    velocity_north, velocity_east : over the ground, by true north [m/s]
    bow : where the bow points, from true north [rad]
    age : of the report [s]
    size : as reported, or None
    """

    mmsi: int
    name: str
    latitude: float
    longitude: float
    velocity_north: float
    velocity_east: float
    bow: float
    age: float
    size: ShipSize | None = None

    def ais(self) -> Any:
        """Return AIS_VESSEL."""
        speed = math.hypot(self.velocity_north, self.velocity_east)
        moving = speed >= _AT_REST
        course = math.atan2(self.velocity_east, self.velocity_north)
        return mavlink.MAVLink_ais_vessel_message(
            self.mmsi,
            degrees_e7(self.latitude),
            degrees_e7(self.longitude),
            centidegrees(course),
            centidegrees(self.bow),
            min(_UNKNOWN_16, round(100.0 * speed)),
            0,
            mavlink.AIS_NAV_STATUS_UNDER_WAY,
            mavlink.AIS_TYPE_CARGO,
            0,
            0,
            0,
            0,
            b"",
            self.name.encode("ascii", "replace")[:20],
            min(_UNKNOWN_16, round(self.age)),
            _AIS_FLAGS
            | mavlink.AIS_FLAGS_VALID_NAME
            | (mavlink.AIS_FLAGS_VALID_COG if moving else 0),
        )

    def adsb(self) -> Any:
        """Return ADSB_VEHICLE, for ground stations that show no AIS: a vehicle on the surface."""
        speed = math.hypot(self.velocity_north, self.velocity_east)
        flags = (
            mavlink.ADSB_FLAGS_VALID_COORDS
            | mavlink.ADSB_FLAGS_VALID_ALTITUDE
            | mavlink.ADSB_FLAGS_VALID_HEADING
            | mavlink.ADSB_FLAGS_VALID_VELOCITY
        )
        return mavlink.MAVLink_adsb_vehicle_message(
            self.mmsi % 2**24,
            degrees_e7(self.latitude),
            degrees_e7(self.longitude),
            mavlink.ADSB_ALTITUDE_TYPE_GEOMETRIC,
            0,
            centidegrees(self.bow),
            min(_UNKNOWN_16, round(100.0 * speed)),
            0,
            self.name.encode("ascii", "replace")[:8],
            mavlink.ADSB_EMITTER_TYPE_SERVICE_SURFACE,
            min(255, round(self.age)),
            flags,
            0,
        )

    @classmethod
    def of(cls, message: Any) -> "VesselState | None":
        """Return the vessel of an AIS_VESSEL; None without a possible place and velocity."""
        latitude, longitude = from_degrees_e7(message.lat), from_degrees_e7(message.lon)
        placed = abs(latitude) <= 0.5 * math.pi and abs(longitude) <= math.pi
        if not placed or (message.lat == 0 and message.lon == 0):
            return None
        if not message.flags & mavlink.AIS_FLAGS_VALID_VELOCITY:
            return None
        speed = 0.01 * message.velocity
        course = math.radians(0.01 * message.COG)
        if not message.flags & mavlink.AIS_FLAGS_VALID_COG:
            if speed >= _AT_REST:
                return None
            speed = course = 0.0
        return cls(
            mmsi=message.MMSI,
            name=message.name,
            latitude=latitude,
            longitude=longitude,
            velocity_north=speed * math.cos(course),
            velocity_east=speed * math.sin(course),
            # 511 degrees are AIS's "not available".
            bow=math.radians(0.01 * message.heading) if message.heading < _CIRCLE else course,
            age=float(message.tslc),
            size=_size_of(message),
        )


def _size_of(message: Any) -> ShipSize | None:
    """Return the size in an AIS_VESSEL, or None."""
    known = message.flags & mavlink.AIS_FLAGS_VALID_DIMENSIONS
    if not known or message.flags & _MORE_THAN_SAID:
        return None
    size, _ = ship_size(
        bow=float(message.dimension_bow),
        stern=float(message.dimension_stern),
        port=float(message.dimension_port),
        starboard=float(message.dimension_starboard),
    )
    return size if size.known else None


def roll_target(time: float, system: int, component: int, roll: float) -> Any:
    """Return SET_ATTITUDE_TARGET of a roll [rad] alone, at a time since the sender began [s]."""
    half = 0.5 * roll
    return mavlink.MAVLink_set_attitude_target_message(
        round(1e3 * time) % 2**32,
        system,
        component,
        _ROLL_ALONE,
        [math.cos(half), math.sin(half), 0.0, 0.0],
        0.0,
        0.0,
        0.0,
        0.0,
    )


def roll_of(message: Any) -> float | None:
    """Return the roll [rad] that a SET_ATTITUDE_TARGET demands, by ArduPlane's reading of its mask;
    None where it demands no roll.
    """
    ignored = message.type_mask
    attitude = not ignored & mavlink.ATTITUDE_TARGET_TYPEMASK_ATTITUDE_IGNORE
    roll = not ignored & mavlink.ATTITUDE_TARGET_TYPEMASK_BODY_ROLL_RATE_IGNORE
    if not (attitude or roll):
        return None
    w, x, y, z = message.q
    if not math.isfinite(w + x + y + z) or not 0.9 < math.hypot(w, x, y, z) < 1.1:
        return None
    return math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
