"""A flight of a scenario on a vehicle over MAVLink: the checks before it, the takeover of the
vehicle, and the flight itself, with the record of a study's flight.
"""

import math
import signal
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from common.columns import Table
from common.geodesy import LocalFrame
from common.physics import bank_for_heading_rate
from common.run_layout import SUMMARY, TRAFFIC
from extensions.companion.fields import equivalent_over_true
from extensions.companion.plane import PlaneMode
from extensions.companion.ports import Line
from extensions.companion.quality import Link
from extensions.companion.remote_vehicle import (
    COURSE,
    COURSE_INTERVAL,
    SILENT_AFTER,
    Limits,
    RemoteVehicle,
)
from extensions.companion.reported_ships import Antenna, OtherShips, ReceivedPlume, ReceivedVessel
from extensions.companion.sniffer_line import ReceivedSniffer
from extensions.companion.vehicle_link import VehicleLink
from gnc.estimation.health import Fault
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import ReachableSet, ReportedTarget, Tube, VesselReport
from gnc.guidance import ReportedVessel
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.errors import InputError
from scenarios.experiment.requests import FlightRequest
from scenarios.flight.closed_loop import ClosedLoop, record_of
from scenarios.flight.record import FlightRecord
from scenarios.flight.traffic_belief import TrafficBelief
from scenarios.flight_runner import (
    FlightRunner,
    Flown,
    history_columns,
    payload_of,
)
from scenarios.instruments.instrument import EvaluatedInstrument, GasReader, Instrument
from scenarios.measures.columns import TRAFFIC_COLUMNS, TRAFFIC_FIGURES
from scenarios.planning.flight_plan import FlightPlan, Start
from scenarios.planning.missions import check_start
from scenarios.planning.traffic import check_start_beside
from scenarios.scenario.sections.equipment import SensorsConfig
from scenarios.studies.base import SingleFlight
from scenarios.vehicles.sensors import SensorErrors
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.ais.size import ShipSize
from scenarios.world.ais.track import AT_THE_FUNNEL
from scenarios.world.faults import NO_FAULT
from scenarios.world.traffic import radius_kept
from scenarios.world.vessel import Place

_NEEDED = {
    "roll limit [deg]": ("ROLL_LIMIT_DEG", "LIM_ROLL_CD"),
    "least airspeed [m/s]": ("AIRSPEED_MIN", "ARSPD_FBW_MIN"),
    "greatest airspeed [m/s]": ("AIRSPEED_MAX", "ARSPD_FBW_MAX"),
}
"""Parameters that every vehicle must report, by their meaning: the present name, and the former
one.
"""

SNIFFER = "sniffer"
"""The instrument whose readings may come on a line."""

RIVALS_SEEN_IN, _RIVALS_LOOK = 1.2, 0.02
"""Time of waiting for other companions before a takeover, and interval of the checks [s]."""

_LOITER_RADIUS, _GUIDED_TIMEOUT, _GUIDED_P = "WP_LOITER_RAD", "GUIDED_TIMEOUT", "GUIDED_P"
_DEFAULTS = {_LOITER_RADIUS: 60.0, _GUIDED_TIMEOUT: 3.0, _GUIDED_P: 5000.0}
"""Parameters that not every vehicle reports, with ArduPlane's values [m, s, 0.01 deg/rad]."""

_ROUNDING = 2e-3
"""Largest shortfall of a limit of the vehicle, for rounding [-]."""

_PATIENCE = 10.0
"""Time within which a vehicle reports its parameters [s]."""

_REQUEST_INTERVAL, _LOOK = 1.0, 0.1
"""Time between requests, and between checks for new messages [s]."""

_FRESH = 1.5
"""Largest age of a present place, over the time step of the guidance [-]."""

_VELOCITY_MAX = 0.3
"""Largest difference of a vessel's velocity from that of the scenario's steady vessel [m/s]."""

