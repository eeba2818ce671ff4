"""The air that a flight goes through: steady wind, turbulence, discrete gusts."""

import math

import numpy as np

from aircraft.atmosphere.gusts import Gust
from aircraft.atmosphere.turbulence import TURBULENCE
from aircraft.atmosphere.weather import Weather
from scenarios.schema.scenario import Scenario
from scenarios.schema.world import WindConfig

STILL_AIR = Weather(wind_north=0.0, wind_east=0.0, turbulence=None, gusts=(), seed=0)


def wind_ned(wind: WindConfig) -> tuple[float, float]:
    """Return north and east velocity of the air mass [m/s]: where the wind blows to."""
    to = math.radians(wind.from_deg) + math.pi
    return wind.speed_mps * math.cos(to), wind.speed_mps * math.sin(to)


def sampled_weather(scenario: Scenario, generator: np.random.Generator) -> Weather:
    """Return the air that the flight goes through."""
    north, east = wind_ned(scenario.wind)
    turbulence = scenario.turbulence
    rise = turbulence.gust_length_s
    gusts = []
    for i in range(turbulence.gusts):
        # One gust in each equal part of the flight, so that none meets another.
        part = scenario.flight.duration_max_s / turbulence.gusts
        start = i * part + float(generator.uniform(0.0, max(0.0, part - 2.0 * rise)))
        towards = float(generator.uniform(-math.pi, math.pi))
        speed = float(generator.uniform(0.5, 1.0)) * turbulence.gust_speed_mps
        velocity = (speed * math.cos(towards), speed * math.sin(towards), 0.0)
        gusts.append(Gust(start=start, rise=rise, fall=rise, velocity_ned=velocity))
    return Weather(
        wind_north=north,
        wind_east=east,
        turbulence=None if turbulence.level == "none" else TURBULENCE[turbulence.level],
        gusts=tuple(gusts),
        seed=int(generator.integers(2**31 - 1)),
    )
