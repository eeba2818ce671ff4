"""The agent's observation: the vehicle, the vessel, its plume, and the guidance's reference, in the
frame of the plume.
"""

import math

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from common.hull import ship_frame
from scenarios.flight.closed_loop import ClosedLoop

Array = npt.NDArray[np.float64]

_DISTANCE, _SPEED, _RATE = 1e5, 500.0, 10.0
"""Bounds beyond which observations are cut [m, m/s, rad/s]; no flight comes near them."""

MEANINGS: dict[str, tuple[str, str, float]] = {
    "along_m": (
        "distance from the vessel along the plume, positive astern in still air",
        "m",
        _DISTANCE,
    ),
    "across_m": (
        "distance from the plume's axis, positive to the right of its course",
        "m",
        _DISTANCE,
    ),
    "clearance_m": (
        "distance from the vessel, or its hull, less the keep-out radius, horizontal",
        "m",
        _DISTANCE,
    ),
    "velocity_along_mps": ("velocity over the ground along the plume", "m/s", _SPEED),
    "velocity_across_mps": ("velocity over the ground to the right of the plume", "m/s", _SPEED),
    "heading_rate_rad_s": ("rate of the course through the air", "rad/s", _RATE),
    "vessel_along_mps": ("velocity of the vessel along the plume", "m/s", _SPEED),
    "vessel_across_mps": ("velocity of the vessel to the right of the plume", "m/s", _SPEED),
    "wind_along_mps": (
        "velocity of the air along the plume, as the guidance estimates it",
        "m/s",
        _SPEED,
    ),
    "wind_across_mps": (
        "velocity of the air to the right of the plume, as the guidance estimates it",
        "m/s",
        _SPEED,
    ),
    "reference_along_m": ("distance to the reference along the plume", "m", _DISTANCE),
    "reference_across_m": ("distance to the reference to the right of the plume", "m", _DISTANCE),
    "reference_cos": (
        "cosine of the reference's course through the air, from the plume's",
        "1",
        1.0,
    ),
    "reference_sin": ("sine of the reference's course through the air, from the plume's", "1", 1.0),
    "elapsed": ("time since the start over the longest that the flight may last", "1", 1.0),
}
"""Entries of the observation in order, each with meaning, unit, and the bound of its size. Motion
is true.
"""


def observation_space() -> "spaces.Box[np.float64]":
    """Return the space of observations."""
    bounds = np.array([bound for _, _, bound in MEANINGS.values()])
    low = -bounds
    low[-1] = 0.0
    return spaces.Box(low, bounds, dtype=np.float64)


class Observer:
    """Observes one flight under way.

    Parameters
    ----------
    loop : the flight

    Attributes
    ----------
    along, across : place of the last observation, as in ``MEANINGS`` [m]
    distance : horizontal, in that observation, from the vessel or its hull, about which the
        keep-out area lies [m]
    """

    def __init__(self, loop: ClosedLoop) -> None:
        self._loop = loop
        self.along = self.across = self.distance = math.nan

    def observe(self, time: float) -> Array:
        """Return the observation at a time [s] since the start, shape (len(MEANINGS),)."""
        loop = self._loop
        plan, guidance, world = loop.plan, loop.guidance, loop.plan.world
        if world is None:
            raise TypeError("the flight has no vessel to observe")
        north, east, v_north, v_east, heading_rate = loop.vehicle.motion()
        vessel_north, vessel_east, vessel_v_north, vessel_v_east = world.vessel.motion(time)
        axis = world.plume.axis(time)
        cos, sin = math.cos(axis), math.sin(axis)

        def turned(to_north: float, to_east: float) -> tuple[float, float]:
            return cos * to_north + sin * to_east, cos * to_east - sin * to_north

        self.along, self.across = turned(north - vessel_north, east - vessel_east)
        self.distance = math.hypot(self.along, self.across)
        if plan.keepout_hull is not None:
            seen = np.array(north - vessel_north), np.array(east - vessel_east)
            heading = np.array(world.vessel.course(time))
            self.distance = float(plan.keepout_hull.distance(*ship_frame(*seen, heading)))
        own, reference, course = guidance.own, (0.0, 0.0), axis
        if guidance.mission.orbit is not None:
            tracked = guidance.mission.tracker.reference
            reference = turned(
                tracked.north + own.drift_north - north, tracked.east + own.drift_east - east
            )
            course = tracked.course
        values = (
            self.along, self.across, self.distance - plan.keepout_radius, *turned(v_north, v_east),
            heading_rate,
            *turned(vessel_v_north, vessel_v_east), *turned(own.wind_north, own.wind_east),
            *reference,
            math.cos(course - axis), math.sin(course - axis), time / plan.duration_max,
        )  # fmt: skip
        return np.clip(values, _SPACE.low, _SPACE.high)


_SPACE = observation_space()