_ROUNDED = 2.0
"""Largest excess of a reported size over the scenario's [m]: both of its parts are rounded."""

_STREAMS = (
    mavlink.MAVLINK_MSG_ID_ATTITUDE,
    mavlink.MAVLINK_MSG_ID_VFR_HUD,
    mavlink.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
)

Say = Callable[[str], None]


@dataclass(frozen=True, slots=True, kw_only=True)
class TakenOver:
    """A vehicle that has been taken over.

    Attributes
    ----------
    vehicle, plan : the vehicle, and the flight from where it is
    track : track of the measured vessel, or None for a flight without a vessel
    others : the other ships, or None where the guidance does not use them
    """

    vehicle: RemoteVehicle
    plan: FlightPlan
    track: ReceivedVessel | None
    others: OtherShips | None


@dataclass(frozen=True, kw_only=True)
class Companion:
    """A companion that flies a vehicle over a link, and its settings.

    Attributes
    ----------
    link, quality : link to the vehicle, and its declared quality
    by : ``ATTITUDE`` or ``COURSE``
    lockstep : whether the vehicle's clock waits
    mmsi : of the vessel; None for the only one
    patience : longest wait for a vehicle, for a vessel and for GUIDED [s]
    sniffer : line with its readings, or None
    say : shows a message to the user
    """

    link: VehicleLink
    quality: Link
    by: str
    lockstep: bool
    mmsi: int | None
    patience: float
    sniffer: Line | None = None
    say: Say

    # ------------------------------------------------------------ before the flight

    def meet(self) -> None:
        """Wait for a vehicle, and learn its parameters.

        Raises
        ------
        InputError : there is no vehicle, it is of another type, or it does not report what is
            needed
        """
        link = self.link
        self.say("waiting for a vehicle")
        self._wait(lambda: link.kind != 0, self.patience, "no heartbeat of a vehicle was received")
        if link.kind != mavlink.MAV_TYPE_FIXED_WING:
            raise InputError(
                f"the vehicle is of MAV_TYPE {link.kind}; fixed wings (MAV_TYPE"
                f" {mavlink.MAV_TYPE_FIXED_WING}) can be flown"
            )
        if link.autopilot != mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA:
            raise InputError(
                f"the vehicle's autopilot is MAV_AUTOPILOT {link.autopilot}; GUIDED of ArduPlane"
                f" (MAV_AUTOPILOT {mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA}) is needed"
            )
        self.say(f"vehicle {link.system}: fixed wing, ArduPilot, mode {link.mode}")
        for names in [*_NEEDED.values(), *((name,) for name in _DEFAULTS)]:
            for name in names:
                link.request_parameter(name)

        def known() -> bool:
            parameters = link.parameters
            return all(any(name in parameters for name in names) for names in _NEEDED.values())

        self._wait(
            known, _PATIENCE, "the vehicle does not report its limits", again=self._request_limits
        )

    def _request_limits(self) -> None:
        for names in _NEEDED.values():
            for name in names:
                if name not in self.link.parameters:
                    self.link.request_parameter(name)

    def _wait(
        self,
        there: Callable[[], bool],
        patience: float,
        missing: str,
        again: Callable[[], None] = lambda: None,
    ) -> None:
        """Wait for something.

        In lockstep, a vehicle that has reached a time has reported everything up to it. Its clock
        advances only if that is necessary, so that a flight always begins at the same step.
        """
        link, waited, requested = self.link, 0.0, 0.0
        while not there():
            before = link.now
            link.advance(link.now if self.lockstep and not waited else link.now + _LOOK, there)
            waited += max(link.now - before, 0.5 * _LOOK)
            self._refuse_rival()
            if waited > patience or link.gone:
                raise InputError(f"{missing} in {patience:g} s; check --connect and the vehicle")
            if waited - requested > _REQUEST_INTERVAL:
                requested = waited
                again()

    def _refuse_rival(self) -> None:
        if self.link.rival is not None:
            system, component = self.link.rival
            raise InputError(
                f"another companion ({system}/{component}) is on the link; one can fly a"
                " vehicle: end the other one"
            )

    def _listen_for_rivals(self) -> None:
        """Refuse a vehicle that another companion flies. That companion announces itself once a
        second of real time, even if the vehicle's clock waits.
        """
        until = time.monotonic() + RIVALS_SEEN_IN
        while time.monotonic() < until:
            self.link.advance(self.link.now)
            self._refuse_rival()
            time.sleep(_RIVALS_LOOK)

    def _parameter(self, *names: str) -> float:
        parameters = self.link.parameters
        name = next(each for each in names if each in parameters or each in _DEFAULTS)
        value = parameters.get(name, _DEFAULTS.get(name, math.nan))
        return 0.01 * value if name == "LIM_ROLL_CD" else value

    def check_limits(self, setup: VehicleSetup, heading_rate_max: float, altitude: float) -> None:
        """Refuse a vehicle whose limits are narrower than the range of the guidance's commands.

        Raises
        ------
        InputError : they are narrower"""
        ratio = equivalent_over_true(altitude)
        roll, slowest, fastest = (self._parameter(*names) for names in _NEEDED.values())
        turning = min(setup.airspeed_max, setup.turning_airspeed(heading_rate_max))
        bank = math.degrees(bank_for_heading_rate(heading_rate_max, turning))
        if roll < (1.0 - _ROUNDING) * bank:
            raise InputError(
                f"the vehicle's ROLL_LIMIT_DEG is {roll:.1f} deg; the guidance banks up to"
                f" {bank:.1f} deg: lower guidance.bank_deg, or raise the limit"
            )
        least, most = ratio * setup.airspeed_min, ratio * setup.airspeed_max
        if slowest > (1.0 + _ROUNDING) * least or fastest < (1.0 - _ROUNDING) * most:
            raise InputError(
                f"the vehicle flies at {slowest:.1f} to {fastest:.1f} m/s (AIRSPEED_MIN,"
                f" AIRSPEED_MAX); the guidance commands {least:.1f} to {most:.1f} m/s: they have to"
                " lie within"
            )

    def on_link(self, setup: VehicleSetup, request: FlightRequest) -> VehicleSetup:
        """Return what a flight needs of its vehicle, with the link between them.

        The dead time delays every turn. If a command arrives even later, the vehicle flies on
        towards the vessel in the meantime, at most at the sum of both speeds through the air.
        """
        scenario = request.scenario
        dead = self.dead_time
        late = self.quality.late(1.0 / scenario.guidance.rate_hz, scenario.flight.duration_max_s)
        closing = scenario.guidance.airspeed_mps * (1.0 + scenario.following.speed_ratio_max)
        return replace(
            setup,
            lag=setup.lag + dead,
            reversal=replace(setup.reversal, delay=setup.reversal.delay + dead),
            response_error=setup.response_error + closing * late,
            # Accelerations are not read.
            thrust=None,
            meets_ships=True,
        )

    @property
    def dead_time(self) -> float:
        """Time from a measurement until its command is flown, beyond the vehicle's own [s]."""
        return self.quality.dead_time + (0.5 * COURSE_INTERVAL if self.by == COURSE else 0.0)

    # ------------------------------------------------------------ taking over

    def take_over(
        self, plan: FlightPlan, recalled: Callable[[], bool], *, other_radius: float
    ) -> TakenOver:
        """Wait until the vehicle is in GUIDED; return it with the plan of the flight from where it
        is, and the ships that will report themselves.

        Parameters
        ----------
        plan, recalled : the flight, and a function that returns whether the user has recalled the
            vehicle
        other_radius : radius to keep from ships other than the measured one [m]

        Raises
        ------
        InputError : the vessel or the vehicle's place is not known in time, or does not fit
        """
        link, interval = self.link, 1e6 * plan.time_step
        for number in _STREAMS:
            link.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, interval)
        link.advance(link.now)
        self._wait(
            lambda: link.state is not None, self.patience, "the vehicle reports no place but 0/0"
        )
        if plan.world is not None:
            self._wait(
                lambda: bool(self._vessels()), self.patience, "no report of the vessel was received"
            )
        self._listen_for_rivals()
        self.say(f"waiting for GUIDED, in mode {link.mode}")
        self._wait(
            lambda: link.mode == PlaneMode.GUIDED or recalled(),
            self.patience,
            "the vehicle was not in GUIDED",
        )
        if recalled():
            raise InputError("given back on request, before the vehicle was in GUIDED")
        fresh = _FRESH * plan.time_step
        self._wait(
            lambda: (
                self.lockstep or (link.state is not None and link.now - link.state.time < fresh)
            ),
            _PATIENCE,
            f"the vehicle did not report its place every {plan.time_step:g} s",
        )
        assert link.state is not None
        began = link.now if self.lockstep else link.state.time
        frame, mmsi = self._frame(plan, began)
        hull = plan.world.hull if plan.world is not None else None
        vehicle = RemoteVehicle(
            link,
            frame,
            self._limits(plan),
            began=began,
            time_step=plan.time_step,
            altitude=plan.altitude,
            by=self.by,
            lockstep=self.lockstep,
            antenna=Antenna(AT_THE_FUNNEL if hull is None else hull.antenna_offset),
            recalled=recalled,
        )
        track, others = None, _others_of(plan, other_radius)
        if mmsi is not None:
            track = ReceivedVessel()
            track.report(vehicle.measured(*link.vessels[mmsi]))
            self._check_vessel(plan, track)
            self._check_size(plan, mmsi)
            self._check_alone(mmsi, others)
            vehicle.listen(mmsi, track.report, others)
        plan = self._from_here(plan, vehicle, frame, track)
        if others is not None:
            plan = self._beside(plan, others)
        link.degrade()
        self.say("GUIDED: flying")
        return TakenOver(vehicle=vehicle, plan=plan, track=track, others=others)

    def _vessels(self) -> list[int]:
        numbers = list(self.link.vessels)
        if self.mmsi is not None:
            return [self.mmsi] if self.mmsi in numbers else []
        return numbers

    def _frame(self, plan: FlightPlan, began: float) -> tuple[LocalFrame, int | None]:
        """Return the frame of the flight, whose origin is where its vessel is at the start, and the
        vessel's number; without a vessel, the vehicle is where the plan begins.
        """
        height, state = plan.source_height, self.link.state
        assert state is not None
        if plan.world is None:
            here = LocalFrame(state.latitude, state.longitude, height)
            origin = here.to_geodetic(-plan.start.north, -plan.start.east)
            return LocalFrame(float(origin[0]), float(origin[1]), height), None
        numbers = self._vessels()
        if len(numbers) > 1:
            names = ", ".join(map(str, sorted(numbers)[:5]))
            raise InputError(
                f"{len(numbers)} vessels report themselves ({names}); choose one by --mmsi"
            )
        at, vessel = self.link.vessels[numbers[0]]
        there = LocalFrame(vessel.latitude, vessel.longitude, height)
        since = began - at
        origin = there.to_geodetic(vessel.velocity_north * since, vessel.velocity_east * since)
        return LocalFrame(float(origin[0]), float(origin[1]), height), numbers[0]

    def _limits(self, plan: FlightPlan) -> Limits:
        return Limits(
            heading_rate_max=plan.heading_rate_max,
            keepout_radius=plan.keepout_radius + (plan.margin.total if plan.margin else 0.0),
            loiter_radius=max(
                abs(self._parameter(_LOITER_RADIUS)),
                1.5 * plan.guidance.speed / plan.heading_rate_max,
            ),
            roll_max=math.radians(self._parameter("ROLL_LIMIT_DEG", "LIM_ROLL_CD")),
            gain=math.radians(0.01 * self._parameter(_GUIDED_P)),
            dead_time=self.quality.dead_time,
            lag=max(0.0, plan.guidance.tracking.lag - self.dead_time),
            wait=self.quality.wait,
            silent_after=max(SILENT_AFTER, self.quality.silence),
            guided_timeout=self._parameter(_GUIDED_TIMEOUT),
        )

    def _check_vessel(self, plan: FlightPlan, track: ReceivedVessel) -> None:
        """Refuse a vessel that differs from the known vessel of a scenario."""
        if isinstance(plan.guidance.vessel, ReportedVessel):
            return
        reported, known = track.motion(0.0)[2:], plan.guidance.vessel
        off = math.hypot(reported[0] - known[0], reported[1] - known[1])
        if off > _VELOCITY_MAX:
            raise InputError(
                f"the vessel reports {math.hypot(*reported):.1f} m/s, {off:.1f} m/s off the"
                " velocity that this scenario knows; fly one that learns it: set reports.interval_s"
            )

    def _check_alone(self, mmsi: int, others: OtherShips | None) -> None:
        """Refuse other ships in a scenario whose guidance does not use them."""
        besides = len(self.link.vessels) - 1
        if others is None and besides:
            raise InputError(
                f"{besides} ships report themselves besides the vessel {mmsi}, and this scenario"
                " keeps off none of them: fly one that learns its vessel: set reports.interval_s"
            )

    def _check_size(self, plan: FlightPlan, mmsi: int) -> None:
        """Refuse a ship whose reported size is larger than that of the scenario."""
        said = self.link.vessels[mmsi][1].size
        if said is None or plan.world is None:
            return
        self.say(f"vessel {mmsi}: {said.described()}")
        hull = plan.world.hull
        if hull is None:
            # Its outline is then assumed about the place that it reports.
            if _reach(said) >= plan.keepout_radius:
                raise InputError(
                    f"the vessel says that it is {said.described()}; its hull reaches"
                    f" {_reach(said):.0f} m from there, as far as the"
                    f" {plan.keepout_radius:g} m that are kept: set vessel.length_m,"
                    " vessel.beam_m and keepout.from=hull"
                )
        elif max((said.length or 0.0) - hull.length, (said.beam or 0.0) - hull.beam) > _ROUNDED:
            raise InputError(
                f"the vessel says that it is {said.described()}, larger than the scenario's"
                f" {hull.length:g} m by {hull.beam:g} m: set vessel.length_m and vessel.beam_m"
            )
        elif said.to_bow is not None and said.to_port is not None:
            from_bow, from_port = hull.antenna
            if math.hypot(said.to_bow - from_bow, said.to_port - from_port) > _ROUNDED:
                raise InputError(
                    f"the vessel says that its antenna is {said.to_bow:g} m from the bow and"
                    f" {said.to_port:g} m from the port side; the scenario has it at"
                    f" {from_bow:g} m and {from_port:g} m: set vessel.antenna_from_bow_m and"
                    " vessel.antenna_from_port_m"
                )

    def _from_here(
        self,
        plan: FlightPlan,
        vehicle: RemoteVehicle,
        frame: LocalFrame,
        track: ReceivedVessel | None,
    ) -> FlightPlan:
        """Return the plan from the vehicle's place, with the received track as the true one."""
        motion, world = vehicle.motion(), plan.world
        _, heading, _ = vehicle.air_data()
        start = Start(north=motion.north, east=motion.east, course=heading)
        if world is None or track is None:
            return replace(plan, start=start)
        vessel = plan.guidance.vessel
        if isinstance(vessel, ReportedVessel):
            known = ReachableSet(vessel.limits)
            north, east, v_north, v_east = track.motion(0.0)
            known.report(VesselReport(0.0, north, east, v_north, v_east))
            tubes = list(known.tubes(0.0))
        else:
            tubes = [Tube(0.0, 0.0, 0.0, *vessel)]
        vessel_north, vessel_east, *_ = track.motion(0.0)
        distance = math.hypot(motion.north - vessel_north, motion.east - vessel_east)
        if distance < plan.keepout_radius:
            raise InputError(
                f"the vehicle is {distance:.0f} m from the vessel, inside the keep-out area of"
                f" {plan.keepout_radius:g} m; lead it out before GUIDED"
            )
        check_start(
            start,
            plan.guidance.guard,
            tubes,
            wind=world.weather.wind.now(0.0, plan.altitude),
            airspeed=plan.guidance.speed,
            keepout_radius=plan.keepout_radius,
        )
        latitude, longitude = (float(each) for each in frame.to_geodetic(0.0, 0.0))
        place = Place(
            latitude=latitude,
            longitude=longitude,
            altitude=plan.source_height,
            utc=world.place.utc,
        )
        if plan.sensing is None:
            return replace(plan, start=start, world=replace(world, place=place))
        exact = SensorErrors(
            SensorsConfig(),
            steps=round(plan.duration_max / plan.time_step) + 2,
            time_step=plan.time_step,
            generator=np.random.default_rng(0),
        )
        return replace(
            plan,
            start=start,
            world=replace(
                world,
                place=place,
                exhaust=None,
                vessel=track,
                plume=ReceivedPlume(track, self._plume_heading(plan)),
            ),
            # Readings are the telemetry with its errors; reports come over the link.
            sensing=replace(plan.sensing, errors=exact, received=[]),
        )

    def _beside(self, plan: FlightPlan, others: OtherShips) -> FlightPlan:
        """Return the plan with the ships that report their positions in place of the scenario's
        ships.

        Raises
        ------
        InfeasibleError : no turn away from the start keeps off one of them
        """
        guidance, world, start = plan.guidance, plan.world, plan.start
        if world is None or guidance.traffic is None or plan.sensing is None:
            return plan
        known = replace(guidance.traffic, vessels=others.vessels)
        wind_north, wind_east = world.weather.wind.now(0.0, plan.altitude)
        check_start_beside(
            start,
            guidance.guard,
            known,
            others.ships,
            [[(of.time, of) for of in reports] for reports in others.reports],
            AirMotion(
                ground_north=start.north,
                ground_east=start.east,
                course=start.course,
                wind_north=wind_north,
                wind_east=wind_east,
            ),
            airspeed=guidance.speed,
        )
        return replace(
            plan,
            # The guidance gets them from their reports.
            guidance=replace(guidance, traffic=replace(known, vessels=())),
            world=replace(world, traffic=others.ships),
            sensing=replace(plan.sensing, traffic=()),
        )

    @staticmethod
    def _plume_heading(plan: FlightPlan) -> float | None:
        centre = getattr(plan.guidance.mission, "centre", None)
        heading: float | None = getattr(centre, "plume_heading", None)
        return heading


