"""From a ship's speed or power and its fuel to moles, heat and momentum per second."""

import math
from dataclasses import dataclass

from measurement.emission.fuel import Fuel
from measurement.emission.ship import Ship
from measurement.errors import MeasurementError
from measurement.gases import MOLAR_MASS

GRAVITY = 9.80665
"""Standard acceleration of gravity [m/s2]."""

GAS_CONSTANT = 8.314462618
"""Molar gas constant [J/(mol K)]."""

AIR_TEMPERATURE, AIR_PRESSURE = 288.15, 101325.0
"""Temperature [K] and pressure [Pa] of the air where none are given: the standard atmosphere at sea
level.
"""

_EXHAUST_MOLAR_MASS = 28.8e-3
"""Of exhaust [kg/mol]: lean exhaust is within 1 % of air. Derived from 4.5 % CO2 and 5 % water; an
assumption.
"""

_KILOWATT_HOUR = 3.6e6

_SFOC_G_KWH = {2: (185.0, 195.0), 4: (205.0, 215.0)}
"""Baseline of the specific fuel consumption [g/kWh] by stroke, for distillates and residual fuels:
USEPA Marine_Emissions_Tools.
"""

_NOX_G_KWH = {
    2: ((17.0, 16.0, 14.4, 3.4), (18.1, 17.0, 15.3, 3.6)),
    4: ((13.2, 12.2, 10.5, 2.6), (13.2, 12.2, 10.5, 2.6)),
}
"""NOx as NO2 [g/kWh] by stroke, for distillates and residual fuels, by tier: USEPA
Marine_Emissions_Tools. At any load.
"""

NO2_SHARE = 0.10
"""Share of NO2 in NOx by mole [-], after entrained ozone has been used up.

An assumption: makers give about 5 % at the engine, the range is 5 to 15 %.
"""

_LOAD_MIN = 0.05
"""Least load of an engine under way [-]: dead slow; an assumption. The cubic law goes to nothing,
engines do not.
"""


@dataclass(frozen=True, kw_only=True)
class Emission:
    """What leaves the funnel, and how.

    Attributes
    ----------
    rates : mol/s of each of ``measurement.gases.GASES``, in that order
    fuel_rate : fuel burnt [kg/s]
    power : of the engine [W]
    buoyancy_flux : F = g w d^2/4 (1 - Ta/Ts) [m4/s3]
    momentum_flux : Fm = (Ta/Ts) w^2 d^2/4 [m4/s2]
    stack_height, stack_diameter : [m]
    exhaust_speed, exhaust_temperature : at the funnel's mouth [m/s, K]
    wake_spread : initial spread in the superstructure's wake [m]
    """

    rates: tuple[float, ...]
    fuel_rate: float
    power: float
    buoyancy_flux: float
    momentum_flux: float
    stack_height: float
    stack_diameter: float
    exhaust_speed: float
    exhaust_temperature: float
    wake_spread: float


