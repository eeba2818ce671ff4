"""The mission over a moving vessel: approach, track a steered reference, hold off, leave."""

import math
from dataclasses import dataclass

from gnc.estimation.error_budget import ErrorBudget
from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.mission.axis import AxisInputs, AxisParameters
from gnc.mission.mission import FAULTY, TRACK, Centre, Mode, OrbitStatus, Order
from gnc.mission.way import LOST_TRACK, Approach, ApproachParameters, Egress
from gnc.reference.mean_motion import mean_motion, motion_course
from gnc.reference.moving_centre import CentreParameters, MovingCentre
from gnc.reference.reference import Swing
from gnc.reference.steered import SteeredReference
from gnc.tracker import Tracker, TrackingParameters

MANOEUVRE_RANGE = 200.0
"""Distance by which the orbit is moved away, per acceleration of the vessel [s^2]: the centre lags.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FollowingParameters:
    """How a moving vessel's plume is followed.

    Attributes
    ----------
    centre : of the centre of oscillation
    reference_heading_rate : largest of the reference [rad/s]
    swing : courses of the reference's shape
    turn_rate_fraction_until_tracked : same as ``gnc.reference.reference.ReferenceShape`` [-]
    speed_ratio_max : speed ratio above which the vessel outruns the vehicle [-]
    approach : the way to the centre
    standoff : additional distance of the centre until the reference is tracked [m]
    glide_airspeed : while leaving without thrust or control [m/s]
    stale : age of vessel data beyond which the keep-out margin no longer covers the vessel's
        possible places [s]
    reach, reach_time : largest distance of the vessel from its assumed place after that time, while
        its reports come [m, s]
    errors : error budget that is allowed for
    plan_interval : guidance steps between plans
    axis : how the plume's axis, and so the altitude, is known
    """

    centre: CentreParameters
    reference_heading_rate: float
    swing: Swing
    turn_rate_fraction_until_tracked: float
    speed_ratio_max: float
    approach: ApproachParameters
    standoff: float
    glide_airspeed: float
    stale: float
    reach: float
    reach_time: float
    errors: ErrorBudget
    plan_interval: int
    axis: AxisParameters


class PlumeFollowing:
    """Follows a vessel's plume; see ``gnc.mission.mission.Mission``.

    Parameters
    ----------
    parameters : of the mission
    tracking : of the tracker of its reference

    Attributes
    ----------
    centre : of oscillation
    axis : of the plume
    departing : whether the vehicle leaves for good, though without a fault
    """

    def __init__(self, parameters: FollowingParameters, tracking: TrackingParameters) -> None:
        self._parameters = parameters
        self._tracking_parameters = tracking
        self._speed = parameters.centre.speed
        self._approach = Approach(parameters.approach, tracking, self._speed)
        self._egress = Egress(tracking, self._speed, parameters.glide_airspeed)
        self.tracker: Tracker[SteeredReference]
        self._reference: SteeredReference
        self.orbit: OrbitStatus | None = None
        self.centre = MovingCentre(parameters.centre)
        self.axis = parameters.axis.begin()
        self._altitude = parameters.axis.altitude
        self._mode = Mode.APPROACH
        self._fault = Fault.NONE
        self.departing = False
        self._tracking = False
        self._closing_in = False
        # Time since the last plan; 0 before the first [s].
        self._plan_time = 0.0
        self._orbit_range = 0.0
        self._orbit_rate = 0.0

    def plan(
        self, time: float, own: OwnMotion, vessel: TargetMotion, *, renew: bool, guarding: bool
    ) -> Order:
        """Return the order to track, or the way to the centre of oscillation or away from the
        vessel.
        """
        if renew:
            self._move_orbit(own, vessel)
            self._decide(own, vessel, guarding)
            if self._mode not in FAULTY:
                self._follow_axis(time, own, vessel)
        p = self._parameters
        last = self.tracker.heading_rate_command
        if self._fault is not Fault.NONE:
            order = self._egress.order(self._fault, own, vessel, last, self._altitude)
            self._mode = order.mode
            return order
        command: float | None = TRACK
        if self.departing:
            command = self._egress.command(own, vessel, last)
        elif not self._tracking:
            command = self._approach.command(
                own,
                vessel,
                self.centre.x,
                self.centre.y,
                last,
                additional_range=self._orbit_range,
                guarding=guarding,
            )
        return Order(command, p.approach.airspeed, self._altitude, self._mode)

    def react(self, fault: Fault) -> None:
        """Leave the vessel from the next order on because of a fault of the vehicle, or go on."""
        self._fault = fault
        if fault is Fault.NONE:
            self._egress.reset()
            self._mode = Mode.APPROACH

    def depart(self) -> None:
        """Leave the vessel for good at this altitude: the mission is over."""
        self.departing = True

    def _move_orbit(self, own: OwnMotion, vessel: TargetMotion) -> None:
        """Move the centre of oscillation, and steer the reference so that its orbit follows."""
        self._widen_margin(own, vessel)
        self._move_centre(own, vessel)
        if self.orbit is None:
            tracking = self._tracking_parameters
            self._plan_time = self._parameters.plan_interval * tracking.time_step
            self._place_reference(own, vessel)
        p = self._parameters
        centre = self.centre
        lag = self._tracking_parameters.lag
        orbit_north, orbit_east = self._reference.centre()
        off_north = (
            vessel.north - own.drift_north + centre.x + lag * centre.velocity_north - orbit_north
        )
        off_east = vessel.east - own.drift_east + centre.y + lag * centre.velocity_east - orbit_east
        limit = self._tracking_parameters.heading_rate_max
        mean_course, speed_ratio = mean_motion(centre, off_north, off_east, self._speed, limit)
        self._reference.steer(mean_course, min(speed_ratio, p.speed_ratio_max))
        self._centre_error = math.hypot(off_north, off_east)

    def _widen_margin(self, own: OwnMotion, vessel: TargetMotion) -> None:
        """Keep farther away while the vessel may have moved farther than between its reports."""
        p = self._parameters
        cos_a = math.cos(self.centre.axis)
        sin_a = math.sin(self.centre.axis)
        # Reach of each disc in the direction of the plume, from the assumed place of the vessel.
        reach = min(
            tube.reach(p.reach_time)
            + cos_a
            * (
                tube.north
                - vessel.north
                + p.reach_time * (tube.velocity_north - vessel.velocity_north)
            )
            + sin_a
            * (tube.east - vessel.east + p.reach_time * (tube.velocity_east - vessel.velocity_east))
            for tube in vessel.tubes
        )
        drifted = 0.0
        if own.lost > 0.0:
            drifted = (p.errors.drift.rate + own.wind_error) * own.lost
            wind = own.wind_by_gusts
            drifted += p.errors.displacement(lost=own.lost, wind=wind).after(0.0)
        last = self._orbit_range
        self._orbit_range = max(0.0, reach - p.reach) + drifted
        self._orbit_rate = (self._orbit_range - last) / self._plan_time if self._plan_time else 0.0

    def _move_centre(self, own: OwnMotion, vessel: TargetMotion) -> None:
        manoeuvre_range = MANOEUVRE_RANGE * math.hypot(
            vessel.acceleration_north, vessel.acceleration_east
        )
        self.centre.move(
            self._plan_time,
            own,
            vessel,
            bearing=self.axis.bearing,
            additional_range=self._orbit_range
            + (0.0 if self._closing_in else self._parameters.standoff)
            + manoeuvre_range,
            additional_rate=self._orbit_rate,
        )

    def _place_reference(self, own: OwnMotion, vessel: TargetMotion) -> None:
        """Place the reference on the centre of oscillation."""
        p = self._parameters
        centre = self.centre
        reference = SteeredReference(
            north=vessel.north - own.drift_north + centre.x,
            east=vessel.east - own.drift_east + centre.y,
            mean_course=motion_course(centre),
            speed_ratio=min(centre.speed_ratio, p.speed_ratio_max),
            phase=0.0,
            speed=self._speed,
            heading_rate=p.reference_heading_rate,
            swing=p.swing,
            time_step=self._tracking_parameters.time_step,
        )
        self.tracker = Tracker(self._tracking_parameters, reference, wind=own)
        self._reference = self.tracker.ahead

    def _decide(self, own: OwnMotion, vessel: TargetMotion, guarding: bool) -> None:
        """Decide whether to track the reference, and whether the orbit may close in."""
        p = self._parameters
        centre = self.centre
        to_north = self.tracker.reference.north + own.drift_north - own.ground_north
        to_east = self.tracker.reference.east + own.drift_east - own.ground_east
        error = math.hypot(to_north, to_east)
        self._tracking = self._approach.should_track(
            own,
            vessel,
            centre.x,
            centre.y,
            centre.axis,
            error=error,
            tracking=self._tracking,
            guarding=guarding,
        )
        near = (LOST_TRACK if self._closing_in else 1.0) * p.approach.tracked
        self._closing_in = self._tracking and error < near
        self._reference.set_turn_rate_fraction(
            1.0 if self._closing_in else p.turn_rate_fraction_until_tracked
        )
        self.orbit = OrbitStatus(
            Centre(centre.x, centre.y, centre.speed_ratio),
            self._centre_error,
            self._closing_in and centre.in_place,
        )

    def _follow_axis(self, time: float, own: OwnMotion, vessel: TargetMotion) -> None:
        """Follow the height of the plume's axis, and set the mode."""
        p = self._parameters
        axis = self.axis
        inputs = AxisInputs(own, vessel, self.centre, self._speed, self._plan_time)
        axis.plan(time, inputs, tracking=self._tracking)
        if self.departing:
            self._mode = Mode.DEPARTING
            return
        self._altitude = axis.climb.step(
            self._altitude, axis.demanded, self._speed, self._plan_time, flown=axis.flown
        )
        if own.lost > 0.0:
            self._mode = Mode.DEAD_RECKONING
        elif vessel.age(time) > p.stale:
            self._mode = Mode.HOLDING
        elif self.centre.speed_ratio >= p.speed_ratio_max:
            self._mode = Mode.OUTRUN
        elif not self.centre.plume_known:
            self._mode = Mode.NO_PLUME
        elif self._tracking:
            self._mode = axis.mode
        else:
            self._mode = Mode.APPROACH
