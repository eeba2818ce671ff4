"""The world of one flight over the real sea: the vessel's track, the weather, what is heard of the vessel and what fails."""

import math
from dataclasses import dataclass

import numpy as np

from aircraft.atmosphere.gusts import Gust
from aircraft.atmosphere.turbulence import TURBULENCE
from aircraft.atmosphere.weather import Weather
from scenarios.schema.sea_config import SeaScenario
from scenarios.world.vessel import VesselTrack

VESSEL_DATA, SATELLITES = "vessel_data", "satellite_navigation"
"""Faults that are not the aircraft's."""

_MARGIN = 5.0
"""How long the track goes on after the longest flight [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TimedFault:
    """A fault of one flight.

    Attributes
    ----------
    kind : as the scenario names it; ``none`` for none
    begins, ends : when; for good what ends at infinity [s]
    """

    kind: str
    begins: float
    ends: float

    def lasts(self, kind: str, time: float) -> bool:
        """Return whether a fault of this kind is on."""
        return kind == self.kind and self.begins <= time < self.ends

    def of_aircraft(self) -> bool:
        """Return whether it is a part of the aircraft that fails."""
        return self.kind not in ("none", VESSEL_DATA, SATELLITES)


def wind_ned(scenario: SeaScenario) -> tuple[float, float]:
    """Return north and east velocity of the air mass [m/s]: where the wind blows to."""
    to = math.radians(scenario.wind.from_deg) + math.pi
    return scenario.wind.speed_mps * math.cos(to), scenario.wind.speed_mps * math.sin(to)


def vessel_track(scenario: SeaScenario) -> VesselTrack:
    """Return the vessel's track over the longest flight."""
    north, east = wind_ned(scenario)
    given = scenario.plume.direction == "given"
    return VesselTrack(
        scenario.vessel,
        scenario.flight.duration_max_s + _MARGIN,
        wind_north=north,
        wind_east=east,
        plume_heading=math.radians(scenario.plume.heading_deg) if given else None,
    )


def drawn_fault(scenario: SeaScenario, generator: np.random.Generator) -> TimedFault:
    """Return the flight's fault, at its time."""
    fault = scenario.fault
    begins = float(generator.uniform(*fault.at_s))
    lasts = {VESSEL_DATA: fault.vessel_data_s, SATELLITES: fault.satellite_navigation_s}.get(fault.kind, math.inf)
    return TimedFault(kind=fault.kind, begins=begins, ends=begins + lasts)


def drawn_weather(scenario: SeaScenario, generator: np.random.Generator) -> Weather:
    """Return the air that the flight goes through."""
    north, east = wind_ned(scenario)
    turbulence = scenario.turbulence
    rise = turbulence.gust_length_s
    gusts = []
    if turbulence.gusts and turbulence.gust_speed_mps > 0.0:
        # One gust in each equal share of the flight, so that none meets another.
        share = scenario.flight.duration_max_s / turbulence.gusts
        for i in range(turbulence.gusts):
            start = i * share + float(generator.uniform(0.0, max(0.0, share - 2.0 * rise)))
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
