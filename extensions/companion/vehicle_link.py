"""The link from a companion to its vehicle: messages in both directions over a possibly bad link,
the vehicle's reports of its state, and its clock.

Times are those of the vehicle's clock. In lockstep the companion sets that clock: it sends the time
that it wants as SYSTEM_TIME, and the vehicle answers with the same time when it has reached it and
has reported everything up to it. ``time_unix_usec`` numbers the request and its answer. These
messages do not count as traffic of the link, and take no time. Otherwise the clock is estimated
from the telemetry's time stamps, by the message with the shortest delay.
"""

import math
import time
from collections.abc import Callable
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from aircraft.state import euler_rates
from extensions.companion.ais_line import AisReceiver
from extensions.companion.fields import AircraftState, VesselState, from_degrees_e7
from extensions.companion.ports import Port
from extensions.companion.quality import Link, SimulatedLink

COMPONENT = mavlink.MAV_COMP_ID_ONBOARD_COMPUTER

_HEARTBEAT_INTERVAL = 1.0
_REQUEST_AGAIN, _GIVE_UP = 0.5, 60.0
"""Time after which the request of a vehicle's time in lockstep is repeated, and time after which
the vehicle counts as gone [s]: it may have to compute for long.
"""

_JUMP = 1.0
"""Largest difference of a vehicle's clock from the expected time [s]; the clock of a restarted
vehicle differs by more.
"""

_ATTITUDE_AGE = 1.0
"""Longest time over which a heading is extrapolated to its place [s]."""

_IDLE = 0.05
"""Longest wait for a message [s]."""


