"""A scenario's aircraft as a MAVLink vehicle: the messages that it sends and takes, and its
clock.
"""

import itertools
import math
import threading
import time
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from aircraft.state import turn_rates
from common.geodesy import LocalFrame
from common.physics import STANDARD_GRAVITY
from extensions.companion.fields import (
    AircraftState,
    VesselState,
    equivalent_over_true,
    system_status,
    wind,
)
from extensions.companion.plane import ACCEPTED, DENIED, UNSUPPORTED, Plane, PlaneMode
from extensions.companion.ports import Line, Peer, Port
from extensions.companion.sniffer_line import reading_line
from gnc.estimation.antenna import at_antenna
from gnc.estimation.vessel import VesselReport
from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
from scenarios.errors import InputError
from scenarios.experiment.requests import FlightRequest
from scenarios.flight.closed_loop import release
from scenarios.flight_runner import payload_of
from scenarios.instruments.instrument import GasReader
from scenarios.planning.flight_plan import FlightPlan
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.ais.track import AT_THE_FUNNEL
from scenarios.world.vessel import TRACK_STEP, VesselTruth

SYSTEM, COMPONENT = 1, mavlink.MAV_COMP_ID_AUTOPILOT1

MMSI, VESSEL_NAME = 999_999_999, "VESSEL"
"""MMSI of a scenario's vessel; its other ships have the numbers below it."""

_SLOW, _FAST = 1.0, 0.25
"""Default time between messages of a kind [s]."""

_STREAMS = {
    "HEARTBEAT": _SLOW,
    "SYS_STATUS": _SLOW,
    "GPS_RAW_INT": _SLOW,
    "WIND": _SLOW,
    "SYSTEM_TIME": _SLOW,
    "ATTITUDE": _FAST,
    "VFR_HUD": _FAST,
    "GLOBAL_POSITION_INT": _FAST,
}
"""Messages that have separate intervals, in their order; a place comes last, and completes a state.
"""

_NUMBERS = {
    message.msgname: number
    for number, message in mavlink.mavlink_map.items()
    if message.msgname in _STREAMS
}

_IDLE = 0.2
"""Longest wait for a message [s]."""

_FASTEST_STREAM = 0.005
"""Shortest interval between messages of a kind [s]."""

_EXACT_REPORTS = 1.0
"""Time between reports of a vessel that the scenario knows exactly, unless its flight plans more
often [s].
"""

_VERSION = 4 << 24 | 5 << 16
"""Version of the autopilot whose GUIDED mode is simulated, as in AUTOPILOT_VERSION: 4.5.0."""

_REPOSITION = mavlink.MAV_CMD_DO_REPOSITION
"""Whose parameters may be no numbers."""

_PARAMETER = mavlink.MAV_PARAM_TYPE_REAL32


def parameters_of(setup: VehicleSetup, plan: FlightPlan) -> dict[str, float]:
    """Return ArduPlane's parameters of a scenario's vehicle; airspeeds are equivalent ones."""
    ratio = equivalent_over_true(plan.altitude)
    bank_max = setup.aircraft.envelope.bank_max if setup.aircraft else math.radians(60.0)
    radius = plan.guidance.speed**2 / (STANDARD_GRAVITY * math.tan(0.6 * bank_max))
    return {
        "SYSID_THISMAV": float(SYSTEM),
        "SYSID_MYGCS": 255.0,
        "ROLL_LIMIT_DEG": math.degrees(bank_max),
        "AIRSPEED_MIN": ratio * setup.airspeed_min,
        "AIRSPEED_MAX": ratio * setup.airspeed_max,
        "AIRSPEED_CRUISE": ratio * plan.guidance.speed,
        "WP_LOITER_RAD": math.ceil(radius),
        "GUIDED_P": 5000.0,
        "GUIDED_TIMEOUT": 3.0,
        "FS_GCS_ENABL": 1.0,
        "FS_LONG_TIMEOUT": 5.0,
        "FS_LONG_ACTN": 1.0,
    }


