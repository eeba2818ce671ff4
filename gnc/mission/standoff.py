"""The mission on a circle about a moving vessel: the standoff orbits of the literature.

At every step, the reference is the circle's point nearest to the vehicle, with the course and the
heading rate through the air that keep to the circle. It has no clock, so that a law is free to lag
along the circle; a law that reads a path from the reference gets the circle in the frame of the
vessel.
"""

import math
from dataclasses import dataclass

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.mission.axis import AxisHeight, Climb
from gnc.mission.mission import FAULTY, TRACK, Centre, Mode, OrbitStatus, Order
from gnc.mission.track import CLOSING_RATE, STANDOFF
from gnc.mission.way import COURSE_GAIN, Egress
from gnc.numeric import limited, wrap
from gnc.steering import Air, Motion, heading_for
from gnc.tracker import PlacedReference, ReferenceTracker, TrackingParameters
from gnc.unicycle import lag_ahead
from gnc.vectors import Vector, along, course_of, minus, norm, plus, scaled


@dataclass(frozen=True, slots=True, kw_only=True)
class StandoffParameters:
    """Parameters of circling a vessel clockwise.

    Attributes
    ----------
    radius : of the circle; the vehicle joins a larger circle, which closes in once it is tracked
        [m]
    tracked : distance from the circle that counts as tracked [m]
    speed : V_r [m/s]
    speed_ratio_max : speed ratio above which the vessel outruns the vehicle [-]
    glide_airspeed : while leaving without thrust or control [m/s]
    plan_interval : guidance steps between plans
    altitude : at the start [m]
    height : of the plume's axis, and so of the flight
    climb : how the altitude follows that height
    """

    radius: float
    tracked: float
    speed: float
    speed_ratio_max: float
    glide_airspeed: float
    plan_interval: int
    altitude: float
    height: AxisHeight
    climb: Climb


class CirclePoint(PlacedReference):
    """A reference on the circle."""

    def place(self, centre: Vector, drift: Vector, vehicle: Vector, radius: float) -> None:
        """Move to the point of the circle, flown clockwise, nearest to the vehicle.

        Parameters
        ----------
        centre : place of the circle's centre, north and east [m]
        drift : velocity of the centre through the air, below the vehicle's speed [m/s]
        vehicle : place of the vehicle [m]
        radius : of the circle [m]
        """
        bearing = course_of(minus(vehicle, centre))
        self.north, self.east = plus(centre, along(bearing), radius)
        course = bearing + 0.5 * math.pi
        # On the circle the velocity relative to the centre turns by that speed over the radius.
        self.course, turn = heading_for(course, 1.0, self.speed, drift)
        relative = norm(minus(scaled(along(self.course), self.speed), drift))
        self.heading_rate = turn * relative / radius

    def step(self) -> None:
        """Do nothing: the point is placed anew at every step."""


class CircleTracker(ReferenceTracker):
    """Steers to the circle, with a preview by the vehicle's lag.

    Parameters
    ----------
    tracking : how a reference is tracked
    parameters : of the circle
    own, target : motion of the vehicle and of the vessel

    Attributes
    ----------
    radius : of the circle now [m]
    """

    def __init__(
        self,
        tracking: TrackingParameters,
        parameters: StandoffParameters,
        own: OwnMotion,
        target: TargetMotion,
    ) -> None:
        self._point = CirclePoint(parameters.speed)
        super().__init__(tracking, self._point)
        self._own = own
        self._target = target
        self._time_step = tracking.time_step
        self.radius = parameters.radius + STANDOFF * parameters.tracked
        self._limit = tracking.heading_rate_max
        self._lag = tracking.lag
        self.ahead = CirclePoint(parameters.speed)

    def step(
        self, north: float, east: float, course: float, speed: float, heading_rate: float
    ) -> float:
        """Return the heading rate to command [rad/s]; see ``ReferenceTracker``."""
        own, target, reference, ahead = self._own, self._target, self._point, self.ahead
        drift = target.velocity_north - own.wind_north, target.velocity_east - own.wind_east
        if norm(drift) >= reference.speed:
            demand = COURSE_GAIN * self._limit * wrap(course_of(drift) - course)
            command = limited(demand, self._limit)
        else:
            centre = target.north - own.drift_north, target.east - own.drift_east

            def placed(point: CirclePoint, time: float) -> tuple[float, float, float]:
                vehicle = lag_ahead(
                    north, east, course, speed, heading_rate, self.heading_rate_command, time
                )
                point.place(plus(centre, drift, time), drift, vehicle[:2], self.radius)
                return vehicle

            turning = self.heading_rate_command if self._lag > 0.0 else heading_rate
            then = Motion(*placed(ahead, self._lag), speed, turning)
            air = Air(own.wind_north, own.wind_east, target.velocity_north, target.velocity_east)
            demand, command = self._law.demand(ahead, then, air)
            # The place at the next step, as for the reference of any tracker.
            placed(reference, self._time_step)
        self.heading_rate_demand, self.heading_rate_command = demand, command
        self.saturated = command != demand
        return command


