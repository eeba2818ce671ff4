"""The way to the centre of oscillation, round the keep-out area, and the way out."""

import math
from dataclasses import dataclass

from gnc.estimation.health import Fault
from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.mission.mission import Mode, Order
from gnc.numeric import limited, wrap
from gnc.tracker import TrackingParameters

COURSE_GAIN = 2.0
"""Heading rate per course error off the reference, in units of omega_max [-]."""

LOST_TRACK = 3.0
"""Distance at which the reference counts as lost, over that at which it counts as tracked [-]."""

_GLIDE_ALTITUDE = -1000.0
"""Altitude commanded in a glide [m], so low that the autopilot holds its airspeed by pitch."""

_BLOCKED_WITHIN = 0.97
"""Largest radius of the blocked area, over the centre's distance from the vessel [-]."""

_GIVEN_UP_AT = 1.5
"""Distance from the centre at which tracking is given up, over that at which it begins [-]."""

_JOIN_ASPECT = 1.2
"""Bearing from the plume's axis within which tracking begins [rad]."""

_LEAVE_ASPECT = 1.9
"""Bearing from the plume's axis beyond which tracking is given up [rad]."""

_OUTWARD = 0.6
"""Outward lean of the way, a turn radius or more inside of the circle by which to go round [rad].

With less, a vehicle near the keep-out area would go along it all the way round, and the guard would
turn it away all the time.
"""

_EITHER_WAY = 0.95 * math.pi
"""Course left to turn beyond which the vehicle keeps to the side that it turns to [rad]."""


def course_ahead(own: OwnMotion, last_command: float, lag: float) -> float:
    """Return the vehicle's course when a command begins to act [rad].

    Parameters
    ----------
    own : the vehicle's motion
    last_command : of the heading rate [rad/s]
    lag : of the heading rate behind its command [s]
    """
    return own.course + 0.5 * lag * (own.heading_rate + last_command)


class Transit:
    """Courses to a place beside a moving disc, round the disc where it is in the way.

    Relative to the disc, the way is a straight line to the target or, where that is blocked, a
    tangent of a circle about the disc, on the shorter side. The vehicle heads so that its velocity
    relative to the disc lies along that way.

    Parameters
    ----------
    turn_radius : of the vehicle; the cost of its turns when a side is chosen [m]

    Attributes
    ----------
    side : 1 while the disc is passed clockwise as seen from above, -1 the other way, 0 while
        nothing is in the way
    """

    def __init__(self, turn_radius: float) -> None:
        self._turn_radius = turn_radius
        self.side = 0

    def course(
        self,
        x: float,
        y: float,
        target_x: float,
        target_y: float,
        *,
        blocked_radius: float,
        round_radius: float,
        velocity_north: float,
        velocity_east: float,
        course: float,
        speed: float,
    ) -> float:
        """Return the course to fly [rad].

        Parameters
        ----------
        x, y : of the vehicle, north and east of the disc's centre [m]
        target_x, target_y : of the target, which moves with the disc [m]
        blocked_radius : a straight way that comes closer is blocked; below the target's distance
            [m]
        round_radius : of the circle by which to go round [m]
        velocity_north, velocity_east : of the disc in the frame in which the vehicle flies at
            ``speed`` [m/s]
        course, speed : of the vehicle, which is faster than the disc [rad, m/s]
        """
        if _way_is_clear(x, y, target_x, target_y, blocked_radius):
            self.side = 0
            way = math.atan2(target_y - y, target_x - x)
        else:
            bearing = math.atan2(y, x)
            distance = math.hypot(x, y)
            if distance > round_radius:
                lean = math.asin(round_radius / distance)
            else:
                inside = min(1.0, (round_radius - distance) / self._turn_radius)
                lean = 0.5 * math.pi + _OUTWARD * inside
            if self.side == 0:
                self.side = self._shorter_side(
                    bearing, lean, math.atan2(target_y, target_x), course, round_radius
                )
            way = bearing + math.pi - self.side * lean
        across = velocity_east * math.cos(way) - velocity_north * math.sin(way)
        return way + math.asin(limited(across / speed, 1.0))

    def _shorter_side(
        self, bearing: float, lean: float, target_bearing: float, course: float, radius: float
    ) -> int:
        clockwise = (target_bearing - bearing) % (2.0 * math.pi)
        lengths = {}
        for side, angle in ((1, clockwise), (-1, 2.0 * math.pi - clockwise)):
            turn = abs(wrap(bearing + math.pi - side * lean - course))
            lengths[side] = radius * angle + 2.0 * self._turn_radius * turn
        return 1 if lengths[1] <= lengths[-1] else -1


