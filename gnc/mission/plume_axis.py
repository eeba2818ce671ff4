"""Where a plume's axis is taken to be, and at which altitude it is crossed: by prediction, or as it
is given.
"""

import math
from dataclasses import dataclass
from typing import Protocol

from gnc.estimation.navigation import OwnMotion
from gnc.estimation.vessel import TargetMotion
from gnc.mission.axis_height import AxisHeight
from gnc.mission.mode import Mode
from gnc.numeric import clip, limited, wrap
from gnc.reference.moving_centre import MovingCentre


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb:
    """How the commanded altitude follows the one that is demanded: late and slowly, so that the
    autopilot follows it.

    Attributes
    ----------
    time : constant of the lag [s]
    gradient : steepest climb or descent over the vehicle's way [-]
    reach : how far from the altitude that is flown the command may be [m]: an autopilot that has
        fallen behind by more may integrate no longer, and come back slowly
    """

    time: float
    gradient: float
    reach: float = math.inf

    def step(
        self,
        altitude: float,
        demanded: float,
        speed: float,
        time_step: float,
        *,
        flown: float = math.nan,
    ) -> float:
        """Return the altitude to command [m] a time step [s] later.

        Parameters
        ----------
        altitude, demanded : commanded now, and in the end [m]
        speed : of the vehicle [m/s]
        time_step : [s]
        flown : altitude now, as far as that is known [m]
        """
        following = altitude + time_step * limited(
            (demanded - altitude) / self.time, self.gradient * speed
        )
        return following if math.isnan(flown) else flown + limited(following - flown, self.reach)


@dataclass(frozen=True, slots=True, kw_only=True)
class Situation:
    """What a plume's axis is reckoned from, as it moves.

    Attributes
    ----------
    own, target : motion of the vehicle and of the vessel
    centre : of oscillation
    speed : V_r [m/s]
    plan_time : between plans [s]
    """

    own: OwnMotion
    target: TargetMotion
    centre: MovingCentre
    speed: float
    plan_time: float


class PlumeAxis(Protocol):
    """The axis during one flight.

    Attributes
    ----------
    climb : how the altitude follows
    flown, demanded : altitude now, not a number where nobody says, and the one that is demanded [m]
    bearing : of the centre of oscillation, to the right of where the vessel's motion through the
        air has the plume trail [rad]
    mode : what is done while the reference is tracked
    """

    climb: Climb
    flown: float
    demanded: float
    bearing: float
    mode: Mode

    def plan(self, time: float, situation: Situation, *, tracking: bool) -> None:
        """Look where the axis is now; ``tracking`` says whether the reference is tracked."""


class AxisParameters(Protocol):
    """How a plume's axis is known."""

    @property
    def altitude(self) -> float:
        """Altitude at the start [m]."""

    def begin(self) -> PlumeAxis:
        """Return the axis of one flight, fresh."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PredictedPlume:
    """A plume whose axis is predicted from wind, vessel and the rise of exhaust, or given to the
    flight.

    Attributes
    ----------
    height : of the axis, and lowest and highest altitude that are flown
    altitude : at the start [m]
    climb : how the altitude follows
    """

    height: AxisHeight
    altitude: float
    climb: Climb = Climb(time=20.0, gradient=0.05)

    def begin(self) -> "PredictedAxis":
        """Return the axis of one flight."""
        return PredictedAxis(self)


class PredictedAxis:
    """The predicted axis, until the true one is given; attributes as of ``PlumeAxis``."""

    __slots__ = ("_height", "_true_axis", "bearing", "climb", "demanded", "flown", "mode")

    def __init__(self, parameters: PredictedPlume) -> None:
        self._height, self.climb, self.demanded = (
            parameters.height,
            parameters.climb,
            parameters.altitude,
        )
        self._true_axis: tuple[float, float] | None = None
        self.bearing, self.flown, self.mode = 0.0, math.nan, Mode.TRACKING

    def set_true_axis(self, height: float, course: float) -> None:
        """Take the height above the sea [m] and the course [rad] of the axis at the centre of
        oscillation.
        """
        self._true_axis = height, course

    def plan(self, time: float, situation: Situation, *, tracking: bool) -> None:  # noqa: ARG002 - of the Protocol
        """Take the given height, or the one predicted at the centre in the apparent wind, within
        the limits of the altitude.
        """
        height, centre = self._height, situation.centre
        if self._true_axis is None:
            self.demanded = height.at(centre.distance, centre.speed_ratio * situation.speed)
            return
        height_there, course = self._true_axis
        self.demanded = clip(height_there, height.lowest, height.highest)
        self.bearing = wrap(course - trail(situation.own, situation.target))


def trail(own: OwnMotion, target: TargetMotion) -> float:
    """Return the course along which a plume trails behind the vessel's motion through the air, as
    it is estimated [rad].
    """
    north, east = apparent_wind(own, target)
    return math.atan2(east, north)


def apparent_wind(own: OwnMotion, target: TargetMotion) -> tuple[float, float]:
    """Return the velocity of the air past the vessel, north and east, as it is estimated [m/s]."""
    return own.wind_north - target.velocity_north, own.wind_east - target.velocity_east
