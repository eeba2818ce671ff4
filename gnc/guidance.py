"""The outer loop: from what is measured to commanded heading rate, airspeed and altitude."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from gnc.airspeed import AirspeedLaw
from gnc.estimation.health import HealthMonitor, HealthParameters
from gnc.estimation.navigation import (
    EstimatedNavigation,
    NavigationParameters,
    OwnMotion,
    TrueNavigation,
)
from gnc.estimation.traffic import OtherVessel, Traffic
from gnc.estimation.vessel import (
    FilterParameters,
    ReachableSet,
    ReportedTarget,
    SteadyTarget,
    TargetMotion,
    Tube,
    VesselFilter,
    VesselLimits,
)
from gnc.guard.guard import Demand, GuardParameters, GuardStatus, KeepoutGuard, SpeedRange
from gnc.mission.follow import FollowingParameters, PlumeFollowing
from gnc.mission.mission import FAULTY, TRACK, Mission, Mode, Order
from gnc.mission.standoff import StandoffOrbit, StandoffParameters
from gnc.mission.track import DirectParameters, DirectTracking
from gnc.mission.yielding import HORIZON, Yielding, YieldParameters
from gnc.numeric import limited
from gnc.tracker import TrackingParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportedVessel:
    """A vessel that is known from its reports.

    Attributes
    ----------
    filter : of the reports
    limits : of the vessel's motion and of its reports
    """

    filter: FilterParameters
    limits: VesselLimits


@dataclass(frozen=True, slots=True, kw_only=True)
class TrafficParameters:
    """The other vessels of a flight.

    Attributes
    ----------
    vessels : that are known
    speed_max : largest airspeed of the vehicle [m/s]
    yielding : how the mission gives way to them
    """

    vessels: tuple[OtherVessel, ...]
    speed_max: float
    yielding: YieldParameters


@dataclass(frozen=True, slots=True, kw_only=True)
class GuidanceParameters:
    """The parameters of the parts of a flight's guidance; None means without the part.

    Attributes
    ----------
    speed, altitude : V_r, and the altitude to hold [m/s, m]
    tracking : of the tracker
    airspeed_law : keeps the vehicle beside its reference
    airspeed_bandwidth : of the airspeed behind its command [rad/s]
    airspeed_overshoot : over a rise of the command [-]
    navigation : of the estimated own motion; None where it is known exactly, in still air
    vessel : its reports, or its velocity north and east where that is known exactly and steady
        [m/s]
    guard : of the keep-out area
    mission : following a plume, circling the vessel, or tracking a reference that is known in
        advance
    health : of the vehicle
    traffic : other vessels than that of the mission
    """

    speed: float
    altitude: float
    tracking: TrackingParameters
    airspeed_law: AirspeedLaw
    airspeed_bandwidth: float
    airspeed_overshoot: float
    navigation: NavigationParameters | None
    vessel: ReportedVessel | tuple[float, float]
    guard: GuardParameters | None
    mission: FollowingParameters | StandoffParameters | DirectParameters
    health: HealthParameters | None
    traffic: TrafficParameters | None = None


class Guidance:
    """The outer loop of one flight, stepped at a fixed rate.

    Parameters
    ----------
    parameters : of its parts

    Attributes
    ----------
    own, target : motion of the vehicle and of the vessel
    mission : gives the orders, and has the tracker of its reference
    guard : of the keep-out area, or None
    monitor : of the vehicle's health, or None
    traffic, yielding : other vessels, and how the mission gives way to them; or None
    plan_interval : steps between plans of the mission; with 0 there is one plan, in the first step
    mode : present mode
    guarding : whether the keep-out guard changed the last command
    heading_rate_command, airspeed_command, altitude_command : last commands [rad/s, m/s, m]
    """

    def __init__(self, parameters: GuidanceParameters) -> None:
        p = parameters
        self.own: OwnMotion = (
            EstimatedNavigation(p.navigation) if p.navigation else TrueNavigation()
        )
        self.target: TargetMotion
        if isinstance(p.vessel, ReportedVessel):
            reports = VesselFilter(p.vessel.filter)
            discs = ReachableSet(p.vessel.limits)
            self.target = ReportedTarget(reports, discs, p.tracking.time_step)
        else:
            self.target = SteadyTarget(*p.vessel)
        self.mission: Mission
        if isinstance(p.mission, FollowingParameters):
            self.mission = PlumeFollowing(p.mission, p.tracking)
        elif isinstance(p.mission, StandoffParameters):
            self.mission = StandoffOrbit(p.mission, p.tracking)
        else:
            self.mission = DirectTracking(p.mission, p.tracking, altitude=p.altitude)
        self.guard: KeepoutGuard | None = None
        if p.guard:
            speeds = SpeedRange(
                speed=p.speed,
                bandwidth=p.airspeed_bandwidth,
                overshoot=p.airspeed_overshoot,
                time_step=p.tracking.time_step,
            )
            self.guard = KeepoutGuard(p.guard, speeds)
        self.monitor = HealthMonitor(p.health) if p.health else None
        self.traffic: Traffic | None = None
        self.yielding: Yielding | None = None
        if p.traffic:
            self.traffic = Traffic(
                p.traffic.vessels, speed_max=p.traffic.speed_max, horizon=HORIZON
            )
            self.yielding = Yielding(
                p.traffic.yielding,
                heading_rate_max=p.tracking.heading_rate_max,
                lag=p.tracking.lag,
            )
        self.mode = Mode.APPROACH
        self.guarding = False
        self._vessel_discs: Sequence[Tube] = ()
        self._airspeed_law = p.airspeed_law
        self._heading_rate_max = p.tracking.heading_rate_max
        self.plan_interval = p.mission.plan_interval
        self._until_plan = 0
        self.heading_rate_command = 0.0
        self.airspeed_command = p.speed
        self.altitude_command = p.altitude

    def step(self, time: float, measurement: Any) -> None:
        """Compute the commands, then move the reference on by one time step.

        Parameters
        ----------
        time : [s]
        measurement : in the form that the navigation takes
        """
        own = self.own
        own.update(measurement)
        order = self._plan(time, measurement)
        tracker = self.mission.tracker
        reference = tracker.reference
        course = reference.course
        to_north = reference.north - own.north
        to_east = reference.east - own.east
        along = to_north * math.cos(course) + to_east * math.sin(course)
        # While an order replaces the law's command, the law is still called, and goes on from the
        # flown command.
        command = tracker.step(own.north, own.east, own.course, own.speed, own.heading_rate)
        if order.heading_rate is TRACK:
            pace = self._airspeed_law.pace(along)
        else:
            command = order.heading_rate
            pace = order.airspeed
        leaving = order.mode in FAULTY
        held = False
        guard = self.guard
        if guard is not None:
            demand = Demand(time, command, pace, leaving)
            near = self.traffic.near if self.traffic is not None else ()
            guarded = guard.filter(demand, own, self._vessel_discs, near)
            command, pace, held = guarded.heading_rate, guarded.pace, guarded.pace_held
            self.guarding = guarded.status is not GuardStatus.FREE
        tracker.heading_rate_command = command
        # In gusts, too, a turn away is flown in full: it was predicted over the mean air. Where a
        # gust makes the vehicle slower through the air, the vehicle turns faster there, at the same
        # bank.
        limit = self._heading_rate_max
        if self.guarding and own.wind_by_gusts is not None and own.air_ratio < 1.0:
            limit /= own.air_ratio
        full = self.guarding and abs(command) >= self._heading_rate_max
        command /= own.air_ratio
        bounded = math.copysign(limit, command) if full else limited(command, limit)
        if bounded != command:
            command = bounded
            turning = command * own.air_ratio
            tracker.heading_rate_command = turning
            if guard is not None:
                guard.replace(turning)
        self.heading_rate_command = command
        if leaving or (order.heading_rate is not TRACK and not held):
            self.airspeed_command = pace
        else:
            self.airspeed_command = self._airspeed_law.airspeed(pace, own, held)

    def _plan(self, time: float, measurement: Any) -> Order:
        """Return the mission's order, from the present estimates of vessel and vehicle."""
        target = self.target
        renew = self._until_plan == 0
        self._until_plan = self.plan_interval - 1 if renew else self._until_plan - 1
        target.update(time, renew)
        if renew:
            self._vessel_discs = target.tubes
        monitor = self.monitor
        if monitor is not None and monitor.check(measurement, self.heading_rate_command):
            self.mission.react(monitor.fault)
        order = self.mission.plan(time, self.own, target, renew=renew, guarding=self.guarding)
        traffic, yielding = self.traffic, self.yielding
        if traffic is not None and yielding is not None:
            if renew:
                traffic.update(time, self.own)
            if yielding.to or (renew and traffic.near):
                order = yielding.order(
                    order,
                    time,
                    self.own,
                    target,
                    self.mission.orbit,
                    traffic.near,
                    self.mission.tracker.heading_rate_command,
                    renew=renew,
                )
        self.mode = order.mode
        self.altitude_command = order.altitude
        return order

    def overruled(self, heading_rate: float, airspeed: float) -> None:
        """Note the commands that are flown in place of the last ones: predictions follow them.

        Parameters
        ----------
        heading_rate : [rad/s]
        airspeed : [m/s]
        """
        self.heading_rate_command = heading_rate
        self.airspeed_command = airspeed
        turning = heading_rate * self.own.air_ratio
        self.mission.tracker.heading_rate_command = turning
        if self.guard is not None:
            self.guard.replace(turning, airspeed)