def _way_is_clear(x: float, y: float, target_x: float, target_y: float, radius: float) -> bool:
    """Return whether a straight way keeps ``radius`` from the origin, or leads outwards at once."""
    to_x = target_x - x
    to_y = target_y - y
    inward = -(x * to_x + y * to_y)
    if inward <= 0.0:
        return True
    fraction = min(1.0, inward / (to_x * to_x + to_y * to_y))
    return math.hypot(x + fraction * to_x, y + fraction * to_y) >= radius


@dataclass(frozen=True, slots=True, kw_only=True)
class ApproachParameters:
    """Parameters of the way to the centre.

    Attributes
    ----------
    blocked_radius : a straight way to the centre that comes closer to the vessel is blocked [m]
    round_radius : of the circle by which it then goes round [m]
    join_distance : from the centre, within which the reference is tracked [m]
    tracked : distance from the reference that counts as tracked [m]
    airspeed : on the way [m/s]
    """

    blocked_radius: float
    round_radius: float
    join_distance: float
    tracked: float
    airspeed: float


class Approach:
    """Leads to the centre of oscillation, and decides when to track the reference instead.

    Parameters
    ----------
    parameters : of the way
    tracking : of the reference that it leads to
    speed : V_r [m/s]
    """

    def __init__(
        self, parameters: ApproachParameters, tracking: TrackingParameters, speed: float
    ) -> None:
        self._parameters = parameters
        self._heading_rate_max = tracking.heading_rate_max
        self._lag = tracking.lag
        self._time_step = tracking.time_step
        self._transit = Transit(speed / tracking.heading_rate_max)
        self._quarter_turn = 0.5 * math.pi / tracking.heading_rate_max
        self._join_distance = parameters.join_distance
        # Time for which the guard has blocked the turn through the course to the vessel [s].
        self._blocked_for = 0.0

    def command(
        self,
        own: OwnMotion,
        vessel: TargetMotion,
        centre_x: float,
        centre_y: float,
        last_command: float,
        *,
        additional_range: float,
        guarding: bool,
    ) -> float:
        """Return the heading rate that leads to the centre, round the vessel [rad/s].

        It turns to the nearer side. Where that leads through the course straight to the vessel, the
        keep-out guard may block the turn, and hold the vehicle on a course beside a fast vessel
        until the vehicle has fallen behind. If this lasts for the time of a quarter turn, the
        vehicle flies abeam out to the radius by which it goes round the vessel, and turns then.

        Parameters
        ----------
        own, vessel : motion of the vehicle and of the vessel
        centre_x, centre_y : of oscillation, north and east of the vessel [m]
        last_command : of the heading rate [rad/s]
        additional_range : temporary addition to the radii of the keep-out area [m]
        guarding : whether the keep-out guard turns the vehicle away
        """
        p = self._parameters
        x = own.ground_north - vessel.north
        y = own.ground_east - vessel.east
        round_radius = p.round_radius + additional_range
        to = self._transit.course(
            x,
            y,
            centre_x,
            centre_y,
            blocked_radius=min(
                p.blocked_radius + additional_range,
                _BLOCKED_WITHIN * math.hypot(centre_x, centre_y),
            ),
            round_radius=round_radius,
            velocity_north=vessel.velocity_north - own.wind_north,
            velocity_east=vessel.velocity_east - own.wind_east,
            course=own.course,
            speed=own.speed,
        )
        course = course_ahead(own, last_command, self._lag)
        turn = wrap(to - course)
        side = math.copysign(1.0, turn)
        to_vessel = side * wrap(math.atan2(-y, -x) - course)
        if math.hypot(x, y) < round_radius and 0.0 < to_vessel < abs(turn):
            self._blocked_for += guarding * self._time_step
        else:
            self._blocked_for = 0.0
        if self._blocked_for >= self._quarter_turn:
            turn = side * (to_vessel - 0.5 * math.pi)
        return limited(COURSE_GAIN * self._heading_rate_max * turn, self._heading_rate_max)

    def should_track(
        self,
        own: OwnMotion,
        vessel: TargetMotion,
        centre_x: float,
        centre_y: float,
        axis: float,
        *,
        error: float,
        tracking: bool,
        guarding: bool,
    ) -> bool:
        """Return whether to track the reference.

        Parameters
        ----------
        own, vessel : motion of the vehicle and of the vessel
        centre_x, centre_y : of oscillation, north and east of the vessel [m]
        axis : course along which the plume trails [rad]
        error : distance from the reference [m]
        tracking : whether it is tracked already
        guarding : whether the keep-out guard turns the vehicle away
        """
        p = self._parameters
        x = own.ground_north - vessel.north
        y = own.ground_east - vessel.east
        off = math.hypot(centre_x - x, centre_y - y)
        aspect = abs(wrap(math.atan2(y, x) - axis))
        if not tracking:
            blocked = guarding or self._blocked_for >= self._quarter_turn
            return off < self._join_distance and aspect < _JOIN_ASPECT and not blocked
        thrown_off = guarding and error > LOST_TRACK * p.tracked
        near = off < _GIVEN_UP_AT * p.join_distance
        return near and aspect < _LEAVE_ASPECT and not thrown_off

    def halve_join_distance(self) -> None:
        """Halve the distance at which tracking begins, after the keep-out guard has ended it.

        From the same distance, the guard would end it again.
        """
        p = self._parameters
        least = min(LOST_TRACK * p.tracked, p.join_distance)
        self._join_distance = max(0.5 * self._join_distance, least)


