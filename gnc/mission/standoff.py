"""The mission on a circle about a moving vessel: the standoff orbits of the literature, for laws
that know paths.

The reference is where a vehicle would be that flew the circle beside this one: the circle's point
nearest to the vehicle, anew at every step, with the course and the heading rate through the air
that keep to the circle. It has no clock, so that a law is free to lag along the circle; a law that
reads a path from the reference (``gnc.path_laws.path``) finds the circle in the frame of the
vessel (M2).
"""

import math
from dataclasses import dataclass

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.laws import Air, LimitedLaw, Motion
from gnc.mission.approach import COURSE_GAIN
from gnc.mission.axis_height import AxisHeight
from gnc.mission.direct_tracking import CLOSING_RATE, STANDOFF, SteadyCentre
from gnc.mission.egress import Egress
from gnc.mission.mode import Mode
from gnc.mission.plume_axis import Climb
from gnc.mission.plume_following import GLIDE_ALTITUDE
from gnc.numeric import limited, wrap
from gnc.path_laws.lgvf import heading_for
from gnc.tracker import TrackingParameters
from gnc.unicycle import lag_ahead
from gnc.vectors import Vector, along, course_of, minus, norm, plus, scaled

_CLOCKWISE = 1


@dataclass(frozen=True, slots=True, kw_only=True)
class StandoffParameters:
    """How a vessel is circled, clockwise.

    Attributes
    ----------
    radius : of the circle; it is joined outside of its place, and closes in once it is tracked [m]
    tracked : distance from the circle that counts as tracked [m]
    speed : V_r [m/s]
    speed_ratio_max : above it the vessel outruns the vehicle [-]
    glide_airspeed : while leaving without thrust or control [m/s]
    plan_interval : guidance steps between plans
    altitude : at the start [m]
    height : of the plume's axis, and so of the flight
    climb : how the altitude follows it
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


@dataclass(slots=True)
class CirclePoint:
    """A reference on the circle; attributes as of ``gnc.reference.reference.Reference``. It is
    moved by whoever has it.
    """

    speed: float
    north: float = 0.0
    east: float = 0.0
    course: float = 0.0
    heading_rate: float = 0.0

    def place(self, centre: Vector, drift: Vector, vehicle: Vector, radius: float) -> None:
        """Move to the point of the circle nearest to the vehicle.

        Parameters
        ----------
        centre, drift : of the circle: its place [m] and its velocity through the air, below the
            vehicle's speed [m/s]
        vehicle : its place [m]
        radius : of the circle [m]
        """
        bearing = course_of(minus(vehicle, centre))
        self.north, self.east = plus(centre, along(bearing), radius)
        course = bearing + _CLOCKWISE * 0.5 * math.pi
        # On the circle the velocity relative to the centre turns by that speed over the radius.
        self.course, turn = heading_for(course, 1.0, self.speed, drift)
        relative = norm(minus(scaled(along(self.course), self.speed), drift))
        self.heading_rate = turn * _CLOCKWISE * relative / radius

    def step(self) -> None:
        """Do nothing: the point is placed anew at every step."""


class CircleTracker:
    """Steers to the circle, ahead of time by the vehicle's lag; attributes as of
    ``gnc.tracker.Tracker``.

    Parameters
    ----------
    tracking : how a reference is tracked
    parameters : of the circle
    own, target : motion of the vehicle and of the vessel

    Attributes
    ----------
    radius : of the circle now [m]
    """

    __slots__ = (
        "_lag", "_law", "_limit", "_own", "_target", "_time_step", "ahead", "heading_rate_command", "heading_rate_demand",
        "radius", "reference", "saturated",
    )  # fmt: skip

    def __init__(
        self,
        tracking: TrackingParameters,
        parameters: StandoffParameters,
        own: OwnMotion,
        target: TargetMotion,
    ) -> None:
        self._own, self._target, self._time_step = own, target, tracking.time_step
        self.radius = parameters.radius + STANDOFF * parameters.tracked
        self._law = LimitedLaw(tracking.law, tracking.heading_rate_max, tracking.time_step)
        self._limit, self._lag = tracking.heading_rate_max, tracking.lag
        self.reference, self.ahead = CirclePoint(parameters.speed), CirclePoint(parameters.speed)
        self.heading_rate_demand = self.heading_rate_command = 0.0
        self.saturated = False

    def step(
        self, north: float, east: float, course: float, speed: float, heading_rate: float
    ) -> float:
        """Return the heading rate to command [rad/s]; parameters are those of
        ``gnc.tracker.Tracker``.

        Raises
        ------
        LawError : the law returned no number
        """
        own, target, reference, ahead = self._own, self._target, self.reference, self.ahead
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
            # The reference is where it will be at the next step, as that of any tracker.
            placed(reference, self._time_step)
        self.heading_rate_demand, self.heading_rate_command = demand, command
        self.saturated = command != demand
        return command


class StandoffOrbit:
    """Circles the vessel; attributes as of ``gnc.mission.mission.Mission``. The centre is the
    vessel.

    Parameters
    ----------
    parameters : of the mission
    tracking : of the tracker
    own, target : motion of the vehicle and of the vessel
    """

    __slots__ = (
        "_closing", "_egress", "_lag", "_own", "_parameters", "_plan_time", "_target", "airspeed", "altitude", "centre",
        "centre_error", "leaving", "mode", "started", "tracker",
    )  # fmt: skip

    def __init__(
        self,
        parameters: StandoffParameters,
        tracking: TrackingParameters,
        *,
        own: OwnMotion,
        target: TargetMotion,
    ) -> None:
        self._parameters, self._own, self._target, self._lag = parameters, own, target, tracking.lag
        self._plan_time = parameters.plan_interval * tracking.time_step
        self._closing = CLOSING_RATE * parameters.speed * self._plan_time
        self._egress = Egress(tracking.heading_rate_max)
        self.tracker = CircleTracker(tracking, parameters, own, target)
        self.centre = SteadyCentre(0.0, 0.0, 0.0)
        self.centre_error, self.leaving, self.started = (
            self.tracker.radius - parameters.radius,
            False,
            False,
        )
        self.airspeed, self.altitude, self.mode = (
            parameters.speed,
            parameters.altitude,
            Mode.APPROACH,
        )

    @property
    def in_place(self) -> bool:
        """Whether the circle has closed in."""
        return self.centre_error == 0.0

    @property
    def overriding(self) -> bool:
        """Whether ``command`` replaces the tracker's heading rate."""
        return self.leaving

    def plan(self, time: float) -> None:  # noqa: ARG002 - of the Protocol
        """Look whether the vessel can be circled, and whether the circle may close in."""
        p, own, target, tracker = self._parameters, self._own, self._target, self.tracker
        off = (
            math.hypot(own.ground_north - target.north, own.ground_east - target.east)
            - tracker.radius
        )
        if abs(off) < p.tracked and self.centre_error > 0.0:
            self.centre_error = max(0.0, self.centre_error - self._closing)
            tracker.radius = p.radius + self.centre_error
        ratio = (
            math.hypot(target.velocity_north - own.wind_north, target.velocity_east - own.wind_east)
            / p.speed
        )
        self.centre, self.started = SteadyCentre(0.0, 0.0, ratio), True
        if not self.leaving:
            self.mode = Mode.OUTRUN if ratio >= p.speed_ratio_max else Mode.TRACKING
            height = p.height.at(p.radius, ratio * p.speed)
            self.altitude = p.climb.step(self.altitude, height, p.speed, self._plan_time)

    def command(self, last_command: float) -> float:
        """Return the heading rate that leads away from the vessel [rad/s]."""
        own, target = self._own, self._target
        x, y = own.ground_north - target.north, own.ground_east - target.east
        course = own.course + 0.5 * self._lag * (own.heading_rate + last_command)
        return self._egress.command(x, y, course, own.heading_rate)

    def leave(self, fault: Fault) -> None:
        """Leave the vessel for good, because of a fault of the vehicle."""
        self.leaving = True
        self.mode = Mode.GLIDING if fault is Fault.THRUST_LOST else Mode.TERMINATING
        self.airspeed, self.altitude = self._parameters.glide_airspeed, GLIDE_ALTITUDE