def _others_of(plan: FlightPlan, radius: float) -> OtherShips | None:
    """Return the other ships of a flight, all of them still unknown; None where the guidance does
    not use them.

    The scenario does not give the MMSI of its ships, so the largest of their radii is kept from
    each of them.
    """
    traffic, vessel = plan.guidance.traffic, plan.guidance.vessel
    if traffic is None or not isinstance(vessel, ReportedVessel):
        return None
    radii = [of.radius for of in traffic.vessels]
    return OtherShips(max([radius, *radii]), vessel.limits)


def _reach(size: ShipSize) -> float:
    """Return the largest distance of a hull's edge from its antenna, from the reported size [m]."""
    ways = []
    for said, before in ((size.length, size.to_bow), (size.beam, size.to_port)):
        whole = said or 0.0
        ways.append(whole if before is None else max(before, whole - before))
    return math.hypot(*ways)


@contextmanager
def _recall() -> Iterator[Callable[[], bool]]:
    """Yield a function that returns whether Ctrl-C or SIGTERM has recalled the vehicle; a second
    signal ends the program.
    """
    requested = threading.Event()
    kinds = (signal.SIGINT, signal.SIGTERM)

    def request(*_: Any) -> None:
        if requested.is_set():
            raise KeyboardInterrupt
        requested.set()

    if threading.current_thread() is not threading.main_thread():
        yield requested.is_set
        return
    before = [signal.signal(kind, request) for kind in kinds]
    try:
        yield requested.is_set
    finally:
        for kind, handler in zip(kinds, before, strict=True):
            signal.signal(kind, handler)