def emission_of(
    ship: Ship,
    fuel: Fuel,
    *,
    speed: float | None = None,
    power: float | None = None,
    air_temperature: float = AIR_TEMPERATURE,
) -> Emission:
    """Return what ``ship`` emits on ``fuel`` at a speed through the water or at a power.

    Parameters
    ----------
    ship, fuel : who burns what
    speed : [m/s], 0 to the ship's largest; the power is its cube's share, and at least 5 % (dead
        slow)
    power : [W], above 0 to the ship's largest; give speed or power
    air_temperature : around the funnel [K]

    Raises
    ------
    MeasurementError : speed, power or temperature out of range, both or neither of the first two,
        or air hotter than the exhaust

    Sources: P = P_max (v/v_max)^3, BSH library 188756, p. 17; consumption with load, STEAM2, ACP
    12:2641 (2012); exhaust at part load, MAN B&W project guide 198 43 20-3.3, figs. 6.04.11 and
    6.04.12, applied to all ships and loads: dead slow, exhaust is by 131 K hotter than at full
    power, which nobody has checked there; fluxes, Briggs, as in AERMOD.
    """
    check_air(air_temperature, AIR_PRESSURE)
    load = _load(ship, speed, power)
    energy_rate = load * ship.power_max / _KILOWATT_HOUR
    fuel_rate = (
        1e-3
        * _SFOC_G_KWH[ship.stroke][fuel.residual]
        * (0.455 * load**2 - 0.71 * load + 1.28)
        * energy_rate
    )
    nox = (
        1e-3
        * _NOX_G_KWH[ship.stroke][fuel.residual][ship.nox_tier]
        * energy_rate
        / MOLAR_MASS["no2"]
    )
    rates = (
        fuel_rate * fuel.so2_per_fuel,
        fuel_rate * fuel.co2_per_fuel / MOLAR_MASS["co2"],
        (1.0 - NO2_SHARE) * nox,
        NO2_SHARE * nox,
    )
    temperature = ship.exhaust_temperature_c + 273.15 + 262.0 * load**2 - 413.0 * load + 151.0
    if not temperature > air_temperature:
        raise MeasurementError(
            f"exhaust of {ship.name} has {temperature:.0f} K in air of {air_temperature:.0f} K; it must be hotter"
        )
    more_percent = 37.0 * load**3 - 83.0 * load**2 + 31.0 * load + 15.0
    mass_rate = ship.exhaust_per_energy_kg_kwh * (1.0 + more_percent / 100.0) * energy_rate
    volume_rate = mass_rate / _EXHAUST_MOLAR_MASS * GAS_CONSTANT * temperature / AIR_PRESSURE
    quarter = ship.stack_diameter**2 / 4.0
    exhaust_speed = volume_rate / (math.pi * quarter)
    ratio = air_temperature / temperature
    return Emission(
        rates=rates,
        fuel_rate=fuel_rate,
        power=load * ship.power_max,
        buoyancy_flux=GRAVITY * exhaust_speed * quarter * (1.0 - ratio),
        momentum_flux=ratio * exhaust_speed**2 * quarter,
        stack_height=ship.stack_height,
        stack_diameter=ship.stack_diameter,
        exhaust_speed=exhaust_speed,
        exhaust_temperature=temperature,
        wake_spread=ship.wake_spread,
    )


def _load(ship: Ship, speed: float | None, power: float | None) -> float:
    """Share of the largest power [-]."""
    if (speed is None) == (power is None):
        given = "neither is" if speed is None else "both are"
        raise MeasurementError(
            f"emission needs speed or power of {ship.name}, and {given} given; give one of them"
        )
    if speed is not None:
        if not 0.0 <= speed <= ship.speed_max:
            raise MeasurementError(
                f"speed of {ship.name} is {speed:g} m/s; it makes 0 to {ship.speed_max:g}: go slower or take a faster ship"
            )
        return max(_LOAD_MIN, (speed / ship.speed_max) ** 3)
    if power is None or not 0.0 < power <= ship.power_max:
        raise MeasurementError(
            f"power of {ship.name} is {power or 0.0:g} W; it has above 0 to {ship.power_max:g}"
        )
    return power / ship.power_max


def check_air(temperature: float, pressure: float) -> None:
    """Refuse air that is not that of the earth near its surface.

    Parameters
    ----------
    temperature, pressure : [K, Pa]

    Raises
    ------
    MeasurementError : one of them is out of its range
    """
    if not 220.0 <= temperature <= 330.0:
        raise MeasurementError(
            f"air temperature is {temperature:g} K; give 220 to 330, 288.15 is 15 degC"
        )
    if not 5e4 <= pressure <= 1.1e5:
        raise MeasurementError(
            f"air pressure is {pressure:g} Pa; give 5e4 to 1.1e5, 101325 is standard"
        )
