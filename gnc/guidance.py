"""The outer loop: from what is measured to commanded heading rate, airspeed and altitude."""

import math
from typing import Any

from gnc.airspeed.airspeed_law import AirspeedLaw
from gnc.estimation.health_monitor import HealthMonitor
from gnc.estimation.own_motion import OwnMotion
from gnc.estimation.target_motion import TargetMotion
from gnc.mission.mission import Mission
from gnc.safety.keepout_guard import KeepoutGuard
from gnc.safety.speed_reckoning import SpeedReckoning

_UNASKED = 0.05
"""By how much the pace may exceed what the guard was asked about [m/s]: a turn away comes nearer by less than 0.1 m for it."""


class Guidance:
    """The outer loop of one flight, stepped at a fixed rate. ``gnc.compose`` chooses its parts.

    Parameters
    ----------
    own, target : motion of the vehicle and of the vessel
    mission : what to do, and the tracker of its reference
    guard : of the keep-out area, or none
    airspeed_law : keeps the vehicle beside its reference
    monitor : of the vehicle's health, or none
    reckoning : of the speed that the guard predicts turns away with
    speed : V_r [m/s]
    heading_rate_max : omega_max; no command exceeds it [rad/s]
    altitude : to hold [m]
    plan_interval : steps between plans; with 0 there is one plan, in the first step

    Attributes
    ----------
    own, target, mission, guard, monitor, reckoning, plan_interval : as above
    guarding : whether the keep-out guard changed the last command
    heading_rate_command, airspeed_command, altitude_command : last commands [rad/s, m/s, m]
    """

    # Methods of parts are bound once: each is called at every step.
    __slots__ = (
        "_airspeed", "_catching_up_from", "_keep_out", "_limit", "_locate", "_pace", "_plan", "_quarter_turn", "_sense",
        "_speed", "_until_plan", "airspeed_command", "altitude_command", "guard", "guarding", "heading_rate_command", "mission",
        "monitor", "own", "plan_interval", "reckoning", "target",
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
        reckoning: SpeedReckoning,
        speed: float,
        heading_rate_max: float,
        altitude: float,
        plan_interval: int,
    ) -> None:
        self.own, self.target, self.mission, self.guard, self.monitor = own, target, mission, guard, monitor
        self._sense, self._locate, self._plan = own.update, target.update, mission.plan
        self._keep_out = guard.limit if guard is not None else None
        self._pace, self._airspeed = airspeed_law.pace, airspeed_law.airspeed
        self.reckoning, self._speed, self._limit = reckoning, speed, heading_rate_max
        self.plan_interval, self._until_plan = plan_interval, 0
        self.guarding = False
        # A vehicle that catches up turns the wider. It does so once the guard has been free for a quarter of a turn: before that,
        # the airspeed that is commanded would make it act again, and so in turns.
        self._quarter_turn, self._catching_up_from = 0.5 * math.pi / heading_rate_max, -math.inf
        self.heading_rate_command, self.airspeed_command, self.altitude_command = 0.0, speed, altitude

    def step(self, time: float, measurement: Any) -> None:
        """Compute the commands from what is measured now, then move the reference on by one time step.

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
                self.guard.tubes = target.tubes
            self._plan(time)
            self.altitude_command = mission.altitude
        monitor = self.monitor
        if monitor is not None and monitor.check(measurement, self.airspeed_command, self.heading_rate_command):
            mission.leave(monitor.fault)
        tracker, overriding, slower = mission.tracker, mission.overriding, False
        course, speed, heading_rate, north, east = own.course, own.speed, own.heading_rate, own.north, own.east
        reference = tracker.reference
        ahead_of = reference.course
        along = (reference.north - north) * math.cos(ahead_of) + (reference.east - east) * math.sin(ahead_of)
        command = tracker.step(north, east, course, speed, heading_rate)
        command = mission.command() if overriding else command
        catching_up, leaving = time >= self._catching_up_from, overriding and mission.leaving
        pace = (mission.airspeed if overriding else self._pace(along)) if catching_up or leaving else self._speed
        keep_out, guard, reckoning = self._keep_out, self.guard, self.reckoning
        if keep_out is not None and guard is not None:
            fastest, slowest = reckoning.fastest(pace), speed if speed < self._speed else self._speed
            # It flies faster only where the faster vehicle can turn away, too: a turn that was safe must remain so. Against a disc
            # that closes in a slower one may come nearer; so it must be safe as slow as the vehicle is, too.
            faster = pace > reckoning.highest + _UNASKED and not leaving
            if faster and not guard.allows(command, time, own, speed if speed > fastest else fastest, slowest):
                pace, slower = reckoning.highest, True
                fastest = reckoning.fastest(pace)
            command = keep_out(command, time, own, speed if speed > fastest else fastest, slowest)
            self.guarding = guard.intervening
            if self.guarding and not leaving:
                # A vehicle that catches up meanwhile turns the wider.
                pace, slower, catching_up = self._speed, True, False
                self._catching_up_from = time + self._quarter_turn
            reckoning.note(pace if faster or pace < reckoning.highest else reckoning.highest)
        tracker.heading_rate_command = command
        command /= own.air_ratio
        limit = self._limit
        if not -limit <= command <= limit:
            command = math.copysign(limit, command)
            if guard is not None:
                guard.overruled(command * own.air_ratio)
        self.heading_rate_command = command
        held = slower or not catching_up
        self.airspeed_command = pace if leaving or (overriding and not held) else self._airspeed(pace, own, held)
        if leaving:
            self.altitude_command = mission.altitude

    def overruled(self, heading_rate: float, airspeed: float) -> None:
        """Take note of commands that are flown in place of the last ones [rad/s, m/s]: what is predicted follows them."""
        self.heading_rate_command, self.airspeed_command = heading_rate, airspeed
        self.reckoning.include(airspeed)
        self.mission.tracker.heading_rate_command = turning = heading_rate * self.own.air_ratio
        if self.guard is not None:
            self.guard.overruled(turning)
