"""What a ship's stack emits: gases, heat and momentum, from speed or power and the fuel."""

import functools
import math
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib.resources import files
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from common.physics import STANDARD_GRAVITY
from measurement.errors import MeasurementError, check_keys, check_range, number
from measurement.gases import (
    CARBON_FRACTION,
    CARBON_MASS,
    CARBON_PER_CO2,
    FUEL_SULPHUR_MOST,
    METHANE_MASS,
    MOLAR_MASS,
    SULPHUR_MASS,
)

GAS_CONSTANT = 8.314462618
"""Molar gas constant [J/(mol K)]."""

AIR_TEMPERATURE = 288.15
"""Temperature of the standard atmosphere at sea level [K]."""

AIR_PRESSURE = 101325.0
"""Pressure of the standard atmosphere at sea level [Pa]."""

SULPHUR_AS_SO2 = 0.97753
"""Share of the fuel's sulphur that leaves as SO2, not as sulphate [-] (IMO GHG4, eq. 15)."""

NO2_SHARE = 0.10
"""Share of NO2 in NOx by mole, once the ozone is used up [-]; assumed within 0.05 to 0.15."""

DEFAULT_STACK_HEIGHT = 60.0
"""Height of the stack above the sea where neither a height nor a ship is given [m]."""

UNTITLED_SHIP = "own ship"
"""Name of a ship from an inline table without a title."""

_EXHAUST_MOLAR_MASS = 28.8e-3
"""Molar mass of exhaust with 4.5 % CO2 and 5 % water [kg/mol]; an assumption."""

_KILOWATT_HOUR = 3.6e6
"""Kilowatt-hour [J]."""

FUEL_G_KWH = {
    (2, False): 185.0,
    (2, True): 195.0,
    (4, False): 205.0,
    (4, True): 215.0,
}
"""Fuel consumption [g/kWh] by stroke and whether residual (USEPA Marine_Emissions_Tools)."""

_NOX_G_KWH = {
    (2, False): (17.0, 16.0, 14.4, 3.4),
    (2, True): (18.1, 17.0, 15.3, 3.6),
    (4, False): (13.2, 12.2, 10.5, 2.6),
    (4, True): (13.2, 12.2, 10.5, 2.6),
}
"""NOx as NO2 [g/kWh] by stroke, whether residual, and tier (USEPA Marine_Emissions_Tools)."""

_LOAD_MIN = 0.05
"""Least load of an engine under way, dead slow [-]; an assumption."""

_POSITIVE = (
    "power_max",
    "speed_max",
    "stack_height",
    "stack_diameter",
    "exhaust_per_energy_kg_kwh",
)
"""Fields of a ship that must be above 0."""


@dataclass(frozen=True, kw_only=True)
class Fuel:
    """A fuel.

    Attributes
    ----------
    name : in files
    title : in reports
    residual : whether it is a residual fuel: the engine needs more of it and makes more NOx
    co2_per_fuel : CO2 by mass of fuel [kg/kg]; the carbon fraction follows from it
    sulphur_percent : FSC, fuel sulphur content by mass [% m/m], 0 to 5

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    name: str
    title: str
    residual: bool
    co2_per_fuel: float
    sulphur_percent: float

    def __post_init__(self) -> None:
        check_range(f"FSC of {self.name}", self.sulphur_percent, 0.0, FUEL_SULPHUR_MOST, " % m/m")
        least, most = 0.5 / CARBON_PER_CO2, 1.0 / CARBON_PER_CO2
        check_range(f"CO2 of {self.name}", self.co2_per_fuel, least, most, " kg/kg")

    @property
    def carbon_fraction(self) -> float:
        """Carbon by mass [-]: 0.8750 for gas oil, 0.8499 for residual fuels."""
        return self.co2_per_fuel * CARBON_PER_CO2

    @property
    def so2_per_fuel(self) -> float:
        """SO2 per fuel [mol/kg]: 19.55 g/kg per per cent of sulphur."""
        return SULPHUR_AS_SO2 * self.sulphur_percent / 100.0 / SULPHUR_MASS


@dataclass(frozen=True, kw_only=True)
class Ship:
    """Engine and stack of a ship: all engines as one, all pipes as one, no auxiliary engines.

    Attributes
    ----------
    name : in files
    title : in reports
    stroke : strokes of the main engine, 2 or 4
    nox_tier : IMO's tier of NOx, 0 to 3
    power_max : power of the main engine at its maximum continuous rating [W]
    speed_max : speed that this power gives [m/s]
    stack_height : height of the stack's mouth above the sea [m]
    stack_diameter : inner diameter of the stack's mouth [m]
    exhaust_per_energy_kg_kwh : exhaust per energy at maximum continuous rating; corrected for part
        load [kg/kWh]
    exhaust_temperature_c : temperature of the exhaust at maximum continuous rating; corrected for
        part load [°C]
    wake_spread : initial spread of the plume in the superstructure's wake [m], 0 to 20

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    name: str
    title: str
    stroke: int
    nox_tier: int
    power_max: float
    speed_max: float
    stack_height: float
    stack_diameter: float
    exhaust_per_energy_kg_kwh: float
    exhaust_temperature_c: float
    wake_spread: float

    def __post_init__(self) -> None:
        if self.stroke not in {2, 4}:
            raise MeasurementError(f"stroke of {self.name} is {self.stroke}; it must be 2 or 4")
        if self.nox_tier not in {0, 1, 2, 3}:
            raise MeasurementError(
                f"NOx tier of {self.name} is {self.nox_tier}; it must be 0, 1, 2 or 3"
            )
        for name in _POSITIVE:
            value = getattr(self, name)
            if not 0.0 < value < math.inf:
                raise MeasurementError(
                    f"{name} of {self.name} is {value:g}; it must be finite and above 0"
                )
        temperature, spread = self.exhaust_temperature_c, self.wake_spread
        check_range(f"exhaust_temperature_c of {self.name}", temperature, 100.0, 600.0)
        check_range(f"wake_spread of {self.name}", spread, 0.0, 20.0, " m")


