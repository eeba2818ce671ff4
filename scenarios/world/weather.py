"""The air that a flight goes through: mean wind, turbulence, discrete gusts."""

import math

import numpy as np

from aircraft.fdm import TIME_STEP
from aircraft.weather import STEPS_BETWEEN_GUSTS, TURBULENCE, Gust, Weather
from aircraft.wind import CALM, WindField, constant_wind, over_the_sea
from common.physics import wind_velocity
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.world import WindConfig
from scenarios.world.place import Place
from scenarios.world.wind_table import tabled_wind

STILL_AIR = Weather(wind=CALM, turbulence=None, gusts=(), seed=0)

_BETWEEN = (STEPS_BETWEEN_GUSTS + 1.0) * TIME_STEP
"""Time from the end of one gust to the next, at least [s]."""


def wind_ned(wind: WindConfig) -> tuple[float, float]:
    """Return north and east velocity of the air mass [m/s]: where the wind blows to."""
    return wind_velocity(wind.speed_mps, wind.from_deg)


def wind_of(scenario: Scenario, place: Place) -> WindField:
    """Return the mean wind of a flight that begins at a place, timed from its start.

    Raises
    ------
    InputError : its table cannot be read, or does not cover the longest flight
    """
    wind = scenario.wind
    if wind.table is not None:
        return tabled_wind(wind, place, scenario.flight.duration_max_s)
    if wind.roughness_m is None or not wind.blows:
        return constant_wind(*wind_ned(wind))
    return over_the_sea(
        np.array([wind_ned(wind)]), [0.0], roughness=wind.roughness_m, height=wind.height_m
    )


def sampled_weather(scenario: Scenario, wind: WindField, generator: np.random.Generator) -> Weather:
    """Return the air that the flight goes through, with some mean wind."""
    turbulence = scenario.turbulence
    rise = turbulence.gust_length_s
    gusts: list[Gust] = []
    for i in range(turbulence.gusts):
        # One gust in each equal part of the flight, and after the one before it: JSBSim takes one
        # at a time.
        part = scenario.flight.duration_max_s / turbulence.gusts
        start = i * part + float(generator.uniform(0.0, max(0.0, part - 2.0 * rise)))
        start = max(start, gusts[-1].end + _BETWEEN) if gusts else start
        towards = float(generator.uniform(-math.pi, math.pi))
        speed = float(generator.uniform(0.5, 1.0)) * turbulence.gust_speed_mps
        velocity = (speed * math.cos(towards), speed * math.sin(towards), 0.0)
        gusts.append(Gust(start=start, rise=rise, fall=rise, velocity_ned=velocity))
    return Weather(
        wind=wind,
        turbulence=None if turbulence.level == "none" else TURBULENCE[turbulence.level],
        gusts=tuple(gusts),
        seed=int(generator.integers(2**31 - 1)),
    )