class StandoffOrbit:
    """Circles the vessel; see ``gnc.mission.mission.Mission``.

    Parameters
    ----------
    parameters : of the mission
    tracking : of the tracker
    """

    def __init__(self, parameters: StandoffParameters, tracking: TrackingParameters) -> None:
        self._parameters = parameters
        self._tracking_parameters = tracking
        self._plan_time = parameters.plan_interval * tracking.time_step
        self._closing = CLOSING_RATE * parameters.speed * self._plan_time
        self._egress = Egress(tracking, parameters.speed, parameters.glide_airspeed)
        self.tracker: CircleTracker
        self.orbit: OrbitStatus | None = None
        self._altitude = parameters.altitude
        self._mode = Mode.APPROACH
        self._fault = Fault.NONE

    def plan(
        self,
        time: float,  # noqa: ARG002 - of the Protocol
        own: OwnMotion,
        vessel: TargetMotion,
        *,
        renew: bool,
        guarding: bool,  # noqa: ARG002 - of the Protocol
    ) -> Order:
        """Return the order to fly the circle, or to leave the vessel."""
        p = self._parameters
        if renew:
            self._plan_circle(own, vessel)
        if self._fault is not Fault.NONE:
            last = self.tracker.heading_rate_command
            order = self._egress.order(self._fault, own, vessel, last, self._altitude)
            self._mode = order.mode
            return order
        return Order(TRACK, p.speed, self._altitude, self._mode)

    def react(self, fault: Fault) -> None:
        """Leave the vessel from the next order on because of a fault of the vehicle, or go on."""
        self._fault = fault
        if fault is Fault.NONE:
            self._egress.reset()
            self._mode = Mode.APPROACH

    def _plan_circle(self, own: OwnMotion, vessel: TargetMotion) -> None:
        """Decide whether the vessel can be circled, and whether the circle may close in."""
        p = self._parameters
        if self.orbit is None:
            self.tracker = CircleTracker(self._tracking_parameters, p, own, vessel)
            error = self.tracker.radius - p.radius
        else:
            error = self.orbit.error
        tracker = self.tracker
        distance = math.hypot(own.ground_north - vessel.north, own.ground_east - vessel.east)
        if abs(distance - tracker.radius) < p.tracked and error > 0.0:
            error = max(0.0, error - self._closing)
            tracker.radius = p.radius + error
        drift_north = vessel.velocity_north - own.wind_north
        drift_east = vessel.velocity_east - own.wind_east
        ratio = math.hypot(drift_north, drift_east) / p.speed
        self.orbit = OrbitStatus(Centre(0.0, 0.0, ratio), error, in_place=error == 0.0)
        if self._mode not in FAULTY:
            self._mode = Mode.OUTRUN if ratio >= p.speed_ratio_max else Mode.TRACKING
            height = p.height.at(p.radius, ratio * p.speed)
            self._altitude = p.climb.step(self._altitude, height, p.speed, self._plan_time)