@dataclass(frozen=True, kw_only=True)
class Emission:
    """What leaves the stack.

    Attributes
    ----------
    rates : mol/s of each of ``measurement.gases.GASES``, in that order
    buoyancy_flux : F = g w d^2/4 (1 - Ta/Ts) [m4/s3], with Ta of the air and Ts of the exhaust
    momentum_flux : Fm = (Ta/Ts) w^2 d^2/4 [m4/s2]
    stack_diameter : d [m]
    exhaust_speed : w at the stack's mouth [m/s]
    wake_spread : initial spread in the superstructure's wake [m]
    """

    rates: tuple[float, ...]
    buoyancy_flux: float
    momentum_flux: float
    stack_diameter: float
    exhaust_speed: float
    wake_spread: float


def emission_of(
    ship: Ship,
    fuel: Fuel,
    *,
    speed: float | None = None,
    power: float | None = None,
    methane: float = 0.0,
    air_temperature: float = AIR_TEMPERATURE,
) -> Emission:
    """Return what a ship emits on a fuel at a speed through the water or at a power.

    Parameters
    ----------
    ship, fuel : engine and stack, and what the engine burns
    speed : [m/s], 0 to the ship's largest; the power goes with its cube and is at least 5 %
        (dead slow)
    power : [W], above 0 to the ship's largest; give speed or power
    methane : that leaves unburnt, by mass of fuel [-]; its carbon is missing in the CO2
    air_temperature : around the stack [K]

    Raises
    ------
    MeasurementError : speed, power or temperature is out of range; both or neither of speed and
        power are given; or the air is hotter than the exhaust

    Notes
    -----
    Power P = P_max (v/v_max)^3: BSH library 188756, p. 17. Consumption with load: STEAM2, ACP
    12:2641 (2012). Exhaust at part load: MAN B&W project guide 198 43 20-3.3, figs. 6.04.11 and
    6.04.12, applied to all ships and loads. At dead slow the exhaust is 131 K hotter than at full
    power, which has not been checked. Fluxes: Briggs, as in AERMOD.
    """
    check_air(air_temperature, AIR_PRESSURE)
    load = _load(ship, speed, power)
    energy_rate = load * ship.power_max / _KILOWATT_HOUR
    engine = (ship.stroke, fuel.residual)
    fuel_rate = 1e-3 * FUEL_G_KWH[engine] * consumption_with_load(load) * energy_rate
    nox = 1e-3 * _NOX_G_KWH[engine][ship.nox_tier] * energy_rate / MOLAR_MASS["no2"]
    rates = (
        fuel_rate * fuel.so2_per_fuel,
        fuel_rate * fuel.co2_per_fuel / MOLAR_MASS["co2"] - fuel_rate * methane / METHANE_MASS,
        (1.0 - NO2_SHARE) * nox,
        NO2_SHARE * nox,
    )
    temperature = ship.exhaust_temperature_c + 273.15 + 262.0 * load**2 - 413.0 * load + 151.0
    if not temperature > air_temperature:
        raise MeasurementError(
            f"exhaust of {ship.name} has {temperature:.0f} K in air of {air_temperature:.0f} K; "
            "it must be hotter than the air"
        )
    more_exhaust_percent = 37.0 * load**3 - 83.0 * load**2 + 31.0 * load + 15.0
    mass_rate = ship.exhaust_per_energy_kg_kwh * (1.0 + more_exhaust_percent / 100.0) * energy_rate
    volume_rate = mass_rate / _EXHAUST_MOLAR_MASS * GAS_CONSTANT * temperature / AIR_PRESSURE
    quarter_square = ship.stack_diameter**2 / 4.0
    exhaust_speed = volume_rate / (math.pi * quarter_square)
    air_over_exhaust = air_temperature / temperature
    return Emission(
        rates=rates,
        buoyancy_flux=STANDARD_GRAVITY * exhaust_speed * quarter_square * (1.0 - air_over_exhaust),
        momentum_flux=air_over_exhaust * exhaust_speed**2 * quarter_square,
        stack_diameter=ship.stack_diameter,
        exhaust_speed=exhaust_speed,
        wake_spread=ship.wake_spread,
    )


