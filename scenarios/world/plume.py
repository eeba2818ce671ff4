"""The plume: its true axis, the exhaust about it, and the CO2 of the air beside it.

The axis trails behind the vessel's motion through the air, or at a given angle from its bow. Smoke
rises, disperses, meanders and bends about it with the vessel's own track.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from aircraft.wind import WindField
from gnc.errors import InfeasibleError
from measurement.emission import (
    AIR_PRESSURE,
    Emission,
    Fuel,
    emission_of,
    fuel_preset,
    ship_of,
    stack_height_of,
)
from measurement.gases import GASES, PARTS
from measurement.plume.fluctuating_plume import FluctuatingPlume, PlumeSample
from measurement.plume.spread import MarineAir, PlumeSettings
from measurement.species import SPECIES
from scenarios.scenario.extension_points import PLUME_MODELS
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.traffic import TrafficEmissionConfig
from scenarios.scenario.sections.world import AirConfig, PlumeConfig
from scenarios.world.vessel import TRACK_STEP, SteadyVessel, VesselTruth, sampled, track_times

_AT_REST = 1e-9
"""Speed through the air below which its direction is only rounding [m/s]."""

Array = npt.NDArray[np.float64]


class Plume(Protocol):
    """The axis of a plume: a half-line from the vessel, level or rising at
    ``plume.elevation_deg``.
    """

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
    """Return for each row, shape (n, 2), the last row up to it that is not at rest: in still air a
    plume keeps its direction.
    """
    moving = np.hypot(velocity[:, 0], velocity[:, 1]) > _AT_REST
    return np.maximum.accumulate(np.where(moving, np.arange(len(velocity)), 0))


_TRACK_INTERVAL = 0.5
"""Time between the places of the vessel from which the smoke comes [s]: at 10 m/s a turn at 1 deg/s
is a chord to 6 mm.
"""


@plume_model("fluctuating")
class FluctuatingSmoke(StraightPlume):
    """Gifford's fluctuating plume; near the vessel its axis is that of ``StraightPlume``.

    The vessel has come on its first course and at its first speed.
    """

    SETTINGS = PlumeSettings

    def dispersion(
        self,
        emission: Emission,
        air: MarineAir,
        *,
        vessel: VesselTruth,
        wind: WindField,
        duration: float,
        source_height: float,
        settings: PlumeSettings,
        seed: int,
    ) -> FluctuatingPlume:
        """Return one realisation of the smoke, in the frame of the air mass.

        Parameters
        ----------
        emission, air : the gases from the stack, and the air into which they go
        vessel, wind : motion of the vessel over the ground, and of the air
        duration : to be covered [s]
        source_height : of the stack's mouth above the sea [m]
        settings, seed : of the realisation

        Raises
        ------
        MeasurementError : the apparent wind is too weak for a plume
        """
        before = math.ceil(settings.age_max / _TRACK_INTERVAL)
        steps = np.arange(-before, math.ceil(duration / _TRACK_INTERVAL) + 2, dtype=np.float64)
        time = _TRACK_INTERVAL * steps
        place = np.array([vessel.motion(t)[:2] for t in np.maximum(time, 0.0).tolist()])
        _, _, v_north, v_east = vessel.motion(0.0)
        earlier = np.minimum(time, 0.0)
        moved_north, moved_east = wind.displacement(time, source_height)
        return FluctuatingPlume(
            emission,
            air,
            time=time,
            north=place[:, 0] + earlier * v_north - moved_north,
            east=place[:, 1] + earlier * v_east - moved_east,
            source_height=source_height,
            settings=settings,
            seed=seed,
        )


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
    """A plume model with smoke in addition to an axis."""

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
        """Return one realisation; arguments are those of ``FluctuatingSmoke``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Exhaust:
    """The exhaust of a vessel, and where it is.

    Attributes
    ----------
    fuel, emission : the fuel, and the gases from the stack
    dispersion : of these gases, in the frame of the air mass
    displacement : way of that frame north and east at some times [s], in metres
    ratios : of gases of ``measurement.species`` to CO2, which they disperse with [unit/ppm]
    """

    fuel: Fuel
    emission: Emission
    dispersion: Dispersion
    displacement: Callable[[Array], tuple[Array, Array]]
    ratios: Mapping[str, float] = field(default_factory=dict)

    def sample(self, time: Array, north: Array, east: Array, up: Array) -> PlumeSample:
        """Return the plume at places over the ground, each shape (n,) [s, m]."""
        moved_north, moved_east = self.displacement(time)
        return self.dispersion.sample(time, north - moved_north, east - moved_east, up)

    def excess(self, dilution: Array) -> Array:
        """Return the gases above clean air, shape (n, 4), in the order and the units of
        ``measurement.gases``.
        """
        return np.outer(dilution, self.emission.rates * _PARTS)


def fuel_of(scenario: Scenario, of: TrafficEmissionConfig | None = None) -> Fuel:
    """Return the fuel of a scenario's vessel, or that ``of`` another ship."""
    given = of or scenario.emission
    return fuel_preset(given.fuel, given.sulphur_percent)


def emission(
    scenario: Scenario,
    *,
    speed: float,
    load: float | None = None,
    of: TrafficEmissionConfig | None = None,
) -> Emission:
    """Return the emission of a scenario's vessel at a speed [m/s], or at a given load of its engine
    [-]; or that ``of`` another ship.

    Raises
    ------
    MeasurementError : the ship has no such speed
    """
    given = of or scenario.emission
    ship, fuel = ship_of(given.ship or ""), fuel_of(scenario, of)
    about: dict[str, float] = {
        "air_temperature": scenario.wind.temperature_c + _ZERO_CELSIUS,
        "methane": scenario.emission.methane if of is None else 0.0,
    }
    if load is None:
        return emission_of(ship, fuel, speed=speed, **about)
    return emission_of(ship, fuel, power=load * ship.power_max, **about)


