"""How wide and how high the plume of a run is drawn."""

import math
from dataclasses import dataclass, fields

import numpy as np

from measurement.emission import emission_of, fuel_preset, ship_of
from measurement.errors import MeasurementError
from measurement.plume.spread import STEP, MarineAir, PlumeSettings, spreads
from reports.run.columns import Array
from reports.run.flight_config import Config, source_height

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
    spread_across, spread_up : of one realisation about its own centre, without its meander [m]
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
