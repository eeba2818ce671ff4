"""The mission over a moving vessel: approach round it, track a steered reference, hold off while it
is uncertain, leave.
"""

import math
from dataclasses import dataclass

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.guard.guard import KeepoutGuard
from gnc.mission.approach import LOST_TRACK, Approach, ApproachParameters
from gnc.mission.egress import Egress
from gnc.mission.mode import Mode
from gnc.mission.plume_axis import AxisParameters, Situation
from gnc.reference.mean_motion import mean_motion, motion_course
from gnc.reference.moving_centre import CentreParameters, MovingCentre
from gnc.reference.reference import Swing
from gnc.reference.steered import SteeredReference
from gnc.tracker import Tracker, TrackingParameters

MANOEUVRE_RANGE = 200.0
"""Distance that the orbit is moved off per acceleration of the vessel [s^2]: the centre follows a
manoeuvre late.
"""

GLIDE_ALTITUDE = -1000.0
"""Altitude that a gliding vehicle is commanded [m]: so far below that the autopilot holds its
airspeed by pitch, and sinks.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingParameters:
    """How a moving vessel's plume is followed.

    Attributes
    ----------
    centre : of the centre of oscillation
    reference_heading_rate : largest of the reference [rad/s]
    swing : courses of the reference, by its shape
    joining_share : part of the heading rate that the reference takes as long as it is not tracked
        [-]
    speed_ratio_max : above it the vessel outruns the vehicle [-]
    approach : the way to the centre
    standoff : how much farther off the centre stays until the reference is tracked [m]
    glide_airspeed : while leaving without thrust or control [m/s]
    stale : age of vessel data beyond which the keep-out margin no longer covers where the vessel
        may be [s]
    reach, reach_time : how far the vessel may be, that time ahead, from where it is taken to be,
        while its reports come [m, s]
    drift_rate : how fast dead reckoning goes wrong [m/s]
    plan_interval : guidance steps between plans
    axis : how the plume's axis is known, and so how high is flown
    """

    centre: CentreParameters
    reference_heading_rate: float
    swing: Swing
    joining_share: float
    speed_ratio_max: float
    approach: ApproachParameters
    standoff: float
    glide_airspeed: float
    stale: float
    reach: float
    reach_time: float
    drift_rate: float
    plan_interval: int
    axis: AxisParameters


class PlumeFollowing:
    """Follows a vessel's plume; attributes as of ``gnc.mission.mission.Mission``.

    Parameters
    ----------
    parameters : of the mission
    tracking : of the tracker of its reference
    own, target : motion of the vehicle and of the vessel, updated by whoever steps the guidance
    guard : of the keep-out area, or none

    Attributes
    ----------
    axis : of the plume
    departing : whether the vehicle leaves for good, though nothing is wrong with it
    """

    __slots__ = (
        "_approach", "_closing_in", "_egress", "_guard", "_orbit_range", "_orbit_rate", "_own", "_parameters",
        "_plan_time", "_reference", "_situation", "_speed", "_target", "_tracking", "_tracking_parameters", "airspeed", "altitude",
        "axis", "centre", "centre_error", "departing", "leaving", "mode", "started", "tracker",
    )  # fmt: skip

    def __init__(
        self,
        parameters: FollowingParameters,
        tracking: TrackingParameters,
        *,
        own: OwnMotion,
        target: TargetMotion,
        guard: KeepoutGuard | None,
    ) -> None:
        self._parameters, self._tracking_parameters = parameters, tracking
        self._own, self._target, self._guard = own, target, guard
        self._speed = parameters.centre.speed
        self._approach = Approach(
            parameters.approach,
            own=own,
            target=target,
            speed=self._speed,
            heading_rate_max=tracking.heading_rate_max,
            lag=tracking.lag,
            time_step=tracking.time_step,
        )
        self._egress = Egress(tracking.heading_rate_max)
        self._plan_time = 0.0
        self._tracking = self._closing_in = self.leaving = self.departing = self.started = False
        self._orbit_range = self._orbit_rate = self.centre_error = 0.0
        self.centre = MovingCentre(parameters.centre)
        self.mode = Mode.APPROACH
        self.axis = parameters.axis.begin()
        self._situation = Situation(
            own=own,
            target=target,
            centre=self.centre,
            speed=self._speed,
            plan_time=parameters.plan_interval * tracking.time_step,
        )
        self.airspeed, self.altitude = parameters.approach.airspeed, parameters.axis.altitude
        self.tracker: Tracker[SteeredReference]
        self._reference: SteeredReference

    @property
    def in_place(self) -> bool:
        """Whether the centre is as near to the vessel as it will come."""
        return self._closing_in and self.centre.in_place

    @property
    def overriding(self) -> bool:
        """Whether ``command`` replaces the tracker's heading rate."""
        return self.leaving or self.departing or not self._tracking

    def leave(self, fault: Fault) -> None:
        """Leave the vessel for good, because of a fault of the vehicle."""
        self.leaving = True
        self.mode = Mode.GLIDING if fault is Fault.THRUST_LOST else Mode.TERMINATING
        self.airspeed, self.altitude = self._parameters.glide_airspeed, GLIDE_ALTITUDE

    def depart(self) -> None:
        """Leave the vessel for good at this altitude: there is no more to be done here."""
        self.departing = True

    def command(self, last_command: float) -> float:
        """Return the heading rate that leads to the centre of oscillation, round the vessel, or
        away from it [rad/s].
        """
        own, target, centre = self._own, self._target, self.centre
        if self.leaving or self.departing:
            x, y = own.ground_north - target.north, own.ground_east - target.east
            return self._egress.command(
                x, y, self._approach.course_ahead(last_command), own.heading_rate
            )
        return self._approach.command(
            centre.x,
            centre.y,
            last_command,
            additional_range=self._orbit_range,
            guarding=self._guarding,
        )

    def plan(self, time: float) -> None:
        """Move the centre, steer the reference, and decide what to do."""
        p, own, centre = self._parameters, self._own, self.centre
        age = self._target.age(time)
        self._widen_margin()
        self._move_centre()
        if not self.started:
            self.started = True
            self._plan_time = p.plan_interval * self._tracking_parameters.time_step
            self._place_reference()
        self._steer()
        self._decide()
        if self.leaving:
            return
        self.axis.plan(time, self._situation, tracking=self._tracking)
        if self.departing:
            self.mode = Mode.DEPARTING
            return
        axis = self.axis
        self.altitude = axis.climb.step(
            self.altitude, axis.demanded, self._speed, self._plan_time, flown=axis.flown
        )
        if own.lost > 0.0:
            self.mode = Mode.DEAD_RECKONING
        elif age > p.stale:
            self.mode = Mode.HOLDING
        elif centre.speed_ratio >= p.speed_ratio_max:
            self.mode = Mode.OUTRUN
        elif not centre.plume_known:
            self.mode = Mode.NO_PLUME
        else:
            self.mode = self.axis.mode if self._tracking else Mode.APPROACH

    @property
    def _guarding(self) -> bool:
        """Whether the keep-out guard turns the vehicle away."""
        return self._guard is not None and self._guard.intervening

    def _widen_margin(self) -> None:
        """Keep farther off while the vessel may be farther from where it is taken to be than as
        long as its reports come.
        """
        p, target, axis = self._parameters, self._target, self.centre.axis
        cos_a, sin_a = math.cos(axis), math.sin(axis)
        # Each disc in the direction of the plume, from where the vessel is taken to be.
        reach = min(
            tube.reach(p.reach_time)
            + cos_a
            * (
                tube.north
                - target.north
                + p.reach_time * (tube.velocity_north - target.velocity_north)
            )
            + sin_a
            * (tube.east - target.east + p.reach_time * (tube.velocity_east - target.velocity_east))
            for tube in target.tubes
        )
        drifted = (p.drift_rate + self._own.wind_error) * self._own.lost
        last, self._orbit_range = self._orbit_range, max(0.0, reach - p.reach) + drifted
        self._orbit_rate = (self._orbit_range - last) / self._plan_time if self._plan_time else 0.0

    def _move_centre(self) -> None:
        own, target = self._own, self._target
        manoeuvre_range = MANOEUVRE_RANGE * math.hypot(
            target.acceleration_north, target.acceleration_east
        )
        self.centre.move(
            self._plan_time,
            vessel_north=target.velocity_north,
            vessel_east=target.velocity_east,
            acceleration_north=target.acceleration_north,
            acceleration_east=target.acceleration_east,
            wind_north=own.wind_north,
            wind_east=own.wind_east,
            bearing=self.axis.bearing,
            additional_range=self._orbit_range
            + (0.0 if self._closing_in else self._parameters.standoff)
            + manoeuvre_range,
            additional_rate=self._orbit_rate,
        )

    def _place_reference(self) -> None:
        """Place the reference on the centre of oscillation."""
        p, own, target, centre = self._parameters, self._own, self._target, self.centre
        reference = SteeredReference(
            north=target.north - own.drift_north + centre.x,
            east=target.east - own.drift_east + centre.y,
            mean_course=motion_course(centre),
            speed_ratio=min(centre.speed_ratio, p.speed_ratio_max),
            phase=0.0,
            speed=self._speed,
            heading_rate=p.reference_heading_rate,
            swing=p.swing,
            time_step=self._tracking_parameters.time_step,
        )
        tracker = Tracker(self._tracking_parameters, reference, wind=own)
        self.tracker, self._reference = tracker, tracker.ahead

    def _steer(self) -> None:
        """Steer the reference's mean velocity so that its orbit is where it should be."""
        p, own, target, centre = self._parameters, self._own, self._target, self.centre
        lag = self._tracking_parameters.lag
        orbit_north, orbit_east = self._reference.centre()
        off_north = (
            target.north - own.drift_north + centre.x + lag * centre.velocity_north - orbit_north
        )
        off_east = target.east - own.drift_east + centre.y + lag * centre.velocity_east - orbit_east
        self.centre_error = math.hypot(off_north, off_east)
        limit = self._tracking_parameters.heading_rate_max
        mean_course, speed_ratio = mean_motion(centre, off_north, off_east, self._speed, limit)
        self._reference.steer(mean_course, min(speed_ratio, p.speed_ratio_max))

    def _decide(self) -> None:
        """Decide whether to track the reference, and whether the orbit may close in."""
        tracked, own, centre = self._parameters.approach.tracked, self._own, self.centre
        to_north = self.tracker.reference.north + own.drift_north - own.ground_north
        to_east = self.tracker.reference.east + own.drift_east - own.ground_east
        error = math.hypot(to_north, to_east)
        self._tracking = self._approach.joins(
            centre.x,
            centre.y,
            centre.axis,
            error=error,
            tracking=self._tracking,
            guarding=self._guarding,
        )
        self._closing_in = (
            self._tracking and error < (LOST_TRACK if self._closing_in else 1.0) * tracked
        )
        self._reference.spend(1.0 if self._closing_in else self._parameters.joining_share)