class Simulation:
    """The aircraft of a planned flight under ArduPlane's modes, its vessel and its air.

    Parameters
    ----------
    plan, setup : the flight and its vehicle
    home : latitude and longitude of the scenario's origin, where the scenario gives none [rad]
    mode : at the start
    parameters : those that differ from ``parameters_of``

    Attributes
    ----------
    plane : the aircraft
    closest, closest_at : least distance from the centre of the keep-out area so far, and when
        [m, s]
    others : least distance from each of the other ships so far, by its name [m]
    """

    def __init__(
        self,
        plan: FlightPlan,
        setup: VehicleSetup,
        *,
        home: tuple[float, float],
        mode: PlaneMode,
        parameters: dict[str, float] | None = None,
    ) -> None:
        self._plan = plan
        place = plan.world.place if plan.world else None
        known = place is not None and math.isfinite(place.latitude + place.longitude)
        latitude, longitude = (place.latitude, place.longitude) if place and known else home
        frame = LocalFrame(latitude, longitude, plan.source_height)
        flown = None
        step = plan.time_step / round(120.0 * plan.time_step)
        if setup.aircraft is not None:
            flown = AutopilotedAircraft(setup.aircraft.spec, setup.aircraft.model)
            step = flown.fdm.time_step
        self._fdm = flown.fdm if flown else None
        # The vehicle is advanced by its time steps, not by those of the guidance.
        tracking = replace(plan.guidance.tracking, time_step=step)
        guidance = replace(plan.guidance, tracking=tracking)
        vehicle = release(replace(plan, guidance=guidance), setup, flown=flown)
        self.texts: list[str] = []
        self.plane = Plane(
            vehicle,
            frame,
            time_step=step,
            altitude=plan.altitude,
            airspeed=plan.guidance.speed,
            parameters=parameters_of(setup, plan) | (parameters or {}),
            mode=mode,
            say=self.texts.append,
        )
        self._reporting = list(self._ships())
        self.closest, self.closest_at = math.inf, math.nan
        self.others: dict[str, float] = {}
        self._measure()

    @property
    def time(self) -> float:
        """Return the time since the start [s]."""
        return self.plane.time

    def step(self) -> None:
        """Fly one time step."""
        self.plane.step()
        self._measure()

    def fault(self) -> str:
        """Return why the aircraft is out of control, or an empty text."""
        return self.plane.vehicle.fault(self.plane.vehicle.sample())

    def _measure(self) -> None:
        world = self._plan.world
        if world is None:
            return
        motion, vessel = self.plane.vehicle.motion(), world.vessel.motion(self.time)
        distance = math.hypot(motion.north - vessel[0], motion.east - vessel[1])
        if self._plan.keepout_shape == "sphere":
            altitude = self.plane.vehicle.sample()[0]
            distance = math.hypot(distance, altitude - world.source_height)
        if distance < self.closest:
            self.closest, self.closest_at = distance, self.time
        for ship in world.traffic:
            if ship.begins <= self.time <= ship.ends:
                north, east, *_ = ship.track.motion(self.time)
                apart = math.hypot(motion.north - north, motion.east - east)
                self.others[ship.name] = min(apart, self.others.get(ship.name, math.inf))

    def state(self) -> AircraftState:
        """Return the aircraft's motion now, by true north."""
        plane = self.plane
        motion, sample = plane.vehicle.motion(), plane.vehicle.sample()
        altitude, airspeed, roll, climb, heading, pitch = sample[:6]
        pitch = pitch if math.isfinite(pitch) else 0.0
        throttle = sample[10] if math.isfinite(sample[10]) else 0.0
        latitude, longitude = plane.frame.to_geodetic(motion.north, motion.east)
        turned = float(plane.frame.true_north(latitude, longitude))
        north, east = _turned(motion.velocity_north, motion.velocity_east, -turned)
        if self._fdm is not None:
            p, q, r = (self._fdm.read(f"velocities/{axis}-rad_sec") for axis in "pqr")
        else:
            p, q, r = turn_rates(motion.heading_rate, roll, pitch)
        return AircraftState(
            time=self.time,
            latitude=float(latitude),
            longitude=float(longitude),
            altitude=altitude,
            height=altitude - plane.home_altitude,
            velocity_north=north,
            velocity_east=east,
            climb=climb,
            roll=roll,
            pitch=pitch,
            yaw=heading - turned,
            rates=(p, q, r),
            airspeed=airspeed * equivalent_over_true(altitude),
            throttle=throttle,
        )

    def message(self, name: str) -> Any:
        """Return a message of ``_STREAMS`` as it is now."""
        match name:
            case "HEARTBEAT":
                found = self._heartbeat()
            case "SYS_STATUS":
                found = system_status()
            case "WIND":
                found = wind(*self._wind())
            case "SYSTEM_TIME":
                found = self.clock()
            case "GPS_RAW_INT":
                found = self.state().gps_raw()
            case "ATTITUDE":
                found = self.state().attitude()
            case "VFR_HUD":
                found = self.state().vfr_hud()
            case _:
                found = self.state().global_position()
        return found

    def _heartbeat(self) -> Any:
        return mavlink.MAVLink_heartbeat_message(
            mavlink.MAV_TYPE_FIXED_WING,
            mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA,
            mavlink.MAV_MODE_FLAG_SAFETY_ARMED
            | mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
            | mavlink.MAV_MODE_FLAG_GUIDED_ENABLED
            | mavlink.MAV_MODE_FLAG_STABILIZE_ENABLED,
            int(self.plane.mode),
            mavlink.MAV_STATE_ACTIVE,
            3,
        )

    def clock(self) -> Any:
        """Return SYSTEM_TIME."""
        place = self._plan.world.place if self._plan.world else None
        utc = place.utc if place and math.isfinite(place.utc) else 0.0
        since = round(1e6 * (utc + self.time)) if utc else 0
        return mavlink.MAVLink_system_time_message(since, round(1e3 * self.time))

    def _wind(self) -> tuple[float, float]:
        """Return the mean wind at the aircraft, by the frame's north, which is true there to 1e-3
        [m/s].
        """
        if self._plan.world is None:
            return 0.0, 0.0
        altitude = self.plane.vehicle.sample()[0]
        return self._plan.world.weather.wind.now(self.time, altitude)

    def _ships(self) -> Iterator["_Reporting"]:
        """Yield the ships that send reports, the measured one first."""
        plan = self._plan
        if plan.world is None:
            return
        sensing, every = plan.sensing, _EXACT_REPORTS
        if sensing is not None:
            every = plan.time_step * plan.guidance.mission.plan_interval
        received = sensing.received if sensing is not None else None
        hull = plan.world.hull
        antenna = AT_THE_FUNNEL if hull is None else hull.antenna_offset
        yield _Reporting(MMSI, VESSEL_NAME, plan.world.vessel, received, every, antenna)
        of_others = sensing.traffic if sensing is not None else ()
        for number, (ship, of) in enumerate(zip(plan.world.traffic, of_others, strict=True)):
            yield _Reporting(MMSI - 1 - number, ship.name, ship.track, of, _EXACT_REPORTS)

    def vessels(self) -> Iterator[Any]:
        """Yield the messages of the reports that have been received since the last call."""
        for ship in self._reporting:
            for report in ship.until(self.time):
                latitude, longitude = self.plane.frame.to_geodetic(report.north, report.east)
                turned = float(self.plane.frame.true_north(latitude, longitude))
                north, east = _turned(report.velocity_north, report.velocity_east, -turned)
                vessel = VesselState(
                    mmsi=ship.mmsi,
                    name=ship.name,
                    latitude=float(latitude),
                    longitude=float(longitude),
                    velocity_north=north,
                    velocity_east=east,
                    bow=ship.track.course(report.time) - turned,
                    age=max(0.0, self.time - report.time),
                )
                yield vessel.ais()
                yield vessel.adsb()