@dataclass(frozen=True, kw_only=True)
class CompanionRunner(FlightRunner):
    """Flies the flight of a scenario on a vehicle over a link; otherwise as ``FlightRunner``.

    Attributes
    ----------
    companion : that flies it
    """

    companion: Companion

    def setup_of(self, request: FlightRequest) -> VehicleSetup:
        """Return the flight's setup of its vehicle, including the link to it."""
        return self.companion.on_link(super().setup_of(request), request)

    def fly(self, request: FlightRequest, plan: FlightPlan, *, every_step: bool) -> Flown:
        """Return a planned flight, flown on the vehicle."""
        with _recall() as recalled:
            taken = self.companion.take_over(
                plan, recalled, other_radius=radius_kept(request.scenario)
            )
            vehicle, plan = taken.vehicle, taken.plan
            sniffer = self._sniffer(request)
            instruments: list[Instrument | EvaluatedInstrument] = (
                [sniffer] if sniffer else payload_of(request, plan)
            )

            def fly(payload: list[Instrument], reader: GasReader | None) -> FlightRecord:
                loop = ClosedLoop(plan, vehicle, payload, reader=reader, every_step=every_step)
                self._connect(loop, taken)
                return _record(loop, vehicle, sniffer)

            flown = Flown.by(fly, request, plan, instruments, every_step=every_step)
            vehicle.give_back("the flight is over")
        self.companion.say(f"given back: {vehicle.given_back}")
        if vehicle.extrapolated:
            self.companion.say(f"steps without telemetry of their own: {vehicle.extrapolated}")
        if sniffer and sniffer.unreadable:
            self.companion.say(f"lines of the sniffer that were no readings: {sniffer.unreadable}")
        return flown

    @cached_property
    def columns(self) -> Table:
        """Units and meanings of the columns of time histories: any flight may meet other ships."""
        return {**history_columns(self.experiments), **TrafficBelief.COLUMNS}

    def _sniffer(self, request: FlightRequest) -> ReceivedSniffer | None:
        """Return the sniffer whose readings arrive on a line; None for a flight without one."""
        line = self.companion.sniffer
        return ReceivedSniffer(line, request.scenario) if line and _has_sniffer(request) else None

    @staticmethod
    def _connect(loop: ClosedLoop, taken: TakenOver) -> None:
        """Connect reports of ships to the guidance and to the record."""
        target, own = loop.guidance.target, loop.guidance.own
        plan, track = taken.plan, taken.track
        if taken.others is not None and loop.guidance.traffic is not None:
            taken.others.pass_on_to(loop.guidance.traffic)
        plume = plan.world.plume if plan.world else None
        if isinstance(plume, ReceivedPlume):
            plume.wind = lambda: (own.wind_north, own.wind_east)
        if not isinstance(target, ReportedTarget) or track is None:
            return
        target.report(VesselReport(0.0, *track.motion(0.0)))

        def report(of: VesselReport) -> None:
            track.report(of)
            target.report(of)

        taken.vehicle.pass_reports_to(report)


