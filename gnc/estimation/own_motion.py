"""Where the vehicle is and how it moves, in the frame of the air mass: as it is, or estimated from
sensors.
"""

import math
from dataclasses import dataclass
from typing import Any, Protocol

from gnc.estimation.navigation import Navigation, NavigationParameters

Motion = tuple[float, float, float, float, float]
"""North, east [m], north and east velocity over the ground [m/s], rate of the course [rad/s]."""

Readings = tuple[tuple[float, float, float, float] | None, float, float, float, float, float]
"""What sensors on board say.

Position and velocity over the ground by satellite navigation, if there is any [m, m/s]; airspeed
[m/s]; heading and roll [rad]; rate of the course against the air [rad/s]; error of the control
surface that is farthest from its command, over its travel [-].
"""

_SPEED_MIN = 1.0
"""Speed below which the ratio of airspeed to speed over the mean air is not formed [m/s]: no
vehicle flies as slowly.
"""


class AirMotion(Protocol):
    """What of a vehicle's motion a turn away is predicted from.

    Attributes
    ----------
    ground_north, ground_east : over the ground [m]
    course : of the motion through the mean air, from -pi to pi [rad]
    heading_rate : of that course [rad/s]
    wind_north, wind_east : velocity of the air mass [m/s]
    wind_error : by how much more than at all times that may be wrong, as long as it was measured
        seldom [m/s]
    lost : for how long there has been no satellite navigation [s]
    speed : of the motion through the mean air [m/s]
    """

    ground_north: float
    ground_east: float
    course: float
    heading_rate: float
    wind_north: float
    wind_east: float
    wind_error: float
    lost: float
    speed: float


class OwnMotion(AirMotion, Protocol):
    """The vehicle's motion, updated once per guidance step; attributes as of ``AirMotion``, and
    more.

    The guidance works in the frame of the mean air, which drifts with the wind and is that of the
    ground in still air.

    Attributes
    ----------
    north, east : in the frame of the air mass [m]
    drift_north, drift_east : how far the frame of the air mass has drifted [m]
    airspeed : as measured, against gusty air [m/s]
    air_ratio : airspeed over the speed through the mean air [-]
    """

    north: float
    east: float
    drift_north: float
    drift_east: float
    airspeed: float
    air_ratio: float

    def update(self, measurement: Any) -> None:
        """Take in what is measured now, in the form that this navigation takes."""


@dataclass(slots=True, kw_only=True)
class KnownMotion:
    """A motion that is given; attributes as of ``AirMotion``."""

    ground_north: float
    ground_east: float
    course: float
    heading_rate: float = 0.0
    wind_north: float = 0.0
    wind_east: float = 0.0
    wind_error: float = 0.0
    lost: float = 0.0
    speed: float = 0.0


class TrueNavigation:
    """The motion as it is, in still air; attributes as of ``OwnMotion``."""

    __slots__ = (
        "air_ratio", "airspeed", "course", "drift_east", "drift_north", "east", "ground_east", "ground_north", "heading_rate",
        "lost", "north", "speed", "wind_east", "wind_error", "wind_north",
    )  # fmt: skip

    def __init__(self) -> None:
        self.drift_north = self.drift_east = self.wind_north = self.wind_east = self.wind_error = (
            self.lost
        ) = 0.0
        self.north = self.east = self.ground_north = self.ground_east = 0.0
        self.course = self.speed = self.heading_rate = 0.0
        self.air_ratio, self.airspeed = 1.0, math.nan

    def update(self, measurement: Motion) -> None:
        """Take in the motion now."""
        north, east, v_north, v_east, self.heading_rate = measurement
        self.north = self.ground_north = north
        self.east = self.ground_east = east
        self.course = math.atan2(v_east, v_north)
        self.speed = math.hypot(v_north, v_east)


class EstimatedNavigation:
    """The motion estimated from sensors, with an estimate of the wind; attributes as of
    ``OwnMotion``.

    An autopilot turns against the gusty air, the guidance over the mean air:
    ``gnc.airspeed.air_turn``.

    Parameters
    ----------
    parameters : of the navigation
    """

    __slots__ = (
        "_navigation", "air_ratio", "airspeed", "course", "drift_east", "drift_north", "east", "ground_east", "ground_north",
        "heading_rate", "lost", "north", "speed", "wind_east", "wind_error", "wind_north",
    )  # fmt: skip

    def __init__(self, parameters: NavigationParameters) -> None:
        self._navigation = Navigation(parameters)
        self.drift_north = self.drift_east = self.wind_north = self.wind_east = self.wind_error = (
            self.lost
        ) = 0.0
        self.north = self.east = self.ground_north = self.ground_east = 0.0
        self.course = self.speed = self.heading_rate = self.airspeed = 0.0
        self.air_ratio = 1.0

    def update(self, measurement: Readings) -> None:
        """Take in what the sensors say now."""
        position, airspeed, heading, roll, heading_rate, _ = measurement
        navigation = self._navigation
        navigation.update(position, airspeed, heading, roll)
        wind = navigation.wind
        self.wind_north, self.wind_east = wind_north, wind_east = wind.north, wind.east
        v_north, v_east = (
            navigation.velocity_north - wind_north,
            navigation.velocity_east - wind_east,
        )
        self.course, self.speed = math.atan2(v_east, v_north), math.hypot(v_north, v_east)
        self.airspeed, self.lost, self.wind_error = airspeed, navigation.lost, navigation.wind_error
        self.ground_north, self.ground_east = north, east = navigation.north, navigation.east
        self.drift_north, self.drift_east = navigation.drift_north, navigation.drift_east
        self.north, self.east = north - self.drift_north, east - self.drift_east
        speed = self.speed
        self.air_ratio = ratio = (airspeed if airspeed > _SPEED_MIN else _SPEED_MIN) / (
            speed if speed > _SPEED_MIN else _SPEED_MIN
        )
        self.heading_rate = heading_rate * ratio
