"""The outer loop: from what is measured to commanded heading rate, airspeed and altitude."""

import math
from collections.abc import Sequence
from typing import Any

from gnc.airspeed import AirspeedLaw
from gnc.estimation.health import HealthMonitor
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion, Tube
from gnc.guard.guard import Demand, GuardStatus, KeepoutGuard
from gnc.mission.mission import Mission
from gnc.numeric import limited


class Guidance:
    """The outer loop of one flight, stepped at a fixed rate. ``gnc.compose`` chooses its parts.

    Parameters
    ----------
    own, target : motion of the vehicle and of the vessel
    mission : what to do, and the tracker of its reference
    guard : of the keep-out area, or none
    airspeed_law : keeps the vehicle beside its reference
    monitor : of the vehicle's health, or none
    speed : V_r [m/s]
    heading_rate_max : omega_max; no command exceeds it [rad/s]
    altitude : to hold [m]
    plan_interval : steps between plans; with 0 there is one plan, in the first step

    Attributes
    ----------
    own, target, mission, monitor, plan_interval : as above
    guarding : whether the keep-out guard changed the last command
    heading_rate_command, airspeed_command, altitude_command : last commands [rad/s, m/s, m]
    """

    # Methods of parts are bound once: each is called at every step.
    __slots__ = (
        "_airspeed", "_limit", "_locate", "_pace", "_plan", "_sense", "_until_plan", "_vessel_discs", "airspeed_command",
        "altitude_command", "guard", "guarding", "heading_rate_command", "mission", "monitor", "own", "plan_interval", "target",
    )  # fmt: skip

    def __init__(
        self,
        *,
        own: OwnMotion,
        target: TargetMotion,
        mission: Mission,
        guard: KeepoutGuard | None,
        airspeed_law: AirspeedLaw,
        monitor: HealthMonitor | None,
        speed: float,
        heading_rate_max: float,
        altitude: float,
        plan_interval: int,
    ) -> None:
        self.own, self.target, self.mission, self.monitor = own, target, mission, monitor
        self._sense, self._locate, self._plan = own.update, target.update, mission.plan
        self.guard = guard
        self.guarding = False
        self._vessel_discs: Sequence[Tube] = ()
        self._pace, self._airspeed, self._limit = (
            airspeed_law.pace,
            airspeed_law.airspeed,
            heading_rate_max,
        )
        self.plan_interval, self._until_plan = plan_interval, 0
        self.heading_rate_command, self.airspeed_command, self.altitude_command = (
            0.0,
            speed,
            altitude,
        )

    def step(self, time: float, measurement: Any) -> None:
        """Compute the commands from what is measured now, then move the reference on by one time
        step.

        Parameters
        ----------
        time : [s]
        measurement : in the form that the navigation takes
        """
        own, target, mission = self.own, self.target, self.mission
        self._sense(measurement)
        if self._until_plan:
            self._until_plan -= 1
            self._locate(time, False)
        else:
            self._until_plan = self.plan_interval - 1
            self._locate(time, True)
            if self.guard is not None:
                self._vessel_discs = target.tubes
            self._plan(time)
            self.altitude_command = mission.altitude
        monitor = self.monitor
        if monitor is not None and monitor.check(
            measurement, self.airspeed_command, self.heading_rate_command
        ):
            mission.leave(monitor.fault)
        tracker, overriding = mission.tracker, mission.overriding
        course, north, east = own.course, own.north, own.east
        reference = tracker.reference
        ahead_of = reference.course
        along = (reference.north - north) * math.cos(ahead_of) + (reference.east - east) * math.sin(
            ahead_of
        )
        last = tracker.heading_rate_command
        command = tracker.step(north, east, course, own.speed, own.heading_rate)
        leaving, held, guard = overriding and mission.leaving, False, self.guard
        command, pace = (
            (mission.command(last), mission.airspeed)
            if overriding
            else (command, self._pace(along))
        )
        if guard is not None:
            demand = Demand(time, command, pace, leaving)
            command, pace, held, status = guard.filter(demand, own, self._vessel_discs)
            self.guarding = status is not GuardStatus.FREE
        tracker.heading_rate_command = command
        # A turn away is flown in full in gusts, too: it was predicted without them.
        full = self.guarding and abs(command) >= self._limit
        command /= own.air_ratio
        bounded = math.copysign(self._limit, command) if full else limited(command, self._limit)
        if bounded != command:
            command = bounded
            tracker.heading_rate_command = turning = command * own.air_ratio
            if guard is not None:
                guard.replace(turning)
        self.heading_rate_command = command
        self.airspeed_command = (
            pace if leaving or (overriding and not held) else self._airspeed(pace, own, held)
        )
        if leaving:
            self.altitude_command = mission.altitude

    def overruled(self, heading_rate: float, airspeed: float) -> None:
        """Take note of commands that are flown in place of the last ones [rad/s, m/s]: what is
        predicted follows them.
        """
        self.heading_rate_command, self.airspeed_command = heading_rate, airspeed
        self.mission.tracker.heading_rate_command = turning = heading_rate * self.own.air_ratio
        if self.guard is not None:
            self.guard.replace(turning, airspeed)