_Load = TypeVar("_Load", float, npt.NDArray[np.float64])


def consumption_with_load(load: _Load) -> _Load:
    """Return an engine's fuel consumption at a load [-] over that of its data sheet [-].

    Source: STEAM2 (Jalkanen et al., ACP 12:2641, 2012); least, 1.003, at a load of 0.78.
    """
    return 0.455 * load**2 - 0.71 * load + 1.28


def _load(ship: Ship, speed: float | None, power: float | None) -> float:
    """Return the share of the largest power [-]."""
    if speed is not None and power is None:
        check_range(f"speed of {ship.name}", speed, 0.0, ship.speed_max, " m/s")
        return max(_LOAD_MIN, (speed / ship.speed_max) ** 3)
    if power is not None and speed is None:
        if not 0.0 < power <= ship.power_max:
            raise MeasurementError(
                f"power of {ship.name} is {power:g} W; "
                f"it must be above 0 and at most {ship.power_max:g} W"
            )
        return power / ship.power_max
    given = "neither is" if speed is None else "both are"
    raise MeasurementError(
        f"emission needs speed or power of {ship.name}, and {given} given; give one of them"
    )


def check_air(temperature: float, pressure: float) -> None:
    """Refuse air that does not occur near the Earth's surface.

    Parameters
    ----------
    temperature, pressure : [K, Pa]

    Raises
    ------
    MeasurementError : one of them is out of its range
    """
    check_range("air temperature", temperature, 220.0, 330.0, " K")
    check_range("air pressure", pressure, 5e4, 1.1e5, " Pa")


def expected_fsc(fuel: Fuel, methane: float = 0.0) -> float:
    """Return the fuel sulphur content that a perfect instrument reads [% m/m].

    With ``methane`` that leaves unburnt, by mass of fuel [-], it reads more: less carbon is CO2.

    It does not see the sulphate, and it assumes the carbon of ``CARBON_FRACTION``. Gas oil of
    0.1000 reads 0.0972; residual fuel of 0.5000 reads 0.5003, because the two errors cancel. An
    estimate is judged against this value; its difference from the fuel's content is a bias of the
    method.
    """
    burnt = fuel.carbon_fraction - methane * CARBON_MASS / METHANE_MASS
    return fuel.sulphur_percent * SULPHUR_AS_SO2 * CARBON_FRACTION / burnt


def fuel_preset(name: str, sulphur_percent: float | None = None) -> Fuel:
    """Return a fuel of ``fuels.toml``, with its usual sulphur content or another [% m/m].

    Raises
    ------
    MeasurementError : the name is not known, or the content is not within 0 to 5
    """
    values = _preset("fuel", name)
    if sulphur_percent is not None:
        values["sulphur_percent"] = sulphur_percent
    return Fuel(name=name, **values)


def ship_of(given: str | Mapping[str, Any]) -> Ship:
    """Return a ship by its name in ``ships.toml``, or from an inline table.

    A table has every field of ``Ship`` but ``name``; ``title`` may be left out.

    Raises
    ------
    MeasurementError : the name is not known, a key is not known or is missing, or a value is not of
        its kind or range
    """
    if isinstance(given, str):
        name, table = given, _preset("ship", given)
    else:
        name, table = str(given.get("title", UNTITLED_SHIP)), dict(given)
    where = f"ship '{name}'"
    numbers = [field.name for field in fields(Ship) if field.name not in ("name", "title")]
    check_keys(table, ["title", *numbers], where)
    for key in numbers:
        if key not in table:
            raise MeasurementError(f"{where} has no {key}; give all of {', '.join(numbers)}")
    values: dict[str, Any] = {key: number(table[key], key, where) for key in numbers}
    for key in ("stroke", "nox_tier"):
        if values[key].is_integer():
            values[key] = int(values[key])
    return Ship(name=name, title=str(table.get("title", name)), **values)


def stack_height_of(given: float | None, ship: str | Mapping[str, Any] | None) -> float:
    """Return the height of the stack above the sea [m]: given, or the ship's, or the default.

    Raises
    ------
    MeasurementError : the ship is not known, or its table is invalid
    """
    if given is not None:
        return given
    if ship is None:
        return DEFAULT_STACK_HEIGHT
    return ship_of(ship).stack_height


def _preset(kind: str, name: str) -> dict[str, Any]:
    """Return the fields of a fuel or a ship by its name."""
    tables = _tables(f"{kind}s.toml")
    if name not in tables:
        raise MeasurementError(f"{kind} {name!r} is not known; there are {', '.join(tables)}")
    return dict(tables[name])


@functools.cache
def _tables(file: str) -> dict[str, dict[str, Any]]:
    return tomllib.loads(files("measurement").joinpath(file).read_text(encoding="utf-8"))