class _Reporting:
    """A ship that sends reports.

    Parameters
    ----------
    mmsi, name, track : of the ship
    received : its reports as they are received, with the time of each [s]; None for a ship that is
        known exactly
    every : time between reports of such a ship [s]
    antenna : antenna whose place the vessel reports, ahead of the reports' place and to starboard
        of it [m]
    """

    def __init__(
        self,
        mmsi: int,
        name: str,
        track: VesselTruth,
        received: Sequence[tuple[float, VesselReport]] | None,
        every: float,
        antenna: tuple[float, float] = AT_THE_FUNNEL,
    ) -> None:
        self.mmsi, self.name, self.track = mmsi, name, track
        self._antenna = antenna
        self._reports = iter(received) if received is not None else self._exact(every)
        self._next = next(self._reports, None)

    def _exact(self, every: float) -> Iterator[tuple[float, VesselReport]]:
        for number in itertools.count():
            at = number * every
            yield at, VesselReport(at, *self.track.motion(at))

    def until(self, time: float) -> Iterator[VesselReport]:
        """Yield the reports that have been received until a time [s] since the last call."""
        while self._next is not None and self._next[0] <= time + 1e-6:
            _, report = self._next
            self._next = next(self._reports, None)
            yield self._of_antenna(report)

    def _of_antenna(self, report: VesselReport) -> VesselReport:
        if self._antenna == AT_THE_FUNNEL:
            return report
        course = self.track.course
        rate = (course(report.time + TRACK_STEP) - course(report.time)) / TRACK_STEP
        return at_antenna(report, self._antenna, course(report.time), rate)


