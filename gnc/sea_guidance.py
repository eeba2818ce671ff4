"""The outer loop over a real sea: from what the sensors and the vessel say to commanded heading rate and airspeed.

Everything is posed in the frame of the estimated air mass (paper-notes, 12), where the vehicle flies at its airspeed and the plume
trails behind the vessel. A reference oscillates about a centre that follows the vessel; on the way to it the vehicle is steered
round the keep-out area; whatever is asked for passes the keep-out guard.
"""

import math

from gnc.airspeed.pace_hold import airspeed_to_hold
from gnc.estimation.health import Fault, Health
from gnc.estimation.navigation import Navigation
from gnc.estimation.vessel_filter import VesselFilter, VesselMotion
from gnc.mission.transit import Transit
from gnc.numeric import limited, wrap
from gnc.reference.mean_motion import mean_motion
from gnc.reference.moving_centre import MovingCentre
from gnc.reference.steered import SteeredReference
from gnc.safety.keepout_guard import KeepoutGuard
from gnc.sea_parameters import Mode, SeaParameters
from gnc.tracker import Guidance

_TRANSIT_GAIN = 2.0
"""Heading rate per course error on the way to the reference, in units of omega_max [-]."""

_EITHER_WAY = 0.95 * math.pi
"""Course left to turn beyond which it is as far either way, and the turn that is flown already is the quicker one [rad]."""

_EARLY = 0.6
"""Share of the age at which vessel data are stale from which the orbit moves off already [-]."""

_FLEEING_SHARE = 0.8
"""Share of the speed that the vehicle has over the vessel at which it keeps further off a silent one [-]."""

_MANOEUVRE_ROOM, _STEADY = 200.0, 0.03
"""Distance that the orbit is moved off per acceleration of the vessel [s^2], and what its reports scatter by [m/s^2]."""

_UNCONTROLLED = 0.8
"""Mean difference of heading rate from what was asked for, over omega_max, at which control counts as lost [-].

Severe turbulence makes it up to 0.58, over 28 flights of 500 s that stayed in control.
"""

_HEALTH_INTERVAL = 4
"""Guidance steps between looks at the vehicle's health."""

_PATIENCE = 2.0
"""Time constant of the means by which trouble is found [s]."""

_STUCK, _SERVO_PATIENCE = 0.1, 0.1
"""Mean error of a control surface, over its travel [-], at which it counts as stuck, and time constant of that mean [s].

Of sound ones it is up to 0.03, in severe and in light turbulence.
"""

_DEEP = -1000.0
"""Altitude that a gliding vehicle is told [m]: so far below that the autopilot holds its airspeed by pitch, and sinks."""


_MODES = {mode: i for i, mode in enumerate(Mode)}