def _record(
    loop: ClosedLoop, vehicle: RemoteVehicle, sniffer: ReceivedSniffer | None
) -> FlightRecord:
    """Fly; the flight ends where the vehicle is given back.

    The vehicle is also given back if the guidance detects a fault, before the next command is
    flown. In a study the aircraft would glide to the sea; a real vehicle is left to its pilot and
    its failsafes.
    """
    monitor = loop.guidance.monitor
    steps = loop.steps()
    follow = steps.send
    try:
        commands = next(steps)
        while True:
            if monitor is not None and monitor.fault is not Fault.NONE:
                vehicle.give_back(f"{monitor.fault.value}, by the heading rate")
            loop.ending.given_back = vehicle.given_back
            if sniffer is not None:
                sniffer.receive(vehicle.time)
            commands = follow(commands)
    except StopIteration as over:
        return record_of(over)


class CompanionFlight(SingleFlight):
    """One flight of a study, flown on a vehicle over a link.

    Attributes
    ----------
    companion : that flies it; it is set before the flight
    """

    companion: Companion

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the flight."""
        companion = self.companion
        declared = {field.name: getattr(companion.quality, field.name) for field in fields(Link)}
        return super().initial_manifest() | {
            "companion": {
                "vehicle": "over MAVLink",
                "by": companion.by,
                "lockstep": companion.lockstep,
                "link": declared,
                "dead_time_s": companion.dead_time,
            }
        }

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables, with the other ships if the flight met any."""
        tables = self._study.tables
        if next(journal.rows(TRAFFIC), None) is not None:
            tables[SUMMARY] = tables[SUMMARY] | TRAFFIC_FIGURES
            tables[TRAFFIC] = dict(TRAFFIC_COLUMNS)
        super().export(run, journal)

    def work(self, run: RunDirectory) -> CompanionRunner:
        """Return the work on the flight.

        Raises
        ------
        InputError : the flight cannot be flown on this vehicle
        """
        work = super().work(run)
        if not isinstance(work, FlightRunner):
            raise InputError("this study has no flights that a companion could fly")
        parts = {field.name: getattr(work, field.name) for field in fields(FlightRunner)}
        runner = CompanionRunner(**parts, companion=self.companion)
        request = runner.request(self.task)
        check_flyable(request, sniffer_line=self.companion.sniffer is not None)
        plan = FlightRunner.plan(runner, request)
        if plan.sensing is not None and plan.sensing.received is None:
            raise InputError(
                "this scenario knows the vessel exactly at all times; over a link it is known by"
                " its reports: set reports.interval_s, as in --set reports.interval_s=[10,10]"
            )
        self.companion.check_limits(
            FlightRunner.setup_of(runner, request), plan.heading_rate_max, plan.altitude
        )
        return runner