def air_of_particles(scenario: Scenario) -> tuple[float, float]:
    """Return temperature [deg C] and pressure [hPa] of the air that particles are counted in."""
    return scenario.wind.temperature_c, AIR_PRESSURE / 100.0


def _ratios(scenario: Scenario) -> dict[str, float]:
    """Return what the measured vessel emits of gases, over its CO2 [unit/ppm]."""
    carbon, air = fuel_of(scenario).carbon_fraction, air_of_particles(scenario)
    return {
        gas: SPECIES[gas].slope(SPECIES[gas].factor(carbon, air), figure)
        for gas, figure in scenario.emission.emitted.items()
    }


def without_smoke(scenario: Scenario) -> str:
    """Return why a vessel with exhaust cannot have such a plume."""
    ship = scenario.emission.ship
    return (
        f"emission.ship is {repr(ship) if isinstance(ship, str) else 'given'}, and plume.model"
        f" '{scenario.plume.model}' has no smoke: set plume.model to 'fluctuating', or leave"
        " emission.ship out"
    )


def exhaust_of(
    scenario: Scenario,
    vessel: VesselTruth,
    plume: Plume,
    wind: WindField,
    *,
    duration: float,
    generator: np.random.Generator,
    of: TrafficEmissionConfig | None = None,
) -> Exhaust | None:
    """Return the exhaust of a vessel in some wind over a duration [s], for its speed at the start;
    None for a vessel without exhaust.

    Parameters
    ----------
    scenario : the flight
    vessel : its motion
    plume : model of the smoke
    wind, duration : to be covered [s]
    generator : of this exhaust alone
    of : another ship than the measured one

    Raises
    ------
    InfeasibleError : the plume model has no smoke
    MeasurementError : the ship has no such speed, or the apparent wind is too weak for a plume
    """
    given = of or scenario.emission
    if given.ship is None:
        return None
    if not isinstance(plume, Smoke):
        raise InfeasibleError(without_smoke(scenario))
    air = scenario.wind
    height = scenario.source_height if of is None else stack_height_of(None, of.ship)
    _, _, v_north, v_east = vessel.motion(0.0)
    emitted = emission(scenario, speed=math.hypot(v_north, v_east), load=given.load, of=of)
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
        fuel=fuel_of(scenario, of),
        emission=emitted,
        dispersion=dispersion,
        displacement=lambda time: wind.displacement(time, height),
        ratios=_ratios(scenario) if of is None else {},
    )


_STEP = 0.05
"""Time between points of the background, linear between them [s]: a tenth of the fastest sensor's
response.
"""


@dataclass(frozen=True, slots=True)
class Background:
    """CO2 above that of clean air, without the exhaust.

    Attributes
    ----------
    time : from the start of the flight on, shape (n,) [s]
    co2 : at these times, shape (n,) [ppm]
    """

    time: Array
    co2: Array

    def at(self, time: Array) -> Array:
        """Return it at some times of the flight, shape (m,) [ppm]."""
        return np.interp(time, self.time, self.co2)


UNIFORM = Background(np.zeros(1), np.zeros(1))
"""The background of clean air, which does not vary."""


def sampled_background(
    config: AirConfig, duration: float, generator: np.random.Generator
) -> Background:
    """Return one realisation of the background of a flight.

    Parameters
    ----------
    config : the ``[air]`` section
    duration : to be covered [s]
    generator : of the background alone, so that the rest of the flight is the same without it
    """
    if config.background == "none":
        return UNIFORM
    time = np.arange(0.0, duration + _STEP, _STEP)
    shape = _SHAPES[config.background](time, config.background_s, generator)
    return Background(time, config.background_ppm * shape)


def _haze(time: Array, correlation: float, generator: np.random.Generator) -> Array:
    """Return an Ornstein-Uhlenbeck process of standard deviation 1, shape (n,) [-].

    It forgets a share 1 - a of itself in a step, with a = exp(-step/correlation), and noise of
    variance 1 - a^2 takes its place, exactly (Gillespie, Phys. Rev. E 54:2084, 1996).
    """
    from scipy.signal import lfilter

    kept = math.exp(-_STEP / correlation)
    white = generator.standard_normal(len(time))
    white[1:] *= math.sqrt(1.0 - kept**2)
    return np.asarray(lfilter([1.0], [1.0, -kept], white))


def _sine(time: Array, period: float, generator: np.random.Generator) -> Array:
    """Return a sine of amplitude 1 and of any phase, shape (n,) [-]."""
    return np.sin(2.0 * math.pi * (time / period + generator.uniform()))


def _steps(time: Array, interval: float, generator: np.random.Generator) -> Array:
    """Return a level that jumps at random times, by a standard deviation of 1, shape (n,) [-]."""
    count = generator.poisson(time[-1] / interval)
    jumps = np.zeros(len(time))
    at = generator.integers(1, len(time), size=count)
    np.add.at(jumps, at, generator.standard_normal(count))
    return np.cumsum(jumps)


_SHAPES: Mapping[str, Callable[[Array, float, np.random.Generator], Array]] = {
    "haze": _haze,
    "sine": _sine,
    "steps": _steps,
}
"""Variation of each kind of background, over its size."""
