"""What was about the aircraft at one moment of a flight: the ship, its plume as it is drawn, the
keep-out area and the wind.
"""

import math
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from common.hull import HULL_SHAPES, ShipHull
from measurement.emission import emission_of, fuel_preset, ship_of
from measurement.errors import MeasurementError
from measurement.plume.spread import STEP, MarineAir, PlumeSettings, spreads
from reports.run.columns import Array, column
from reports.run.flight_config import (
    Config,
    Hull,
    hull_of,
    keepout_shape,
    outline_of,
    source_height,
)
from reports.run.time_history import about_the_plume, true_wind, vessel_heading

LINE_HALF_WIDTH = 4.0
"""Half-width of a plume that is an axis alone, which has none: enough to be seen [m]."""

SPREADS = 2.0
"""Spreads from the axis to the edge that is drawn [-]: there the concentration is exp(-2) of that
on the axis.
"""

_SECTIONS = 25
"""Cross-sections of a plume."""

_WIND_MIN = 1.0
"""Apparent wind below which a plume has no direction [m/s]."""

_ZERO_CELSIUS = 273.15
"""[K]"""


@dataclass(frozen=True, slots=True, kw_only=True)
class PlumeShape:
    """A plume as a tube about its axis; every array has the shape (n,).

    Attributes
    ----------
    distance : from the funnel along the sea, increasing from 0 [m]
    height : of the axis above the sea [m]
    half_width, half_height : of the tube across and up [m]
    spread_across, spread_up : of one realisation about its centre, without its meander [m]
    smoke : whether the model has a width; of an axis alone it is ``LINE_HALF_WIDTH``
    """

    distance: Array
    height: Array
    half_width: Array
    half_height: Array
    spread_across: Array
    spread_up: Array
    smoke: bool


def plume_shape(
    config: Config, *, speed: float, wind: float, apparent_wind: float, length: float
) -> PlumeShape:
    """Return the shape of a flight's plume: of smoke its mean over time, of an axis without smoke a
    thin tube.

    Parameters
    ----------
    config : of the flight itself
    speed : of the vessel over the ground [m/s]
    wind, apparent_wind : of the air over the ground, and past the funnel [m/s]
    length : along the sea [m]
    """
    distance = np.linspace(0.0, length, _SECTIONS)
    if (
        config["plume"].get("model") == "fluctuating"
        and config.get("emission", {}).get("ship")
        and apparent_wind >= _WIND_MIN
    ):
        try:
            return _smoke(config, distance, speed=speed, wind=wind, apparent_wind=apparent_wind)
        except MeasurementError:
            # A range that this version has narrowed; what is left is the axis.
            pass
    climb = math.tan(math.radians(float(config["plume"].get("elevation_deg", 0.0))))
    height, width = source_height(config) + climb * distance, np.full(_SECTIONS, LINE_HALF_WIDTH)
    own = width / SPREADS
    return PlumeShape(
        distance=distance,
        height=height,
        half_width=width,
        half_height=width,
        spread_across=own,
        spread_up=own,
        smoke=False,
    )


def _smoke(
    config: Config, distance: Array, *, speed: float, wind: float, apparent_wind: float
) -> PlumeShape:
    """Return axis and spreads of the exhaust about the axis, with the meander of its centre."""
    plume, emitted, air = config["plume"], config["emission"], config["wind"]
    settings = PlumeSettings(
        **{f.name: plume[f.name] for f in fields(PlumeSettings) if f.name in plume}
    )
    ship, fuel = ship_of(emitted["ship"]), fuel_preset(emitted["fuel"], emitted["sulphur_percent"])
    load, temperature = emitted["load"], air["temperature_c"] + _ZERO_CELSIUS
    moving = {"speed": speed} if load is None else {"power": load * ship.power_max}
    emission = emission_of(ship, fuel, **moving, air_temperature=temperature)
    marine = MarineAir(
        wind_speed=wind, temperature=temperature, brunt_vaisala=air["stability_per_s"]
    )
    age = distance / apparent_wind
    table = spreads(
        emission, marine, source_height(config), np.array([apparent_wind]), float(age[-1]), settings
    )
    ages = STEP * np.arange(table.height.shape[1])
    across, up = (
        np.hypot(table.relative_y[0], table.meander_y[0]),
        np.hypot(table.relative_z[0], table.meander_z[0]),
    )
    return PlumeShape(
        distance=distance,
        height=np.interp(age, ages, table.height[0]),
        half_width=SPREADS * np.interp(age, ages, across),
        half_height=SPREADS * np.interp(age, ages, up),
        spread_across=np.interp(age, ages, table.relative_y[0]),
        spread_up=np.interp(age, ages, table.relative_z[0]),
        smoke=True,
    )


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