def _has_sniffer(request: FlightRequest) -> bool:
    return request.scenario.payload.instruments == (SNIFFER,)


def check_flyable(request: FlightRequest, *, sniffer_line: bool) -> None:
    """Refuse a flight with parts that a study simulates, and that a vehicle does not have;
    ``sniffer_line`` says whether readings of a sniffer come on a line.

    Raises
    ------
    InputError : it has such parts
    """
    scenario = request.scenario
    for number, fault in enumerate(scenario.faults):
        if fault.kind != NO_FAULT.kind:
            key = scenario.fault_key(number, "kind")
            raise InputError(
                f"{key} is '{fault.kind}'; a companion makes nothing fail: set {key}=none"
            )
    if scenario.following.plume == "told":
        raise InputError(
            "following.plume is 'told', which only a simulation can; set predicted or estimated"
        )
    instruments = scenario.payload.instruments
    if instruments and not (sniffer_line and _has_sniffer(request)):
        raise InputError(
            f"payload.instruments has {', '.join(instruments)}, which a study simulates; a"
            " companion reads a sniffer on a line (--sniffer), and nothing else: set"
            " payload.instruments"
        )
    if sniffer_line and not instruments:
        raise InputError(
            '--sniffer: the scenario has no sniffer; set payload.instruments=["sniffer"]'
        )
