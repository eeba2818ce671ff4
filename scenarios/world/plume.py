"""Where the plume's axis really is: behind the vessel's motion through the air, or at a given angle
from its bow.
"""

import math
from typing import Protocol

import numpy as np
import numpy.typing as npt

from aircraft.wind import WindField
from scenarios.scenario.extension_points import PLUME_MODELS
from scenarios.scenario.sections.world import PlumeConfig
from scenarios.world.vessel import TRACK_STEP, SteadyVessel, VesselTruth, sampled, track_times

_AT_REST = 1e-9
"""Speed through the air below which its direction is rounding alone [m/s]."""

Array = npt.NDArray[np.float64]


class Plume(Protocol):
    """The axis of a plume: a half-line from the vessel, level or rising at ``plume.elevation_deg``."""

    def axis(self, time: float) -> float:
        """Return the course along which the plume trails at a time [s], without jumps [rad]."""


plume_model = PLUME_MODELS.register
"""Decorator that registers a plume model by a name."""


@plume_model("straight")
class StraightPlume:
    """A plume whose axis follows its direction at once, all along.

    Parameters
    ----------
    plume : the ``[plume]`` section
    vessel : its motion
    wind : velocity of the air mass; that at the plume's origin turns it
    duration : to be covered [s]
    by_wind : whether it trails behind the vessel's motion through the air; otherwise at
        ``plume.heading_deg`` from the bow
    """

    __slots__ = ("_axis", "_steady")

    def __init__(
        self,
        plume: PlumeConfig,
        vessel: VesselTruth,
        wind: WindField,
        duration: float,
        *,
        by_wind: bool,
    ) -> None:
        heading = math.radians(plume.heading_deg)
        self._axis: list[float] = []
        self._steady: float | None = None
        if isinstance(vessel, SteadyVessel) and (wind.constant or not by_wind):
            _, _, v_north, v_east = vessel.motion(0.0)
            wind_north, wind_east = wind.now(0.0, plume.source_height)
            self._steady = (
                math.atan2(wind_east - v_east, wind_north - v_north)
                if by_wind
                else vessel.course(0.0) + heading
            )
            return
        velocity, course = sampled(vessel, duration)
        axis = course + heading
        if by_wind:
            blowing = wind.at(track_times(duration)[: len(velocity)], plume.source_height)
            through_air = velocity - np.column_stack(blowing)
            axis = np.unwrap(
                np.arctan2(-through_air[:, 1], -through_air[:, 0])[_last_moving(through_air)]
            )
        self._axis = axis.tolist()

    def axis(self, time: float) -> float:
        """Return the course along which the plume trails [rad]."""
        if self._steady is not None:
            return self._steady
        at = min(int(time / TRACK_STEP), len(self._axis) - 2)
        axis, after = self._axis[at], self._axis[at + 1]
        return axis + (time / TRACK_STEP - at) * (after - axis)


def _last_moving(velocity: Array) -> npt.NDArray[np.intp]:
    """Return which row of shape (n, 2) was the last that is not at rest, for each: in still air a
    plume stays in its place.
    """
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > _AT_REST
    return np.maximum.accumulate(np.where(moving, np.arange(len(velocity)), 0))