class Egress:
    """Leads straight away from the vessel, for a vehicle that has to leave.

    From a course towards the vessel either turn would do, and the vehicle keeps to the turn that it
    has begun: a new decision at every step would lead straight on.

    Parameters
    ----------
    tracking : of the reference that is left
    speed : V_r, the speed of a retreat at constant height [m/s]
    glide_airspeed : of a sinking vehicle, midway between V_r and the slowest commanded airspeed
        [m/s]
    """

    def __init__(self, tracking: TrackingParameters, speed: float, glide_airspeed: float) -> None:
        self._heading_rate_max = tracking.heading_rate_max
        self._lag = tracking.lag
        self._speed = speed
        self._glide_airspeed = glide_airspeed
        self._gliding = False
        self._side = 0.0

    def order(
        self,
        fault: Fault,
        own: OwnMotion,
        vessel: TargetMotion,
        last_command: float,
        altitude: float,
    ) -> Order:
        """Return the order to leave, for a vehicle with a fault.

        Without thrust the vehicle holds its height for as long as its speed lasts, and commands the
        throttle that this takes: if thrust is there, the command shows it. A glide to the sea is
        the last resort, when the speed over the mean air has fallen to that of the glide, or the
        airspeed to the slowest commanded one.

        Parameters
        ----------
        fault : of the vehicle
        own, vessel : motion of the vehicle and of the vessel
        last_command : of the heading rate [rad/s]
        altitude : of the mission [m]
        """
        command = self.command(own, vessel, last_command)
        if fault is not Fault.THRUST_LOST:
            return Order(command, self._glide_airspeed, _GLIDE_ALTITUDE, Mode.TERMINATING)
        # A gust is no reason to glide while it leaves an airspeed that may be commanded, which goes
        # as far below that of the glide as V_r is above it.
        slow = own.speed < self._glide_airspeed or (
            own.airspeed < 2.0 * self._glide_airspeed - self._speed
        )
        self._gliding = self._gliding or slow
        if self._gliding:
            return Order(command, self._glide_airspeed, _GLIDE_ALTITUDE, Mode.GLIDING)
        return Order(command, self._speed, altitude, Mode.RETREATING)

    def reset(self) -> None:
        """Forget the turn and the glide that have begun: the fault is over."""
        self._side = 0.0
        self._gliding = False

    def command(self, own: OwnMotion, vessel: TargetMotion, last_command: float) -> float:
        """Return the heading rate to fly [rad/s].

        Parameters
        ----------
        own, vessel : motion of the vehicle and of the vessel
        last_command : of the heading rate [rad/s]
        """
        x = own.ground_north - vessel.north
        y = own.ground_east - vessel.east
        to_turn = wrap(math.atan2(y, x) - course_ahead(own, last_command, self._lag))
        if abs(to_turn) < 0.5 * math.pi:
            self._side = 0.0
            return limited(COURSE_GAIN * self._heading_rate_max * to_turn, self._heading_rate_max)
        if not self._side:
            turn = own.heading_rate if abs(to_turn) > _EITHER_WAY else to_turn
            self._side = math.copysign(1.0, turn)
        return self._side * self._heading_rate_max
