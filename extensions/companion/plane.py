"""ArduPlane's modes over the autopilot of the study, as far as a companion computer uses them.

Written from ArduPlane's documented behaviour. In GUIDED a roll by SET_ATTITUDE_TARGET is flown for
``GUIDED_TIMEOUT``; without one, a course by GUIDED_CHANGE_HEADING, which is sticky; without that,
the loiter about the last DO_REPOSITION, or about where GUIDED was entered. Differences: the roll is
flown by the study's autopilot, which turns at the heading rate of a coordinated turn with that
roll; a forced pitch and a forced throttle are not flown.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import IntEnum
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from common.geodesy import LocalFrame
from common.physics import STANDARD_GRAVITY, heading_rate_for_bank
from extensions.arena.laws.ardupilot import update_loiter
from extensions.companion.fields import equivalent_over_true, from_degrees_e7, roll_of
from scenarios.vehicles.vehicle import Vehicle

_SLOWEST = 1.0
"""Least airspeed in the heading rate of a turn [m/s]."""

_FASTEST_CHANGE = 1000.0
"""Default rate of a change of speed or height, as in ArduPlane [m/s^2, m/s]."""

_LEAST_ACCELERATION = 0.05
"""Default lateral acceleration of a change of heading [m/s^2]."""

ACCEPTED: int = mavlink.MAV_RESULT_ACCEPTED
DENIED: int = mavlink.MAV_RESULT_DENIED
FAILED: int = mavlink.MAV_RESULT_FAILED
UNSUPPORTED: int = mavlink.MAV_RESULT_UNSUPPORTED
"""Results of commands."""


class PlaneMode(IntEnum):
    """Modes of ArduPlane that are flown, by its numbers."""

    CIRCLE = 1
    RTL = 11
    LOITER = 12
    GUIDED = 15


@dataclass(slots=True)
class Loiter:
    """A circle to fly: its centre north and east [m], its radius [m], +1 clockwise or -1."""

    north: float
    east: float
    radius: float
    side: int = 1


@dataclass(slots=True)
class _Guided:
    """The last demands in GUIDED; times are of the plane's clock [s]."""

    roll: float = 0.0
    roll_at: float = -math.inf
    course: float | None = None
    over_ground: bool = True
    acceleration: float = _LEAST_ACCELERATION


