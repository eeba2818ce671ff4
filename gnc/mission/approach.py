"""The way to the centre of oscillation, round the keep-out area, and when it begins and ends."""

import math
from dataclasses import dataclass

from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.mission.transit import Transit
from gnc.numeric import limited, wrap

COURSE_GAIN = 2.0
"""Heading rate per course error off the reference, in units of omega_max [-]."""

_BLOCKED_WITHIN = 0.97
"""A way that comes closer to the vessel than this fraction of the centre's distance is not blocked
by the keep-out area [-].
"""

_LEFT_AT = 1.5
"""Distance from the centre at which tracking is given up, over that at which it begins [-]."""

_JOIN_ASPECT, _LEAVE_ASPECT = 1.2, 1.9
"""Bearing from the plume's axis within which tracking begins, and beyond which it is given up
[rad].
"""

LOST_TRACK = 3.0
"""Distance from the reference at which it no longer counts as tracked, over that at which it does
[-].
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class ApproachParameters:
    """How the way to the centre goes.

    Attributes
    ----------
    blocked_radius, round_radius : a way to the centre that comes closer to the vessel than the
        first goes round by the second [m]
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
    """Leads to the centre, and says when to track the reference instead.

    Parameters
    ----------
    parameters : of the way
    own, target : motion of the vehicle and of the vessel
    speed, heading_rate_max, lag : V_r, omega_max, and lag of the vehicle's heading rate behind its
        command [m/s, rad/s, s]
    time_step : of the guidance [s]
    """

    __slots__ = (
        "_held", "_join_distance", "_lag", "_limit", "_own", "_parameters", "_quarter_turn", "_target", "_time_step", "_transit",
    )  # fmt: skip

    def __init__(
        self,
        parameters: ApproachParameters,
        *,
        own: OwnMotion,
        target: TargetMotion,
        speed: float,
        heading_rate_max: float,
        lag: float,
        time_step: float,
    ) -> None:
        self._parameters, self._own, self._target = parameters, own, target
        self._limit, self._lag = heading_rate_max, lag
        self._transit, self._quarter_turn = (
            Transit(speed / heading_rate_max),
            0.5 * math.pi / heading_rate_max,
        )
        self._held, self._time_step, self._join_distance = 0.0, time_step, parameters.join_distance

    def course_ahead(self, last_command: float) -> float:
        """Return the course that the vehicle will have when a command acts [rad], after its last
        command [rad/s].
        """
        own = self._own
        return own.course + 0.5 * self._lag * (own.heading_rate + last_command)

    def command(
        self,
        centre_x: float,
        centre_y: float,
        last_command: float,
        *,
        additional_range: float,
        guarding: bool,
    ) -> float:
        """Return the heading rate that leads to the centre, round the vessel [rad/s].

        It turns to the nearer side. Where that leads through the course straight to the vessel, the
        keep-out guard may not let it through, and hold the vehicle on a course beside a fast vessel
        until it has fallen behind. After a quarter of a turn of that it flies abeam until it is as
        far off as it goes round the vessel, and turns then.

        Parameters
        ----------
        centre_x, centre_y : of oscillation, north and east of the vessel [m]
        last_command : of the heading rate [rad/s]
        additional_range : added to the radii of the keep-out area for now [m]
        guarding : whether the keep-out guard turns the vehicle away
        """
        p, own, target = self._parameters, self._own, self._target
        x, y = own.ground_north - target.north, own.ground_east - target.east
        to = self._transit.course(
            x,
            y,
            centre_x,
            centre_y,
            blocked_radius=min(
                p.blocked_radius + additional_range,
                _BLOCKED_WITHIN * math.hypot(centre_x, centre_y),
            ),
            round_radius=p.round_radius + additional_range,
            velocity_north=target.velocity_north - own.wind_north,
            velocity_east=target.velocity_east - own.wind_east,
            course=own.course,
            speed=own.speed,
        )
        course, near = (
            self.course_ahead(last_command),
            math.hypot(x, y) < p.round_radius + additional_range,
        )
        turn = wrap(to - course)
        side = math.copysign(1.0, turn)
        to_vessel = side * wrap(math.atan2(-y, -x) - course)
        self._held = (
            self._held + guarding * self._time_step if near and 0.0 < to_vessel < abs(turn) else 0.0
        )
        if self._held >= self._quarter_turn:
            turn = side * (to_vessel - 0.5 * math.pi)
        return limited(COURSE_GAIN * self._limit * turn, self._limit)

    def joins(
        self,
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
        centre_x, centre_y : of oscillation, north and east of the vessel [m]
        axis : course along which the plume trails [rad]
        error : distance from the reference [m]
        tracking : whether it is tracked
        guarding : whether the keep-out guard turns the vehicle away
        """
        p, own, target = self._parameters, self._own, self._target
        x, y = own.ground_north - target.north, own.ground_east - target.east
        off = math.hypot(centre_x - x, centre_y - y)
        aspect = abs(wrap(math.atan2(y, x) - axis))
        if not tracking:
            held = guarding or self._held >= self._quarter_turn
            return off < self._join_distance and aspect < _JOIN_ASPECT and not held
        held_off = guarding and error > LOST_TRACK * p.tracked
        return off < _LEFT_AT * p.join_distance and aspect < _LEAVE_ASPECT and not held_off

    def join_nearer(self) -> None:
        """Let tracking begin from half as far as before: the keep-out guard has just ended it, and
        would do so again.
        """
        p = self._parameters
        self._join_distance = max(
            0.5 * self._join_distance, min(LOST_TRACK * p.tracked, p.join_distance)
        )
