"""The exhaust of a vessel: how much of each gas is where, over the ground."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from aircraft.wind import WindField
from gnc.errors import InfeasibleError
from measurement.emission import Emission, Fuel, emission_of, fuel_preset, ship_of
from measurement.gases import GASES, PARTS
from measurement.plume.fluctuating_plume import PlumeSample
from measurement.plume.spread import MarineAir
from scenarios.scenario.scenario import Scenario
from scenarios.world.plume import Plume
from scenarios.world.vessel import VesselTruth

Array = npt.NDArray[np.float64]

_ZERO_CELSIUS = 273.15
"""[K]"""

_ANEMOMETER = 10.0
"""Height of the wind that makes the turbulence [m]."""

_PARTS = np.array([PARTS[gas] for gas in GASES])


class Dispersion(Protocol):
    """One realisation of a plume, in the frame of the air mass."""

    def sample(self, time: Array, north: Array, east: Array, up: Array) -> PlumeSample:
        """Return the plume at places, each shape (n,) [s, m]."""


@runtime_checkable
class Smoke(Protocol):
    """A plume model that has more than an axis."""

    def dispersion(
        self,
        emission: Emission,
        air: MarineAir,
        *,
        vessel: VesselTruth,
        wind: WindField,
        duration: float,
        source_height: float,
        settings: Any,
        seed: int,
    ) -> Dispersion:
        """Return one realisation; arguments as of ``scenarios.world.fluctuating_plume``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exhaust:
    """What a vessel emits, and where it is.

    Attributes
    ----------
    fuel, emission : what is burnt, and what leaves the funnel
    dispersion : of it, in the frame of the air mass
    displacement : how far that frame has moved north and east at some times [s], in metres
    """

    fuel: Fuel
    emission: Emission
    dispersion: Dispersion
    displacement: Callable[[Array], tuple[Array, Array]]

    def sample(self, time: Array, north: Array, east: Array, up: Array) -> PlumeSample:
        """Return the plume at places over the ground, each shape (n,) [s, m]."""
        moved_north, moved_east = self.displacement(time)
        return self.dispersion.sample(time, north - moved_north, east - moved_east, up)

    def excess(self, dilution: Array) -> Array:
        """Return the gases above clean air, shape (n, 4), in the order and the units of
        ``measurement.gases``.
        """
        return np.outer(dilution, self.emission.rates * _PARTS)


def fuel_of(scenario: Scenario) -> Fuel:
    """Return what the vessel of a scenario burns."""
    return fuel_preset(scenario.emission.fuel, scenario.emission.sulphur_percent)


def emission(scenario: Scenario, *, speed: float, load: float | None = None) -> Emission:
    """Return what the vessel of a scenario emits at a speed [m/s], or at a load of its engine [-]
    where that is given.

    Raises
    ------
    MeasurementError : the ship has no such speed
    """
    ship = ship_of(scenario.emission.ship or "")
    air_temperature = scenario.wind.temperature_c + _ZERO_CELSIUS
    if load is None:
        return emission_of(ship, fuel_of(scenario), speed=speed, air_temperature=air_temperature)
    return emission_of(
        ship, fuel_of(scenario), power=load * ship.power_max, air_temperature=air_temperature
    )


def _called(scenario: Scenario) -> str:
    ship = scenario.emission.ship
    return f"'{ship}'" if isinstance(ship, str) else "given"


def without_smoke(scenario: Scenario) -> str:
    """Return why a vessel with exhaust cannot have such a plume."""
    return (
        f"emission.ship is {_called(scenario)}, and plume.model '{scenario.plume.model}' has no smoke: set plume.model to"
        " 'fluctuating', or leave emission.ship out"
    )


def exhaust_of(
    scenario: Scenario,
    vessel: VesselTruth,
    plume: Plume,
    wind: WindField,
    *,
    duration: float,
    generator: np.random.Generator,
) -> Exhaust | None:
    """Return the exhaust of a vessel that has any, in some wind, over a duration [s]. It is that of
    her speed at the start.

    Raises
    ------
    InfeasibleError : the plume model has no smoke
    MeasurementError : the ship has no such speed, or the apparent wind is too weak for a plume
    """
    if scenario.emission.ship is None:
        return None
    if not isinstance(plume, Smoke):
        raise InfeasibleError(without_smoke(scenario))
    air, height = scenario.wind, scenario.source_height
    _, _, v_north, v_east = vessel.motion(0.0)
    emitted = emission(scenario, speed=math.hypot(v_north, v_east), load=scenario.emission.load)
    dispersion = plume.dispersion(
        emitted,
        MarineAir(
            wind_speed=math.hypot(*wind.now(0.0, _ANEMOMETER)),
            temperature=air.temperature_c + _ZERO_CELSIUS,
            brunt_vaisala=air.stability_per_s,
        ),
        vessel=vessel,
        wind=wind,
        duration=duration,
        source_height=height,
        settings=scenario.plume.settings(plume),
        seed=int(generator.integers(2**31)),
    )
    return Exhaust(
        fuel=fuel_of(scenario),
        emission=emitted,
        dispersion=dispersion,
        displacement=lambda time: wind.displacement(time, height),
    )
