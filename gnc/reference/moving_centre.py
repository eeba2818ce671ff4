"""Position and motion of the centre of oscillation beside a manoeuvring vessel.

The centre lies on the plume's axis, at a distance from the vessel that keeps the whole orbit out of
the keep-out area. The axis turns with the vessel, or with the vessel's motion through the air: a
turning vessel moves the centre by omega_V x r_CO. The frame is that of the air mass.
"""

import math
from dataclasses import dataclass

from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.numeric import clip, limited, wrap

_AXIS_GAIN = 0.1
"""Rate of the axis over its angle from the demanded direction, in units of omega_max [-].

The rate is low enough to average the scatter of the vessel's reports.
"""

_IN_PLACE = 0.04
"""Largest error of the centre's distance that counts as in place, over r_CO [-]."""

_AXIS_SPEED_FRACTION = 0.7
"""Largest speed of the centre about the vessel, over the speed of the following vehicle [-]."""

_DISTANCE_GAIN = 0.12
"""Rate of the centre's distance over its error, in units of omega_max [-]."""

_DISTANCE_SPEED_FRACTION = 0.3
"""Largest rate of the centre's distance, over the vehicle's excess speed [-]."""

_RECEDING_SPEED_FRACTION = 0.9
"""Largest speed of a receding centre, over the speed of the following vehicle [-]."""

_VESSEL_SPEED_MIN = 0.1
"""Least speed over ground at which a vessel's turn is computed [m/s]."""

_EXCESS_SPEED_MIN = 0.05
"""Least assumed excess speed of the vehicle over the vessel, over V_r [-]."""

_SWING_MEMORY = 40.0
"""Time over which a swing is averaged [s], to remove the scatter of reports."""