class SeaGuidance:
    """The outer loop of one flight, stepped at a fixed rate.

    Parameters
    ----------
    parameters : of the loop
    vessel : the filter of its motion, which has had its first report; further ones go straight to it
    guard : of the keep-out area, or none

    Attributes
    ----------
    navigation, vessel, centre, guard : what it consists of
    guidance : the tracking law, from the first step on
    reference : its steered reference, ahead of time by the preview
    mode : what it is doing
    heading_rate_command, airspeed_command, altitude_command : last commands [rad/s, m/s, m]
    health : of the vehicle
    vessel_north, vessel_east : where the vessel is taken to be [m]
    centre_error : how far the orbit's centre is from where it should be [m]
    """

    __slots__ = (
        "_away_side", "_closing_in", "_further", "_limit", "_orbit_further", "_parameters", "_speed", "_steps", "_time_step",
        "_tracking", "_transit", "_troubled", "_vessel_gain_east", "_vessel_gain_north", "_vessel_v_east", "_vessel_v_north",
        "airspeed_command", "altitude_command", "centre", "centre_error", "guard", "guidance", "heading_rate_command", "health",
        "mode", "navigation", "reference", "vessel", "vessel_east", "vessel_north",
    )  # fmt: skip

    def __init__(self, parameters: SeaParameters, vessel: VesselFilter, guard: KeepoutGuard | None) -> None:
        self._parameters = parameters
        self._speed = parameters.centre.speed
        self.navigation = Navigation(parameters.navigation)
        self.vessel = vessel
        self.centre = MovingCentre(parameters.centre)
        self.guard = guard
        self._transit = Transit(self._speed / parameters.guidance.heading_rate_max)
        self._limit, self._time_step = parameters.guidance.heading_rate_max, parameters.guidance.time_step
        self._tracking = self._closing_in = self._troubled = False
        self._vessel_gain_north = self._vessel_gain_east = 0.0
        self._further = self._orbit_further = self._away_side = 0.0
        self._steps = 0
        self.vessel_north = self.vessel_east = self._vessel_v_north = self._vessel_v_east = self.centre_error = 0.0
        self.mode = Mode.APPROACH
        self.heading_rate_command = 0.0
        self.airspeed_command = self._speed
        self.altitude_command = parameters.altitude
        self.health = Health(
            airspeed_error=parameters.powerless,
            heading_rate_error=_UNCONTROLLED * parameters.guidance.heading_rate_max,
            servo_error=_STUCK,
            lag=parameters.guidance.lag,
            time_step=_HEALTH_INTERVAL * parameters.guidance.time_step,
            patience=_PATIENCE,
            servo_patience=_SERVO_PATIENCE,
        )
        self.guidance: Guidance[SteeredReference]
        self.reference: SteeredReference

    @property
    def mode_number(self) -> int:
        """Return the mode's place among all modes."""
        return _MODES[self.mode]

    @property
    def in_place(self) -> bool:
        """Return whether the centre is as near as it will come."""
        return self._closing_in and self.centre.in_place

    def step(
        self,
        time: float,
        position: tuple[float, float, float, float] | None,
        airspeed: float,
        heading: float,
        roll: float,
        heading_rate: float,
        servo_error: float = 0.0,
    ) -> None:
        """Compute the commands from what is sensed now, then move the reference on by one time step.

        Parameters
        ----------
        time : [s]
        position : north, east [m], north and east velocity over the ground [m/s], if there is satellite navigation
        airspeed, heading, roll : measured [m/s, rad, rad]
        heading_rate : of the course through the air [rad/s]
        servo_error : of the control surface that is farthest from what it was told, over its travel [-]
        """
        p, navigation, step = self._parameters, self.navigation, self._steps
        self._steps += 1
        navigation.update(position, airspeed, heading, roll)
        if step % p.plan_interval == 0:
            self._look(time)
        else:
            self.vessel_north += self._time_step * self._vessel_v_north
            self.vessel_east += self._time_step * self._vessel_v_east
            self._vessel_v_north += self._vessel_gain_north
            self._vessel_v_east += self._vessel_gain_east
        wind, guidance, guard = navigation.wind, self.guidance, self.guard
        wind_north, wind_east = wind.north, wind.east
        v_north, v_east = navigation.velocity_north - wind_north, navigation.velocity_east - wind_east
        course, speed = math.atan2(v_east, v_north), math.hypot(v_north, v_east)
        x, y = navigation.north - self.vessel_north, navigation.east - self.vessel_east
        away_north, away_east = self._vessel_v_north - wind_north, self._vessel_v_east - wind_east
        north, east = navigation.north - navigation.drift_north, navigation.east - navigation.drift_east
        reference, tracking = guidance.reference, self._tracking
        reference_north, reference_east, reference_course = reference.north, reference.east, reference.course
        # The autopilot turns against the gusty air, the guidance over the mean air: ``gnc.airspeed.pace_hold.air_turn``.
        faster = max(airspeed, 1.0) / max(speed, 1.0)
        if step % _HEALTH_INTERVAL == 0:
            self._watch(airspeed, heading_rate, servo_error)
        heading_rate *= faster
        guidance.step(north, east, course, speed, heading_rate)
        command = guidance.heading_rate_command
        if self._troubled:
            command = self._away(x, y, course, heading_rate)
        elif not tracking:
            command = self._to_centre(x, y, away_north, away_east, course, speed, heading_rate)
        if guard is not None:
            # A turn away is flown at V_r at least: see ``gnc.tracker``.
            turning = speed if speed > self._speed else self._speed
            command = guard.limit(
                command, x, y, away_north, away_east, course, turning, heading_rate, radius_inflation=self._further
            )
        guidance.heading_rate_command = command
        command /= faster
        limit = self._limit
        self.heading_rate_command = command if -limit <= command <= limit else math.copysign(limit, command)
        if self._troubled:
            self.airspeed_command, self.altitude_command = p.glide_airspeed, _DEEP
        elif tracking:
            along = (reference_north - north) * math.cos(reference_course) + (reference_east - east) * math.sin(reference_course)
            pace = airspeed_to_hold(p.hold, along=along, reference_speed=self._speed, speed=speed, airspeed=airspeed)
            self.airspeed_command = pace
        elif guard is not None and guard.intervening:
            pace = airspeed_to_hold(p.hold, along=0.0, reference_speed=self._speed, speed=speed, airspeed=airspeed)
            self.airspeed_command = pace
        else:
            self.airspeed_command = p.transit_airspeed

    def _watch(self, airspeed: float, heading_rate: float, servo_error: float) -> None:
        """Look whether the vehicle does as it is told; from the first trouble on it leaves."""
        # An aircraft that is still speeding up beyond V_r lacks nothing.
        lack = min(self.airspeed_command, self._speed) - airspeed
        fault = self.health.check(lack, airspeed, heading_rate, self.heading_rate_command, servo_error)
        if fault is not Fault.NONE:
            self._troubled = True
            self.mode = Mode.GLIDING if fault is Fault.THRUST_LOST else Mode.TERMINATING

    def _away(self, x: float, y: float, course: float, heading_rate: float) -> float:
        """Return the heading rate that leads straight away from the vessel [rad/s].

        From a course towards it either turn would do, and the vehicle keeps to the one that it has begun: to decide at every step
        would lead straight on.
        """
        limit = self._parameters.guidance.heading_rate_max
        ahead = course + 0.5 * self._parameters.guidance.lag * (heading_rate + self.guidance.heading_rate_command)
        left = wrap(math.atan2(y, x) - ahead)
        if abs(left) < 0.5 * math.pi:
            self._away_side = 0.0
            return limited(_TRANSIT_GAIN * limit * left, limit)
        if not self._away_side:
            self._away_side = math.copysign(1.0, heading_rate if abs(left) > _EITHER_WAY else left)
        return self._away_side * limit

    def _to_centre(
        self, x: float, y: float, away_north: float, away_east: float, course: float, speed: float, heading_rate: float
    ) -> float:
        """Return the heading rate that leads to the centre of oscillation, round the vessel [rad/s]."""
        p, centre = self._parameters, self.centre
        to = self._transit.course(
            x,
            y,
            centre.x,
            centre.y,
            blocked_radius=min(p.blocked_radius + self._further, 0.97 * centre.distance),
            round_radius=p.round_radius + self._further,
            velocity_north=away_north,
            velocity_east=away_east,
            course=course,
            speed=speed,
        )
        limit = p.guidance.heading_rate_max
        ahead = course + 0.5 * p.guidance.lag * (heading_rate + self.guidance.heading_rate_command)
        return limited(_TRANSIT_GAIN * limit * wrap(to - ahead), limit)

    def _look(self, time: float) -> None:
        """Look where the vessel is, move the centre, steer the reference, and decide what to do."""
        p, navigation, centre = self._parameters, self.navigation, self.centre
        vessel = self.vessel.at(time)
        self.vessel_north, self.vessel_east = vessel.north, vessel.east
        self._vessel_v_north, self._vessel_v_east = vessel.velocity_north, vessel.velocity_east
        self._vessel_gain_north = self._time_step * vessel.acceleration_north
        self._vessel_gain_east = self._time_step * vessel.acceleration_east
        started = self._steps > 1
        time_step = p.plan_interval * p.guidance.time_step if started else 0.0
        age = time - self.vessel.time
        self._open(time_step, age)
        centre.move(
            time_step,
            vessel_north=vessel.velocity_north,
            vessel_east=vessel.velocity_east,
            acceleration_north=vessel.acceleration_north,
            acceleration_east=vessel.acceleration_east,
            wind_north=navigation.wind.north,
            wind_east=navigation.wind.east,
            additional_range=self._orbit_further + (0.0 if self._closing_in else p.standoff) + self._manoeuvre_room(vessel),
        )
        if not started:
            self._start_reference(vessel)
        self._steer(vessel)
        self._decide(vessel)
        if self._troubled:
            pass
        elif navigation.lost > 0.0:
            self.mode = Mode.DEAD_RECKONING
        elif age > p.stale:
            self.mode = Mode.HOLDING
        elif centre.speed_ratio >= p.speed_ratio_max:
            self.mode = Mode.OUTRUN
        elif not centre.plume_known:
            self.mode = Mode.NO_PLUME
        else:
            self.mode = Mode.TRACKING if self._tracking else Mode.APPROACH

    def _open(self, time_step: float, age: float) -> None:
        """Keep further off while the vessel may be elsewhere, by no more than the vehicle can flee, until it is heard again.

        The orbit begins to move off before the guard asks for it.
        """
        p, lost = self._parameters, self.navigation.lost
        fleeing = _FLEEING_SHARE * max(0.05, 1.0 - self.centre.speed_ratio) * self._speed
        opening = min(p.vessel_acceleration * age, fleeing) * time_step
        reckoned = p.drift_rate * lost
        self._further = self._further + opening if age > p.stale else reckoned
        self._orbit_further = self._orbit_further + opening if age > _EARLY * p.stale else reckoned

    def _manoeuvre_room(self, vessel: VesselMotion) -> float:
        """Return how much further off the orbit stays while the vessel manoeuvres: its centre follows late [m]."""
        manoeuvring = math.hypot(vessel.acceleration_north, vessel.acceleration_east)
        return _MANOEUVRE_ROOM * max(0.0, manoeuvring - _STEADY)

    def _start_reference(self, vessel: VesselMotion) -> None:
        """Place the reference on the centre of oscillation."""
        p, centre = self._parameters, self.centre
        reference = SteeredReference(
            north=vessel.north - self.navigation.drift_north + centre.x,
            east=vessel.east - self.navigation.drift_east + centre.y,
            mean_course=math.atan2(centre.velocity_east, centre.velocity_north),
            speed_ratio=min(centre.speed_ratio, p.speed_ratio_max),
            phase=0.0,
            speed=self._speed,
            heading_rate=p.reference_heading_rate,
            roll_rate_max=p.roll_rate_max,
            time_step=p.guidance.time_step,
        )
        self.guidance = Guidance(p.guidance, reference)
        self.reference = self.guidance.ahead

    def _steer(self, vessel: VesselMotion) -> None:
        """Steer the reference's mean velocity so that its orbit is where it should be."""
        p, navigation, centre = self._parameters, self.navigation, self.centre
        lag = p.guidance.lag
        orbit_north, orbit_east = self.reference.centre()
        off_north = vessel.north - navigation.drift_north + centre.x + lag * centre.velocity_north - orbit_north
        off_east = vessel.east - navigation.drift_east + centre.y + lag * centre.velocity_east - orbit_east
        self.centre_error = math.hypot(off_north, off_east)
        mean_course, speed_ratio = mean_motion(centre, off_north, off_east, self._speed, p.guidance.heading_rate_max)
        self.reference.steer(mean_course, min(speed_ratio, p.speed_ratio_max))

    def _decide(self, vessel: VesselMotion) -> None:
        """Decide whether to track the reference, and whether the orbit may close in."""
        p, navigation, centre = self._parameters, self.navigation, self.centre
        x, y = navigation.north - vessel.north, navigation.east - vessel.east
        off = math.hypot(centre.x - x, centre.y - y)
        aspect = abs(wrap(math.atan2(y, x) - centre.axis))
        to_north = self.guidance.reference.north + navigation.drift_north - navigation.north
        to_east = self.guidance.reference.east + navigation.drift_east - navigation.east
        error = math.hypot(to_north, to_east)
        if self._tracking:
            held_off = self.guard is not None and self.guard.intervening and error > 3.0 * p.tracked
            self._tracking = off < 1.5 * p.join_distance and aspect < 1.9 and not held_off
        else:
            clear = self.guard is None or not self.guard.intervening
            self._tracking = off < p.join_distance and aspect < 1.2 and clear
        self._closing_in = self._tracking and error < (3.0 if self._closing_in else 1.0) * p.tracked