def _turned(north: float, east: float, angle: float) -> tuple[float, float]:
    """Return a vector turned clockwise by an angle [rad]."""
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * north - sine * east, sine * north + cosine * east


class Server:
    """Serves a simulation over MAVLink.

    Parameters
    ----------
    simulation, port : the simulation, and its port
    lockstep : whether the clock waits for the SYSTEM_TIME of a companion

    Attributes
    ----------
    stopping : ends the flight when it is set
    """

    def __init__(self, simulation: Simulation, port: Port, *, lockstep: bool) -> None:
        self._simulation, self._plane, self._port = simulation, simulation.plane, port
        self._lockstep = lockstep
        self.stopping = threading.Event()
        self._intervals = dict(_STREAMS)
        if lockstep:
            # The clock comes last: it says that everything before it has been sent.
            self._intervals["SYSTEM_TIME"] = 0.0
        self._due = dict.fromkeys(_STREAMS, 0.0)
        self._asked_for, self._told_until = 0.0, -math.inf
        self._request = 0

    def run(self, duration: float) -> str:
        """Fly until a time [s] is over or the aircraft is lost; return why it ended, in words."""
        simulation, began = self._simulation, time.monotonic()
        while simulation.time < duration and not self.stopping.is_set():
            if self._lockstep:
                fault = self.answer(_IDLE)
            else:
                ahead = simulation.time + simulation.plane.time_step - (time.monotonic() - began)
                self._serve(max(0.0, ahead))
                fault = self._fly_until(time.monotonic() - began)
            if fault:
                return f"lost at {simulation.time:.1f} s: {fault}"
        return "time is up"

    def answer(self, timeout: float) -> str:
        """Receive the messages in lockstep, waiting for at most a time [s], and advance to the
        requested time; return why the aircraft is lost, or an empty text.
        """
        self._serve(timeout)
        fault = self._fly_until(self._asked_for)
        if self._asked_for > 0.0 and self._simulation.time > self._told_until:
            self._tell()
        return fault

    def _fly_until(self, until: float) -> str:
        """Fly until a time [s]; return why the aircraft is lost, or an empty text."""
        simulation, fault = self._simulation, ""
        while not fault and simulation.time + 0.5 * self._plane.time_step < until:
            simulation.step()
            fault = simulation.fault()
            if not self._lockstep:
                self._tell()
        return fault

    def _tell(self) -> None:
        """Send the messages that are due."""
        simulation = self._simulation
        now = simulation.time
        for name, interval in self._intervals.items():
            if interval > 0.0 and now >= self._due[name] - 1e-6:
                # The next time is on the grid of the interval, even if messages were missed.
                missed = math.floor((now - self._due[name]) / interval + 1e-6)
                self._due[name] += (missed + 1) * interval
                self._port.send(simulation.message(name))
        for message in simulation.vessels():
            self._port.send(message)
        while simulation.texts:
            text = simulation.texts.pop(0).encode("ascii", "replace")[:50]
            self._port.send(mavlink.MAVLink_statustext_message(mavlink.MAV_SEVERITY_INFO, text))
        if self._lockstep and now > self._told_until:
            self._port.send(self._reached())
        self._told_until = now

    def _reached(self) -> Any:
        """Return SYSTEM_TIME of the requested time, to within half a step, with the number of the
        request.
        """
        return mavlink.MAVLink_system_time_message(self._request, round(1e3 * self._asked_for))

    def _serve(self, timeout: float) -> None:
        """Receive the arriving messages, waiting for at most a time [s]."""
        for peer, message in self._port.receive(timeout):
            self._take(peer, message)

    def _take(self, peer: Peer, message: Any) -> None:
        kind = message.get_type()
        sender = message.get_srcSystem(), message.get_srcComponent()
        if kind == "HEARTBEAT":
            if sender[0] == int(self._plane.parameters["SYSID_MYGCS"]):
                self._plane.ground_station_seen()
            self._port.forward(message, peer)
            return
        target = getattr(message, "target_system", 0), getattr(message, "target_component", 0)
        if target[0] not in (0, SYSTEM) or target[1] not in (0, COMPONENT):
            return
        if kind == "SYSTEM_TIME":
            if self._lockstep and sender[1] == mavlink.MAV_COMP_ID_ONBOARD_COMPUTER:
                self._request = message.time_unix_usec
                self._advance_to(1e-3 * message.time_boot_ms, peer)
        elif kind == "SET_ATTITUDE_TARGET":
            self._plane.set_attitude(message)
        elif kind in ("COMMAND_INT", "COMMAND_LONG"):
            result = self._command(message, peer)
            acknowledgement = mavlink.MAVLink_command_ack_message(
                message.command, result, 0, 0, *sender
            )
            self._port.send(acknowledgement, peer)
        elif kind == "SET_MODE":
            self._set_mode(message.custom_mode)
        elif kind.startswith("PARAM_"):
            self._parameter(kind, message, peer)
        else:
            self._answer(kind, message, peer)

    def _set_mode(self, number: int) -> int:
        """Enter a mode, and report it at once; return the result of the command."""
        result = self._plane.set_mode(number)
        self._port.send(self._simulation.message("HEARTBEAT"))
        return result

    def _answer(self, kind: str, message: Any, peer: Peer) -> None:
        """Answer the requests of ground stations."""
        sender = message.get_srcSystem(), message.get_srcComponent()
        if kind == "REQUEST_DATA_STREAM":
            rate = message.req_message_rate
            on = message.start_stop and rate
            for name in ("ATTITUDE", "GLOBAL_POSITION_INT", "VFR_HUD"):
                self._set_interval(name, max(_FASTEST_STREAM, 1.0 / rate) if on else 0.0)
        elif kind == "MISSION_REQUEST_LIST":
            count = mavlink.MAVLink_mission_count_message(*sender, 0, message.mission_type)
            self._port.send(count, peer)
        elif kind == "TIMESYNC" and message.tc1 == 0:
            now = round(1e9 * self._simulation.time)
            self._port.send(mavlink.MAVLink_timesync_message(now, message.ts1), peer)

    def _advance_to(self, until: float, peer: Peer) -> None:
        """Take the time that a companion's clock requests; confirm again a time that is reached."""
        self._asked_for = max(self._asked_for, until)
        if until <= self._simulation.time + 0.5 * self._plane.time_step:
            if self._told_until == -math.inf:
                self._tell()
            else:
                self._port.send(self._simulation.message("HEARTBEAT"), peer)
                self._port.send(self._reached(), peer)

    def _command(self, message: Any, peer: Peer) -> int:
        number, first = message.command, message.param1
        modes = {
            mavlink.MAV_CMD_NAV_LOITER_UNLIM: PlaneMode.LOITER,
            mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: PlaneMode.RTL,
        }
        if not math.isfinite(first + message.param2) and number != _REPOSITION:
            result = DENIED
        elif number == mavlink.MAV_CMD_DO_SET_MODE:
            by_number = int(first) & mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
            result = self._set_mode(int(message.param2)) if by_number else DENIED
        elif number in modes:
            result = self._set_mode(modes[number])
        elif number == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            result = self._message_interval(int(first), message.param2)
        elif number == mavlink.MAV_CMD_REQUEST_MESSAGE:
            result = self._requested(int(first), peer)
        elif message.get_type() == "COMMAND_INT" or number == mavlink.MAV_CMD_DO_CHANGE_SPEED:
            result = self._plane.command(message)
        else:
            result = UNSUPPORTED
        return result

    def _message_interval(self, number: int, microseconds: float) -> int:
        name = next((name for name, of in _NUMBERS.items() if of == number), None)
        if name is None or not math.isfinite(microseconds):
            return DENIED
        if microseconds == 0.0:
            interval = _STREAMS[name]
        else:
            interval = max(_FASTEST_STREAM, 1e-6 * microseconds) if microseconds > 0.0 else 0.0
        self._set_interval(name, interval)
        return ACCEPTED

    def _set_interval(self, name: str, interval: float) -> None:
        """Send a message at an interval [s] from now on; 0 for no more."""
        self._intervals[name] = interval
        self._due[name] = self._simulation.time

    def _requested(self, number: int, peer: Peer) -> int:
        name = next((name for name, of in _NUMBERS.items() if of == number), None)
        if name is not None:
            self._port.send(self._simulation.message(name), peer)
            return ACCEPTED
        if number != mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION:
            return UNSUPPORTED
        capabilities = (
            mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
            | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
            | mavlink.MAV_PROTOCOL_CAPABILITY_SET_ATTITUDE_TARGET
            | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_FLOAT
        )
        version = mavlink.MAVLink_autopilot_version_message(
            capabilities, _VERSION, 0, 0, 0, [0] * 8, [0] * 8, [0] * 8, 0, 0, 1
        )
        self._port.send(version, peer)
        return ACCEPTED

    def _parameter(self, kind: str, message: Any, peer: Peer) -> None:
        parameters = self._plane.parameters
        names: Sequence[str] = list(parameters)
        chosen: Sequence[str] = names
        if kind != "PARAM_REQUEST_LIST":
            name = message.param_id.rstrip("\0")
            if kind == "PARAM_REQUEST_READ" and 0 <= message.param_index < len(names):
                name = names[message.param_index]
            chosen = [name] if name in parameters else []
        if kind == "PARAM_SET" and chosen and math.isfinite(message.param_value):
            parameters[chosen[0]] = message.param_value
        for name in chosen:
            value = mavlink.MAVLink_param_value_message(
                name.encode(), parameters[name], _PARAMETER, len(names), names.index(name)
            )
            self._port.send(value, peer)


def send_readings(
    simulation: Simulation, request: FlightRequest, plan: FlightPlan, line: Line
) -> None:
    """Read a flight's sniffer during the flight, and send its readings in lines.

    Raises
    ------
    InputError : the flight has no sniffer
    """
    sniffers = [each for each in payload_of(request, plan) if isinstance(each, GasReader)]
    if not sniffers:
        raise InputError("--sniffer: the scenario has no sniffer; set payload.instruments")
    sniffer, vehicle = sniffers[0], simulation.plane.vehicle
    every = round(plan.time_step * plan.log_interval / simulation.plane.time_step)
    step, sent = simulation.step, -math.inf
    (peer,) = line.connected()

    def stepped() -> None:
        nonlocal sent
        step()
        if simulation.plane.steps % every:
            return
        now = simulation.time
        if sniffer.follow(now, vehicle.motion(), vehicle.sample()):
            new = sniffer.readings(math.nextafter(sent, math.inf))
            for at, values in zip(new.time.tolist(), new.values.tolist(), strict=True):
                line.send(reading_line(max(0.0, now - at), values), peer)
                sent = at

    simulation.step = stepped  # type: ignore[method-assign]