_CENTRE_SPEED_MIN = 0.01
"""Least speed at which the centre's direction is computed [m/s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CentreParameters:
    """Parameters of the centre's position.

    Attributes
    ----------
    distance_min : least distance of the orbit from the vessel [m]
    speed_ratio_max : largest speed ratio in the table of half-widths [-]
    along, across : |d_x|max and |d_y|max of the orbit, equation (12), at equal steps of nu from 0
        [m]
    plume_heading : chi_P from the vessel's bow [rad], or None if the plume trails behind the
        vessel's motion through the air
    vessel_course : initial course, in which the bow of a vessel at rest points; only with a plume
        heading [rad]
    apparent_wind_min : apparent wind below which the plume's direction counts as unknown, and
        ground speed below which the vessel's course does [m/s]
    speed, heading_rate_max : V_r and omega_max [m/s, rad/s]
    """

    distance_min: float
    speed_ratio_max: float
    along: tuple[float, ...]
    across: tuple[float, ...]
    plume_heading: float | None
    vessel_course: float
    apparent_wind_min: float
    speed: float
    heading_rate_max: float


class MovingCentre:
    """The centre of oscillation, moved in time steps.

    Attributes
    ----------
    x, y : position north and east of the vessel [m]
    velocity_north, velocity_east : velocity in the frame of the air mass [m/s]
    axis : direction in which the plume trails, in that frame [rad]
    distance : r_CO [m]
    speed_ratio : nu, the vessel's airspeed over the vehicle's speed [-]
    receding : rate of the distance [m/s]
    swing : velocity from turning about the vessel, to the right of the axis [m/s]
    steady_swing : time average of the swing [m/s]
    in_place : whether the distance is as demanded
    plume_known : whether the apparent wind is strong enough to give the plume's direction
    """

    def __init__(self, parameters: CentreParameters) -> None:
        self._parameters = parameters
        self._started = False
        self.axis = math.pi
        self.distance = 0.0
        self.x = 0.0
        self.y = 0.0
        self.velocity_north = 0.0
        self.velocity_east = 0.0
        self.speed_ratio = 0.0
        self.receding = 0.0
        self.swing = 0.0
        self.steady_swing = 0.0
        self._mean_swing = 0.0
        self.plume_known = True
        self.in_place = True

    def move(
        self,
        time_step: float,
        own: OwnMotion,
        vessel: TargetMotion,
        *,
        additional_range: float,
        additional_rate: float = 0.0,
        bearing: float = 0.0,
    ) -> None:
        """Move the centre by one ``time_step`` [s].

        Parameters
        ----------
        own, vessel : wind measured by the vehicle, and motion of the vessel
        additional_range : temporary addition to r_CO [m]
        additional_rate : rate of the additional range [m/s]
        bearing : angle of the plume to the right of its computed direction [rad]
        """
        p = self._parameters
        air_north = vessel.velocity_north - own.wind_north
        air_east = vessel.velocity_east - own.wind_east
        through_air = math.hypot(air_north, air_east)
        self.speed_ratio = through_air / p.speed
        demanded, turn = self._trailing(vessel, air_north, air_east, through_air, bearing)
        if not self._started:
            self._started = True
            self.axis = demanded
            self.distance = self._target(air_north, air_east) + additional_range
        # The axis turns at the trailing plume's rate, plus a rate towards its demand.
        fastest = _AXIS_SPEED_FRACTION * p.speed / self.distance
        turn = limited(turn + _AXIS_GAIN * p.heading_rate_max * wrap(demanded - self.axis), fastest)
        # The centre recedes or approaches until the orbit across its motion just keeps out.
        swing = turn * self.distance
        swung_north = air_north - swing * math.sin(self.axis)
        swung_east = air_east + swing * math.cos(self.axis)
        target = self._target(swung_north, swung_east) + additional_range
        excess = max(_EXCESS_SPEED_MIN, 1.0 - self.speed_ratio)
        fastest = _DISTANCE_SPEED_FRACTION * excess * p.speed
        recede = limited(_DISTANCE_GAIN * p.heading_rate_max * (target - self.distance), fastest)
        if additional_rate > 0.0:
            along = air_north * math.cos(self.axis) + air_east * math.sin(self.axis)
            across = through_air * through_air - along * along
            most = math.sqrt(max(0.0, (_RECEDING_SPEED_FRACTION * p.speed) ** 2 - across)) - along
            recede = max(recede, min(recede + additional_rate, most))
        self.axis = wrap(self.axis + turn * time_step)
        self.distance += recede * time_step
        self.receding = recede
        self.in_place = abs(target - self.distance) < _IN_PLACE * target
        self.swing = turn * self.distance
        self._mean_swing += (
            (self.swing - self._mean_swing) * time_step / (time_step + _SWING_MEMORY)
        )
        self.steady_swing = clip(self._mean_swing, min(self.swing, 0.0), max(self.swing, 0.0))
        cos_a = math.cos(self.axis)
        sin_a = math.sin(self.axis)
        self.x = self.distance * cos_a
        self.y = self.distance * sin_a
        self.velocity_north = air_north + recede * cos_a - turn * self.y
        self.velocity_east = air_east + recede * sin_a + turn * self.x

    def _trailing(
        self,
        vessel: TargetMotion,
        air_north: float,
        air_east: float,
        through_air: float,
        bearing: float,
    ) -> tuple[float, float]:
        """Return the direction in which the plume trails [rad], and its rate [rad/s].

        If the course of vessel or wind is unknown, the axis stays.
        """
        p = self._parameters
        north = vessel.acceleration_north
        east = vessel.acceleration_east
        if p.plume_heading is None:
            self.plume_known = through_air >= p.apparent_wind_min
            if self.plume_known:
                turn = (air_north * east - air_east * north) / through_air**2
                return math.atan2(-air_east, -air_north) + bearing, turn
        else:
            over_ground = math.hypot(vessel.velocity_north, vessel.velocity_east)
            if over_ground >= p.apparent_wind_min:
                course = math.atan2(vessel.velocity_east, vessel.velocity_north)
                turn = (vessel.velocity_north * east - vessel.velocity_east * north) / max(
                    over_ground, _VESSEL_SPEED_MIN
                ) ** 2
                return course + p.plume_heading + bearing, turn
            if not self._started:
                return p.vessel_course + p.plume_heading + bearing, 0.0
        return self.axis, 0.0

    def _target(self, velocity_north: float, velocity_east: float) -> float:
        """Return r_CO by equations (10) and (11), for an orbit across the centre's velocity [m]."""
        p = self._parameters
        last = len(p.along) - 1
        moving = math.hypot(velocity_north, velocity_east)
        row = min(moving / p.speed / p.speed_ratio_max, 1.0) * last
        i = min(int(row), last - 1)
        along = p.along[i] + (row - i) * (p.along[i + 1] - p.along[i])
        across = p.across[i] + (row - i) * (p.across[i + 1] - p.across[i])
        sideways = abs(
            velocity_east * math.cos(self.axis) - velocity_north * math.sin(self.axis)
        ) / max(moving, _CENTRE_SPEED_MIN)
        return p.distance_min + along + (across - along) * sideways