class VehicleLink:
    """The state of a vehicle, and messages to it.

    Parameters
    ----------
    port : to the vehicle
    link : declared quality of the link
    lockstep : whether the vehicle's clock waits for this one
    simulated : seed of a simulated bad link, or None for the real link
    receiver : AIS receiver on board, in place of the AIS_VESSEL of the vehicle, or None

    Attributes
    ----------
    now : time of the vehicle's clock [s]
    system : of the vehicle, 0 before its first heartbeat
    kind, autopilot, mode : of its heartbeat
    parameters : that it has reported, by name
    state : its motion; None before it was reported completely
    vessels : last report of each vessel by its MMSI, with the time at which it was true [s]
    rival : another companion on the link, as (system, component), or None
    restarted : whether the vehicle's clock has jumped
    """

    def __init__(
        self,
        port: Port,
        link: Link,
        *,
        lockstep: bool,
        simulated: int | str | None,
        receiver: AisReceiver | None = None,
    ) -> None:
        self._port, self._link, self._lockstep = port, link, lockstep
        self._receiver = receiver
        self._up, self._down = SimulatedLink(Link(), 0), SimulatedLink(Link(), 0)
        self._simulated = simulated
        self.now = 0.0
        self._begun = time.monotonic()
        self.system = self.kind = self.autopilot = 0
        self.mode = -1
        self.parameters: dict[str, float] = {}
        self.acknowledged: dict[int, int] = {}
        self.state: AircraftState | None = None
        self._attitude: Any = None
        self._hud: Any = None
        self.vessels: dict[int, tuple[float, VesselState]] = {}
        self.on_vessel: Callable[[float, VesselState], None] = lambda *_: None
        self.rival: tuple[int, int] | None = None
        self.restarted = False
        self._offset: float | None = None
        self._reached = -math.inf
        self._request = self._answered = 0
        self._next_heartbeat = self._next_heartbeat_now = -math.inf
        self.gone = False

    def degrade(self) -> None:
        """Degrade the link as declared from now on, where that is simulated."""
        if self._simulated is not None:
            self._up = SimulatedLink(self._link, f"up {self._simulated}")
            self._down = SimulatedLink(self._link, f"down {self._simulated}")

    # ------------------------------------------------------------ telling

    def send(self, message: Any) -> None:
        """Send a message."""
        self._up.put(self.now, message)
        self._flush()

    def command(
        self,
        number: int,
        *values: float,
        x: int = 0,
        y: int = 0,
        z: float = 0.0,
        frame: int = mavlink.MAV_FRAME_GLOBAL,
    ) -> None:
        """Send a COMMAND_INT with up to four parameters."""
        first, second, third, fourth = (*values, 0.0, 0.0, 0.0, 0.0)[:4]
        self.send(
            mavlink.MAVLink_command_int_message(
                self.system,
                mavlink.MAV_COMP_ID_AUTOPILOT1,
                frame,
                number,
                0,
                0,
                first,
                second,
                third,
                fourth,
                x,
                y,
                z,
            )
        )

    def request_parameter(self, name: str) -> None:
        """Request a parameter."""
        self.send(
            mavlink.MAVLink_param_request_read_message(
                self.system, mavlink.MAV_COMP_ID_AUTOPILOT1, name.encode(), -1
            )
        )

    def _flush(self) -> None:
        for message in self._up.due(self.now):
            self._port.send(message)

    def _heartbeat(self) -> None:
        if time.monotonic() >= self._next_heartbeat or self.now >= self._next_heartbeat_now:
            self._next_heartbeat = time.monotonic() + _HEARTBEAT_INTERVAL
            self._next_heartbeat_now = self.now + _HEARTBEAT_INTERVAL
            self.send(
                mavlink.MAVLink_heartbeat_message(
                    mavlink.MAV_TYPE_ONBOARD_CONTROLLER,
                    mavlink.MAV_AUTOPILOT_INVALID,
                    0,
                    0,
                    mavlink.MAV_STATE_ACTIVE,
                    3,
                )
            )

    # ------------------------------------------------------------ the clock

    def advance(self, until: float, enough: Callable[[], bool] = lambda: False) -> None:
        """Receive messages until a time of the vehicle's clock [s], or, outside of lockstep, until
        ``enough`` returns true.
        """
        self._heartbeat()
        if self._lockstep:
            while True:
                target = min(until, max(self.now, self._up.next_arrival))
                self._ask(target)
                self.now = max(self.now, target)
                self._flush()
                self._deliver()
                if self.now >= until - 1e-9 or self.gone:
                    return
        # Messages that have arrived are taken first: a late step must not delay the next one.
        left = 0.0
        while True:
            for _, message in self._port.receive(min(left, _IDLE)):
                self._receive(message)
            self.now = self._estimate()
            self._flush()
            self._deliver()
            left = until - self.now
            if left <= 0.0 or enough():
                return

    def _estimate(self) -> float:
        if self._offset is None:
            return max(self.now, time.monotonic() - self._begun)
        return time.monotonic() + self._offset

    def _ask(self, until: float) -> None:
        """Let the vehicle's clock go on to a time [s]."""
        began, requested = time.monotonic(), -math.inf
        milliseconds = round(1e3 * until)
        self._request += 1
        while self._answered < self._request or 1e3 * self._reached < milliseconds - 0.5:
            clock = time.monotonic()
            if clock - began >= _GIVE_UP:
                self.gone = True
                return
            if clock - requested >= _REQUEST_AGAIN:
                requested = clock
                self._port.send(mavlink.MAVLink_system_time_message(self._request, milliseconds))
            for _, message in self._port.receive(_IDLE):
                self._receive(message, at=until)
        self._reached = max(self._reached, until)

    # ------------------------------------------------------------ hearing

    def _receive(self, message: Any, at: float | None = None) -> None:
        sender = message.get_srcSystem(), message.get_srcComponent()
        kind = message.get_type()
        if kind == "HEARTBEAT" and message.type == mavlink.MAV_TYPE_ONBOARD_CONTROLLER:
            self.rival = sender
            return
        of_autopilot = sender[1] == mavlink.MAV_COMP_ID_AUTOPILOT1
        if kind == "HEARTBEAT" and of_autopilot and not self.system:
            self.system = sender[0]
        if sender[0] != self.system or not of_autopilot:
            return
        if kind == "SYSTEM_TIME" and self._lockstep:
            if 1e-3 * message.time_boot_ms < self._reached - _JUMP:
                self.restarted = True
            self._reached = 1e-3 * message.time_boot_ms
            self._answered = message.time_unix_usec
            return
        if kind == "GLOBAL_POSITION_INT":
            self._check_clock(1e-3 * message.time_boot_ms)
        if at is None and self._offset is None:
            # Its clock is not known yet.
            self._take(message)
        else:
            self._down.put(self._estimate() if at is None else at, message)

    def _check_clock(self, stamp: float) -> None:
        """Estimate the vehicle's clock by a time stamp [s], and notice where it jumps."""
        if self._lockstep:
            if stamp < self._reached - _JUMP:
                self.restarted = True
            return
        latency = 0.0 if self._simulated is not None else self._link.latency
        offset = stamp + latency - time.monotonic()
        late = _JUMP + self._link.jitter + self._link.silence
        if self._offset is None or offset > self._offset:
            if self._offset is not None and offset > self._offset + _JUMP:
                self.restarted = True
            self._offset = offset
        elif offset < self._offset - late and stamp < self.now - late:
            self.restarted = True

    def _deliver(self) -> None:
        for message in self._down.due(self.now):
            self._take(message)
        for vessel in self._receiver.receive() if self._receiver else ():
            self._hear_of(self.now - vessel.age, vessel)

    def _hear_of(self, true_at: float, vessel: VesselState) -> None:
        """Store a vessel's report, valid at a time [s], unless a newer one has arrived."""
        known = self._lockstep or self._offset is not None
        last = self.vessels.get(vessel.mmsi)
        if known and (last is None or true_at > last[0]):
            self.vessels[vessel.mmsi] = true_at, vessel
            self.on_vessel(true_at, vessel)

    def _take(self, message: Any) -> None:
        match message.get_type():
            case "HEARTBEAT":
                self.kind, self.autopilot = message.type, message.autopilot
                self.mode = message.custom_mode
            case "PARAM_VALUE":
                self.parameters[message.param_id.rstrip("\0")] = message.param_value
            case "COMMAND_ACK":
                self.acknowledged[message.command] = message.result
            case "ATTITUDE":
                angles = message.roll, message.pitch, message.yaw
                rates = message.rollspeed, message.pitchspeed, message.yawspeed
                if all(map(math.isfinite, (*angles, *rates))):
                    self._attitude = message
            case "VFR_HUD":
                if math.isfinite(message.airspeed) and message.airspeed >= 0.0:
                    self._hud = message
            case "GLOBAL_POSITION_INT":
                self._place(message)
            case "AIS_VESSEL":
                vessel = VesselState.of(message)
                if vessel is not None and self._receiver is None:
                    self._hear_of(self.now - self._link.latency - vessel.age, vessel)

    def _place(self, message: Any) -> None:
        """Store a position, which completes the state; 0/0 is not a position."""
        attitude, hud = self._attitude, self._hud
        if attitude is None or hud is None or (message.lat == 0 and message.lon == 0):
            return
        stamp = 1e-3 * message.time_boot_ms
        if self.state is not None and stamp < self.state.time:
            # A newer position has arrived before it.
            return
        rates = attitude.rollspeed, attitude.pitchspeed, attitude.yawspeed
        # The last attitude may be older than the place: one was lost, or sent at another time.
        older = min(_ATTITUDE_AGE, max(-_ATTITUDE_AGE, stamp - 1e-3 * attitude.time_boot_ms))
        turned = older * euler_rates(rates, attitude.roll, attitude.pitch)[2]
        self.state = AircraftState(
            time=stamp,
            latitude=from_degrees_e7(message.lat),
            longitude=from_degrees_e7(message.lon),
            altitude=1e-3 * message.alt,
            height=1e-3 * message.relative_alt,
            velocity_north=0.01 * message.vx,
            velocity_east=0.01 * message.vy,
            climb=-0.01 * message.vz,
            roll=attitude.roll,
            pitch=attitude.pitch,
            yaw=attitude.yaw + turned,
            rates=rates,
            airspeed=hud.airspeed,
            throttle=0.01 * hud.throttle,
        )