class Plane:
    """A vehicle under ArduPlane's modes.

    Parameters
    ----------
    vehicle : under way, advanced by ``time_step`` at a time
    frame : of its north and east
    time_step : of the vehicle [s]
    altitude, airspeed : that it holds at the start [m, m/s]
    parameters : by ArduPlane's names; they may be changed at any time
    mode : at the start
    say : shows a message as a ground station would

    Attributes
    ----------
    mode : flown now
    steps : of the vehicle so far
    """

    def __init__(
        self,
        vehicle: Vehicle,
        frame: LocalFrame,
        *,
        time_step: float,
        altitude: float,
        airspeed: float,
        parameters: Mapping[str, float],
        mode: PlaneMode,
        say: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.vehicle, self.frame, self.time_step = vehicle, frame, time_step
        self.parameters = dict(parameters)
        self.steps, self._say = 0, say
        self._altitude = self._altitude_target = self._home_altitude = altitude
        self._climb_rate = _FASTEST_CHANGE
        self._airspeed = self._airspeed_target = airspeed
        self._speed_change = _FASTEST_CHANGE
        motion = vehicle.motion()
        self.home = (motion.north, motion.east)
        self._ground_station_at: float | None = None
        self._failsafe = False
        self._guided = _Guided()
        self.mode = mode
        self._loiter = self._here()
        self.set_mode(mode)

    @property
    def time(self) -> float:
        """Return the time since the start [s]."""
        return self.steps * self.time_step

    @property
    def home_altitude(self) -> float:
        """Return the altitude of home above the sea, to which heights refer [m]."""
        return self._home_altitude

    # ------------------------------------------------------------ what is commanded

    def set_mode(self, number: int) -> int:
        """Enter a mode by its number; return the result of the command."""
        if number not in set(PlaneMode):
            return FAILED
        mode = PlaneMode(number)
        if mode is self.mode and self.steps:
            return ACCEPTED
        self.mode = mode
        self._guided = _Guided()
        self._speed_change = _FASTEST_CHANGE
        self._airspeed_target = self._true(self.parameters["AIRSPEED_CRUISE"])
        self._loiter = self._here()
        if mode is PlaneMode.RTL:
            self._loiter.north, self._loiter.east = self.home
        self._say(f"mode {mode.name}")
        return ACCEPTED

    def set_attitude(self, message: Any) -> None:
        """Take a SET_ATTITUDE_TARGET, in GUIDED alone."""
        roll = roll_of(message)
        if self.mode is PlaneMode.GUIDED and roll is not None:
            self._guided.roll, self._guided.roll_at = roll, self.time

    def ground_station_seen(self) -> None:
        """Record a heartbeat of the ground station whose silence triggers a failsafe."""
        self._ground_station_at, self._failsafe = self.time, False

    def command(self, message: Any) -> int:
        """Take a COMMAND_INT; return its result."""
        handler: Callable[[Any], int] | None = {
            mavlink.MAV_CMD_GUIDED_CHANGE_SPEED: self._change_speed,
            mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE: self._change_altitude,
            mavlink.MAV_CMD_GUIDED_CHANGE_HEADING: self._change_heading,
            mavlink.MAV_CMD_DO_REPOSITION: self._reposition,
            mavlink.MAV_CMD_DO_CHANGE_SPEED: self._change_speed,
        }.get(message.command)
        if handler is None:
            return UNSUPPORTED
        changes_mode = message.command == mavlink.MAV_CMD_DO_REPOSITION
        if self.mode is not PlaneMode.GUIDED and not changes_mode:
            return FAILED
        return handler(message)

    def _change_speed(self, message: Any) -> int:
        kind, speed = message.param1, message.param2
        if kind != mavlink.SPEED_TYPE_AIRSPEED:
            return DENIED
        slowest, fastest = self.parameters["AIRSPEED_MIN"], self.parameters["AIRSPEED_MAX"]
        if not slowest <= speed <= fastest:
            return FAILED
        rate = message.param3 if message.command == mavlink.MAV_CMD_GUIDED_CHANGE_SPEED else 0.0
        self._speed_change = abs(rate) if math.isfinite(rate) and rate else _FASTEST_CHANGE
        self._airspeed_target = self._true(speed)
        return ACCEPTED

    def _change_altitude(self, message: Any) -> int:
        altitude = self._altitude_of(message.frame, message.z)
        if altitude is None or message.z in (0.0, -1.0):
            return DENIED
        rate = message.param3
        self._climb_rate = abs(rate) if math.isfinite(rate) and rate else _FASTEST_CHANGE
        self._altitude_target = altitude
        return ACCEPTED

    def _change_heading(self, message: Any) -> int:
        kind, course, acceleration = message.param1, message.param2, message.param3
        if not 0.0 <= course < 360.0 or not math.isfinite(acceleration):
            return DENIED
        if kind == mavlink.HEADING_TYPE_DEFAULT:
            self._guided.course = None
            return ACCEPTED
        if kind not in (
            mavlink.HEADING_TYPE_COURSE_OVER_GROUND,
            mavlink.HEADING_TYPE_HEADING,
        ):
            return DENIED
        self._guided.over_ground = kind == mavlink.HEADING_TYPE_COURSE_OVER_GROUND
        self._guided.course = math.radians(course)
        self._guided.acceleration = max(_LEAST_ACCELERATION, acceleration)
        return ACCEPTED

    def _reposition(self, message: Any) -> int:
        latitude, longitude = from_degrees_e7(message.x), from_degrees_e7(message.y)
        altitude = self._altitude_of(message.frame, message.z)
        placed = abs(latitude) <= 0.5 * math.pi and abs(longitude) <= math.pi
        if altitude is None or not placed or (message.x == 0 and message.y == 0):
            return DENIED
        flags = int(message.param2) if math.isfinite(message.param2) else 0
        to_mode = flags & mavlink.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE
        if self.mode is not PlaneMode.GUIDED:
            if not to_mode:
                return FAILED
            self.set_mode(PlaneMode.GUIDED)
        north, east = (float(each) for each in self.frame.to_local(latitude, longitude))
        radius = message.param3
        given = math.isfinite(radius) and radius > 0.0
        turns_left = math.isfinite(message.param4) and message.param4 != 0.0
        self._loiter = Loiter(
            north,
            east,
            radius if given else abs(self.parameters["WP_LOITER_RAD"]),
            -1 if turns_left else 1,
        )
        self._guided.course = None
        self._altitude_target, self._climb_rate = altitude, _FASTEST_CHANGE
        return ACCEPTED

    def _altitude_of(self, frame: int, height: float) -> float | None:
        """Return an altitude above the sea [m] by the frame of a command; None for other frames."""
        if not math.isfinite(height):
            return None
        if frame in (mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT):
            return height
        if frame in (
            mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT,
            mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT,
        ):
            return self._home_altitude + height
        return None

    # ------------------------------------------------------------ what is flown

    def step(self) -> None:
        """Fly one time step."""
        self._watch_ground_station()
        airspeed, heading, _ = self.vehicle.air_data()
        limit = math.radians(self.parameters["ROLL_LIMIT_DEG"])
        roll = min(limit, max(-limit, self._roll(heading, limit)))
        self._airspeed = _towards(
            self._airspeed, self._airspeed_target, self._speed_change * self.time_step
        )
        altitude = _towards(
            self._altitude, self._altitude_target, self._climb_rate * self.time_step
        )
        if altitude != self._altitude:
            self._altitude = altitude
            self.vehicle.command_altitude(altitude)
        rate = heading_rate_for_bank(roll, max(_SLOWEST, airspeed))
        self.vehicle.advance(rate, self._airspeed)
        self.steps += 1

    def _roll(self, heading: float, limit: float) -> float:
        """Return the roll that the mode demands [rad]."""
        guided, motion = self._guided, self.vehicle.motion()
        if self.mode is PlaneMode.CIRCLE:
            return limit / 3.0
        if self.mode is PlaneMode.GUIDED:
            if self.time - guided.roll_at < self.parameters["GUIDED_TIMEOUT"]:
                return guided.roll
            if guided.course is not None:
                over_ground = math.atan2(motion.velocity_east, motion.velocity_north)
                at = self.frame.to_geodetic(motion.north, motion.east)
                # Commands and the vehicle's sensors have true north.
                own = (over_ground if guided.over_ground else heading) - float(
                    self.frame.true_north(*at)
                )
                error = math.remainder(guided.course - own, math.tau)
                gain = math.radians(0.01 * self.parameters["GUIDED_P"])
                most = math.atan(guided.acceleration / STANDARD_GRAVITY)
                return min(most, max(-most, gain * error))
        loiter = self._loiter
        across = update_loiter(
            (motion.north, motion.east),
            (motion.velocity_north, motion.velocity_east),
            heading,
            (loiter.north, loiter.east),
            loiter.radius,
            loiter.side,
        )
        return math.atan(across / STANDARD_GRAVITY)

    def _watch_ground_station(self) -> None:
        """Enter RTL once the ground station has been silent for too long, if that is a failsafe."""
        seen, of = self._ground_station_at, self.parameters
        if seen is None or self._failsafe or not of["FS_GCS_ENABL"]:
            return
        if self.mode is PlaneMode.GUIDED and self.time - seen > of["FS_LONG_TIMEOUT"]:
            self._failsafe = True
            self._say("failsafe: no heartbeat of the ground station")
            if of["FS_LONG_ACTN"] == 1.0:
                self.set_mode(PlaneMode.RTL)

    def _here(self) -> Loiter:
        motion = self.vehicle.motion()
        return Loiter(motion.north, motion.east, abs(self.parameters["WP_LOITER_RAD"]))

    def _true(self, equivalent: float) -> float:
        """Return the true airspeed [m/s] of an equivalent one, at the altitude of the flight."""
        return equivalent / equivalent_over_true(self._altitude)


def _towards(value: float, target: float, most: float) -> float:
    """Return a value moved towards a target by at most a step."""
    return target if abs(target - value) <= most else value + math.copysign(most, target - value)
