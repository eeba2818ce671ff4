"""What was about the aircraft at one moment of a flight: the ship, its plume, the keep-out area and
the wind.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from common.hull import HULL_SHAPES, ShipHull
from reports.run.columns import column
from reports.run.flight_config import Config, keepout_shape
from reports.run.plume_shape import PlumeShape, plume_shape
from reports.run.ship import Hull, hull_of, outline_of
from reports.run.time_history import about_the_plume, true_wind, vessel_heading

_TURNED = math.radians(2.0)
"""Turn of the plume from which its course is said to change."""

_VEERED = 0.1
"""Change of the wind's velocity from which it is said to change [m/s]: it is shown in tenths."""

_SHORTEST, _LONGEST = 1.6, 4.0
"""Length of the plume that is drawn, over r_min [-]."""

_BEYOND = 1.2
"""The same over the farthest that the aircraft was from the ship [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Surroundings:
    """What was about the aircraft.

    Attributes
    ----------
    hull : of the ship
    heading : of its bow [rad]
    axis : course along which its plume trails [rad]
    plume : its shape
    radius, shape : r_min [m], and the shape of the keep-out area
    outline : of the hull, where the keep-out area is about it
    wind : its speed [m/s], and the course that it blows along [rad]
    changing : whether the plume's course or the wind changed in flight
    """

    hull: Hull
    heading: float
    axis: float
    plume: PlumeShape
    radius: float
    shape: str
    outline: ShipHull | None
    wind: tuple[float, float]
    changing: bool


def surroundings(
    config: Config, row: "pd.Series[Any]", history: pd.DataFrame, at: int = -1
) -> Surroundings:
    """Return what was about the aircraft at the sample ``at`` of a flight with a ship.

    Parameters
    ----------
    config : of the flight itself
    row : of the flight in the summary
    history : its time history
    """
    wind_north, wind_east = true_wind(history, row)
    wind = math.hypot(wind_north[at], wind_east[at]), math.atan2(wind_east[at], wind_north[at])
    veered = float(np.hypot(wind_north - wind_north[at], wind_east - wind_east[at]).max())
    heading = vessel_heading(history, float(config.get("vessel", {}).get("course_deg", 0.0)))
    axis = column(history, "plume_axis_rad")
    radius = float(row["keepout_radius_m"])
    north, east = (
        float(column(history, f"vessel_velocity_{name}_mps")[at]) for name in ("north", "east")
    )
    apparent = math.hypot(wind_north[at] - north, wind_east[at] - east)
    reach = _BEYOND * float(np.nanmax(np.hypot(*about_the_plume(history))))
    length = min(max(reach, _SHORTEST * radius), _LONGEST * radius)
    shape = keepout_shape(config)
    return Surroundings(
        hull=hull_of(config),
        heading=float(heading[at]),
        axis=float(axis[at]),
        plume=plume_shape(
            config,
            speed=math.hypot(north, east),
            wind=wind[0],
            apparent_wind=apparent,
            length=length,
        ),
        radius=radius,
        shape=shape,
        outline=outline_of(config) if shape in HULL_SHAPES.values() else None,
        wind=wind,
        changing=bool(np.ptp(np.unwrap(axis)) > _TURNED or veered > _VEERED),
    )
