"""A vehicle over MAVLink in the closed loop of the study: it flies what the guidance commands as
long as its mode is GUIDED.

A step of the guidance belongs to a time of the vehicle's clock. It is computed once the telemetry
of that time has arrived, or after the declared time of the link; missing telemetry is extrapolated
from the last. So the loop has one constant dead time, for which guard and preview allow.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from aircraft.state import euler_rates
from common.geodesy import LocalFrame
from common.physics import STANDARD_GRAVITY, bank_for_heading_rate
from extensions.companion.fields import (
    AircraftState,
    VesselState,
    degrees_e7,
    equivalent_over_true,
    roll_target,
)
from extensions.companion.plane import PlaneMode
from extensions.companion.reported_ships import Antenna, OtherShips, Seen
from extensions.companion.vehicle_link import VehicleLink
from gnc.estimation.navigation import MeasuredMotion
from gnc.estimation.vessel import VesselReport

ATTITUDE, COURSE = "attitude", "course"
"""How heading rates are commanded: by roll, or by a heading."""

COURSE_INTERVAL = 0.1
"""Time between commanded headings [s]."""

_SPEED_CHANGE = 0.005
"""Change of the commanded airspeed below which it is not sent [m/s]."""

_REPEAT = 1.0
"""Time after which speed and altitude are sent again [s]: a message may be lost."""

_RETREAT_INTERVAL = 5.0
"""Time between renewals of the place to retreat to [s]."""

_LEAVING_GAIN = 1.0
"""Heading rate over the remaining angle to the course away [1/s]."""

_LEAVING_STEPS = 5
"""Least number of times that the command to leave is sent [-]: a message may be lost."""

SILENT_AFTER = 1.0
"""Shortest time without telemetry after which the vehicle is given back [s]."""

_STALE = 600.0
"""Age at which a report of another ship no longer determines its place [s]: ships at anchor report
every three minutes (ITU-R M.1371-5, table 1)."""

_BEARINGS = 36
"""Number of directions from the vessel in which the search for a place to retreat looks [-]."""

_DISTANCES = (1.0, 1.5, 2.0, 3.0)
"""Distances in that search, over the one to keep [-]: from ahead of the vessel a near place leads
past it."""

_SPARE_RADII = 2.0
"""Turn radii between the keep-out area and the circle of a retreat [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """The parameters of a flight that a companion needs.

    Attributes
    ----------
    heading_rate_max : omega_max [rad/s]
    keepout_radius : to keep in a retreat [m]
    loiter_radius : of the vehicle's loiter [m]
    roll_max : of the vehicle [rad]
    gain : of the roll by the vehicle's heading error, in ``COURSE`` [-]
    dead_time : from a measurement until its command arrives [s]
    lag : of the heading rate behind a command that has arrived [s]
    wait : time after which a measurement is used [s]
    silent_after : time without telemetry after which the vehicle is given back [s]
    guided_timeout : time for which the vehicle flies the last roll [s]
    """

    heading_rate_max: float
    keepout_radius: float
    loiter_radius: float
    roll_max: float
    gain: float
    dead_time: float
    lag: float
    wait: float
    silent_after: float
    guided_timeout: float


class RemoteVehicle:
    """A vehicle over MAVLink, as ``scenarios.vehicles.vehicle.Vehicle``.

    Parameters
    ----------
    link : to it
    frame : of north and east
    limits : of the flight
    began : time of the vehicle's clock at the first step [s]
    time_step : of the guidance [s]
    altitude : to hold [m]
    by : ``ATTITUDE`` or ``COURSE``
    lockstep : whether the vehicle's clock waits
    antenna : of the measured vessel
    recalled : returns whether the user has recalled the vehicle

    Attributes
    ----------
    given_back : why it takes no more commands, or an empty text
    worst_wait : longest time by which a step was late [s]
    extrapolated : number of steps whose telemetry is extrapolated
    """

    def __init__(
        self,
        link: VehicleLink,
        frame: LocalFrame,
        limits: Limits,
        *,
        began: float,
        time_step: float,
        altitude: float,
        by: str,
        lockstep: bool,
        antenna: Antenna,
        recalled: Callable[[], bool] = lambda: False,
    ) -> None:
        if link.state is None:
            raise ValueError("a vehicle without a state cannot be flown")
        self._link, self._frame, self._limits = link, frame, limits
        self._began, self._time_step = began, time_step
        self._by, self._lockstep, self._recalled = by, lockstep, recalled
        self._antenna = antenna
        self._state: AircraftState = link.state
        self._step = 0
        self._altitude, self._altitude_at = altitude, -math.inf
        self._wanted_altitude = altitude
        self._airspeed, self._airspeed_at = math.nan, -math.inf
        self._course_at, self._retreat_at = -math.inf, -math.inf
        self._rates: list[float] = []
        self._mmsi = 0
        self._others: OtherShips | None = None
        self._vessel: VesselReport | None = None
        self._held: list[tuple[float, VesselState]] = []
        self._report: Callable[[VesselReport], None] = lambda _: None
        self.given_back = ""
        self.worst_wait, self.extrapolated = 0.0, 0

    # ------------------------------------------------------------ what the guidance reads

    @property
    def _target(self) -> float:
        """Time of the step by the vehicle's clock [s]."""
        return self._began + self._step * self._time_step

    @property
    def time(self) -> float:
        """Time since the first step [s] of the data that are sent on board now."""
        return self._link.now - self._began

    def motion(self) -> MeasuredMotion:
        """Return the motion at the step, in the local frame."""
        state = self._state
        north, east = (
            float(each) for each in self._frame.to_local(state.latitude, state.longitude)
        )
        turned = float(self._frame.true_north(state.latitude, state.longitude))
        speed = math.hypot(state.velocity_north, state.velocity_east)
        course = math.atan2(state.velocity_east, state.velocity_north) + turned
        rate, ahead = self._heading_rate(), self._target - state.time
        # A vehicle that turns steadily flies a chord in the mean direction.
        mean, chord = course + 0.5 * rate * ahead, speed * ahead
        course += rate * ahead
        return MeasuredMotion(
            north + chord * math.cos(mean),
            east + chord * math.sin(mean),
            speed * math.cos(course),
            speed * math.sin(course),
            rate,
        )

    def _heading_rate(self) -> float:
        state = self._state
        return euler_rates(state.rates, state.roll, state.pitch)[2]

    def _heading(self) -> float:
        """Return the heading at the step, in the local frame [rad]."""
        state = self._state
        turned = float(self._frame.true_north(state.latitude, state.longitude))
        return state.yaw + turned + self._heading_rate() * (self._target - state.time)

    @property
    def _true_airspeed(self) -> float:
        return self._state.airspeed / equivalent_over_true(self._state.altitude)

    def air_data(self) -> tuple[float, float, float]:
        """Return true airspeed [m/s], heading and roll [rad]."""
        return self._true_airspeed, self._heading(), self._state.roll

    def engine(self) -> None:
        """Return None: accelerations are not read."""

    def sample(self) -> tuple[float, ...]:
        """Return ``SAMPLE_COLUMNS``; angles of the air and control surfaces are not reported."""
        state, unknown = self._state, math.nan
        return (
            state.altitude,
            self._true_airspeed,
            state.roll,
            state.climb,
            self._heading() % math.tau,
            state.pitch,
            unknown,
            unknown,
            unknown,
            unknown,
            state.throttle,
            unknown,
        )

    def servo_error(self) -> float:
        """Return 0: control surfaces are not reported."""
        return 0.0

    def hold_elevator(self) -> None:
        """Do nothing: the vehicle's own autopilot has the elevator."""

    def fail(self, name: str) -> None:
        """Raise ValueError: a companion cannot make parts of a vehicle fail."""
        raise ValueError(f"'{name}' of a vehicle over a link cannot be made to fail")

    def fault(self, sample: tuple[float, ...]) -> str:
        """Return an empty text as long as the telemetry has numbers: the vehicle watches itself."""
        return "" if math.isfinite(sum(sample[:6])) else "the telemetry is not a number"

    # ------------------------------------------------------------ the vessel

    def listen(
        self, mmsi: int, report: Callable[[VesselReport], None], others: OtherShips | None
    ) -> None:
        """Pass reports on from now on, each when the guidance has reached its time.

        Parameters
        ----------
        mmsi, report : of the measured vessel, and the receiver of its reports
        others : receiver of the reports of other ships, or None
        """
        self._mmsi, self._report, self._others = mmsi, report, others

        def take(at: float, vessel: VesselState) -> None:
            self._held.append((at, vessel))

        self._link.on_vessel = take
        for last in self._link.vessels.values():
            if last[1].mmsi == mmsi or self._link.now - last[0] < _STALE:
                take(*last)
        self._pass_reports_on()

    def pass_reports_to(self, report: Callable[[VesselReport], None]) -> None:
        """Pass the reports of the measured vessel on to this from now on."""
        self._report = report

    def measured(self, at: float, vessel: VesselState) -> VesselReport:
        """Return a report of the measured vessel, as one of its funnel; otherwise as ``_local``."""
        turned = float(self._frame.true_north(vessel.latitude, vessel.longitude))
        return self._antenna.funnel(self._local(at, vessel), vessel.bow + turned)

    def _local(self, at: float, vessel: VesselState) -> VesselReport:
        """Return a report in the local frame; its time is that since the first step."""
        north, east = (
            float(each) for each in self._frame.to_local(vessel.latitude, vessel.longitude)
        )
        turned = float(self._frame.true_north(vessel.latitude, vessel.longitude))
        cosine, sine = math.cos(turned), math.sin(turned)
        v_north, v_east = vessel.velocity_north, vessel.velocity_east
        return VesselReport(
            at - self._began,
            north,
            east,
            cosine * v_north - sine * v_east,
            sine * v_north + cosine * v_east,
        )

    def _pass_reports_on(self) -> None:
        due = [entry for entry in self._held if entry[0] <= self._target + 1e-3]
        self._held = [entry for entry in self._held if entry[0] > self._target + 1e-3]
        for entry in due:
            mmsi = entry[1].mmsi
            if mmsi == self._mmsi:
                self._vessel = self.measured(*entry)
                self._report(self._vessel)
            elif self._others is not None:
                motion = self.motion()
                self._others.report(mmsi, self._local(*entry), (motion.north, motion.east))

    # ------------------------------------------------------------ what the guidance commands

    def command_altitude(self, altitude: float, /) -> None:
        """Command an altitude [m] from the next step on, if that step is flown."""
        self._wanted_altitude = altitude

    def advance(self, heading_rate: float, airspeed: float) -> None:
        """Command a step [rad/s, m/s], and wait for the next one."""
        if not self.given_back:
            if self._by == ATTITUDE:
                # A heading is sticky: the vehicle would not fall back to the retreat, and a
                # DO_REPOSITION that comes after the heading's command would end that.
                self._renew_retreat()
            self._command_turn(heading_rate)
            self._command_airspeed(airspeed)
            self._command_altitude()
        self._next_step()
        self._judge_link()

    def _command_turn(self, heading_rate: float) -> None:
        bank = bank_for_heading_rate(heading_rate, self._true_airspeed)
        if self._by == ATTITUDE:
            self._link.send(
                roll_target(self._target, self._link.system, mavlink.MAV_COMP_ID_AUTOPILOT1, bank)
            )
            return
        coming = self._coming()
        under_way = round(self._limits.dead_time / self._time_step)
        self._rates = [*self._rates, heading_rate][-under_way:] if under_way else []
        if self._target - self._course_at < COURSE_INTERVAL - 1e-6:
            return
        self._course_at = self._target
        # The heading of the vehicle when the command arrives, its turn until the next one, and the
        # heading error that this bank needs.
        ahead = bank / self._limits.gain + 0.5 * COURSE_INTERVAL * heading_rate
        turned = float(self._frame.true_north(self._state.latitude, self._state.longitude))
        heading = math.degrees(self._heading() - turned + coming + ahead) % 360.0
        self._link.command(
            mavlink.MAV_CMD_GUIDED_CHANGE_HEADING,
            mavlink.HEADING_TYPE_HEADING,
            heading if heading < 359.9999 else 0.0,
            STANDARD_GRAVITY * math.tan(self._limits.roll_max),
        )

    def _coming(self) -> float:
        """Return the change of course that earlier commands cause until a present command arrives
        [rad].
        """
        rate, turned = self._heading_rate(), 0.0
        follows = 1.0 - math.exp(-self._time_step / self._limits.lag) if self._limits.lag else 1.0
        for command in self._rates:
            change = follows * (command - rate)
            turned += self._time_step * (rate + 0.5 * change)
            rate += change
        return turned

    def _command_airspeed(self, airspeed: float) -> None:
        equivalent = airspeed * equivalent_over_true(self._state.altitude)
        changed = not abs(equivalent - self._airspeed) <= _SPEED_CHANGE
        if changed or self._target - self._airspeed_at >= _REPEAT:
            self._airspeed, self._airspeed_at = equivalent, self._target
            self._link.command(
                mavlink.MAV_CMD_GUIDED_CHANGE_SPEED, mavlink.SPEED_TYPE_AIRSPEED, equivalent
            )

    def _command_altitude(self) -> None:
        if self._wanted_altitude != self._altitude:
            self._altitude, self._altitude_at = self._wanted_altitude, -math.inf
        if self._target - self._altitude_at >= _REPEAT:
            self._altitude_at = self._target
            self._link.command(mavlink.MAV_CMD_GUIDED_CHANGE_ALTITUDE, z=self._altitude)

    def _next_step(self) -> None:
        """Wait for the next step and its telemetry."""
        self._step += 1
        link, target = self._link, self._target
        if self._lockstep or self._limits.wait > 0.0:
            link.advance(target + self._limits.wait)
        else:
            fresh = target - 0.5 * self._time_step

            def there() -> bool:
                return link.state is not None and link.state.time >= fresh

            link.advance(target + self._time_step, there)
        self.worst_wait = max(self.worst_wait, link.now - target - self._limits.wait)
        if link.state is not None:
            self._state = link.state
        self.extrapolated += self._state.time < target - 0.5 * self._time_step
        self._pass_reports_on()

    # ------------------------------------------------------------ giving back

    def _judge_link(self) -> None:
        """Give the vehicle back if the companion may no longer fly it."""
        if self.given_back:
            return
        link = self._link
        silent = self._target - self._state.time
        if link.restarted:
            self.given_back = "the vehicle's clock jumped: it was restarted"
        elif link.mode != PlaneMode.GUIDED:
            self.given_back = f"the pilot took over (mode {_mode_name(link.mode)})"
        elif link.rival is not None:
            self.given_back = f"another companion ({link.rival[0]}/{link.rival[1]}) is on the link"
        elif link.gone:
            self.given_back = "the vehicle no longer answers"
        elif silent > self._limits.silent_after:
            self._leave(f"telemetry was silent for {silent:.1f} s")
        elif self._recalled():
            self._leave("given back on request")

    def give_back(self, reason: str) -> None:
        """Give the vehicle back for a reason, unless it has been given back before."""
        if not self.given_back:
            self._leave(reason)

    def _leave(self, reason: str) -> None:
        """Send the vehicle to its retreat, and turn it away until it flies there."""
        self.given_back = reason
        motion, link = self.motion(), self._link
        self._retreat_at = -math.inf
        course = math.atan2(motion.velocity_east, motion.velocity_north)
        away = course
        if self._vessel is not None:
            north, east = self._vessel_at(self._target)
            away = math.atan2(motion.east - east, motion.north - north)
        timeout = self._limits.guided_timeout if self._by == ATTITUDE else 0.0
        limit = self._limits.heading_rate_max
        for _ in range(max(_LEAVING_STEPS, round(timeout / self._time_step))):
            self._renew_retreat(always=True)
            if self._by == ATTITUDE:
                rate = _LEAVING_GAIN * math.remainder(away - course, math.tau)
                rate = min(limit, max(-limit, rate))
                course += rate * self._time_step
                self._command_turn(rate)
            self._next_step()
            if link.mode != PlaneMode.GUIDED or link.restarted or link.gone:
                return

    def _vessel_at(self, time: float) -> tuple[float, float]:
        """Return the vessel's place from its last report, at a time of the vehicle's clock [m]."""
        assert self._vessel is not None
        since = time - self._began - self._vessel.time
        return (
            self._vessel.north + since * self._vessel.velocity_north,
            self._vessel.east + since * self._vessel.velocity_east,
        )

    def _renew_retreat(self, *, always: bool = False) -> None:
        """Send the place at which the vehicle loiters when commands stop."""
        due = always or self._target - self._retreat_at >= _RETREAT_INTERVAL
        if self._vessel is None or not due:
            return
        self._retreat_at = self._target
        report, motion = self._vessel, self.motion()
        vessel = self._vessel_at(self._target)
        north, east = retreat(
            (motion.north - vessel[0], motion.east - vessel[1]),
            (report.velocity_north, report.velocity_east),
            keep=self._limits.keepout_radius + _SPARE_RADII * self._limits.loiter_radius,
            speed=math.hypot(motion.velocity_north, motion.velocity_east),
            others=self._others.seen(self._target - self._began, vessel) if self._others else (),
            spare=_SPARE_RADII * self._limits.loiter_radius,
        )
        latitude, longitude = self._frame.to_geodetic(north + vessel[0], east + vessel[1])
        self._link.command(
            mavlink.MAV_CMD_DO_REPOSITION,
            -1.0,
            0.0,
            self._limits.loiter_radius,
            0.0,
            x=degrees_e7(float(latitude)),
            y=degrees_e7(float(longitude)),
            z=self._altitude,
        )


def retreat(
    own: tuple[float, float],
    vessel: tuple[float, float],
    *,
    keep: float,
    speed: float,
    others: Sequence[Seen] = (),
    spare: float = 0.0,
) -> tuple[float, float]:
    """Return a place to loiter without commands, north and east of the vessel [m].

    It is beside the tracks of all ships, or behind them, so that they do not come to it, and the
    straight way to it keeps as far from them as possible. Where other ships leave no such place, it
    is one to which the vessel does not come.

    Parameters
    ----------
    own : place of the vehicle from the vessel, north and east [m]
    vessel : velocity of the vessel [m/s]
    keep : distance of the place from the vessel and its track [m]
    speed : of the vehicle over the ground [m/s]
    others, spare : other ships as seen from the vessel, and the distance kept in addition to their
        radius [m]
    """
    ships = [Seen(0.0, 0.0, *vessel, keep)]
    ships += [other._replace(radius=other.radius + spare) for other in others]
    best, found = (False, -math.inf), own
    for k, factor in itertools.product(range(_BEARINGS), _DISTANCES):
        bearing, distance = math.tau * k / _BEARINGS, factor * keep
        place = distance * math.cos(bearing), distance * math.sin(bearing)
        if _comes_to(ships[0], place):
            continue
        free = not any(_comes_to(other, place) for other in ships[1:])
        way = math.hypot(place[0] - own[0], place[1] - own[1])
        nearer = max(_nearer(ship, own, place, way / max(speed, 1.0)) for ship in ships)
        # The shorter of ways that are equally far off.
        worth = free, -nearer - 1e-3 * way
        if worth > best:
            best, found = worth, place
    return found


def _comes_to(ship: Seen, place: tuple[float, float]) -> bool:
    """Return whether a ship on its course comes nearer to a place than its radius."""
    north, east = place[0] - ship.north, place[1] - ship.east
    speed = math.hypot(ship.velocity_north, ship.velocity_east)
    radius = (1.0 - 1e-6) * ship.radius
    if speed > 0.0:
        ahead = (north * ship.velocity_north + east * ship.velocity_east) / speed
        if ahead > 0.0:
            across = abs(north * ship.velocity_east - east * ship.velocity_north) / speed
            return across < radius
    return math.hypot(north, east) < radius


def _nearer(ship: Seen, own: tuple[float, float], place: tuple[float, float], time: float) -> float:
    """Return the largest intrusion into a ship's radius on the straight way to a place, which takes
    a time [s]; 0 without one [m].
    """
    # Relative to the ship, the place has fallen back by the end.
    start = own[0] - ship.north, own[1] - ship.east
    end = (
        place[0] - ship.north - ship.velocity_north * time,
        place[1] - ship.east - ship.velocity_east * time,
    )
    return ship.radius - min(_nearest(start, end), ship.radius)


def _nearest(start: tuple[float, float], end: tuple[float, float]) -> float:
    """Return the least distance of a straight line from the origin."""
    along = end[0] - start[0], end[1] - start[1]
    squared = along[0] ** 2 + along[1] ** 2
    share = 0.0
    if squared > 0.0:
        share = min(1.0, max(0.0, -(start[0] * along[0] + start[1] * along[1]) / squared))
    return math.hypot(start[0] + share * along[0], start[1] + share * along[1])


def _mode_name(number: int) -> str:
    names: dict[int, Any] = {int(mode): mode.name for mode in PlaneMode}
    return str(names.get(number, number))
