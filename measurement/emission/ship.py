"""Ships: engine and funnel."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

from measurement.emission.presets import preset
from measurement.errors import MeasurementError, guess, number

_FILE = "ships.toml"

WITHOUT_SHIP = 60.0
"""Height of a plume's origin above the sea where neither it nor a ship is given [m]."""

OWN = "own ship"
"""What a ship from a table is called that has no title."""

_WORDS, _WHOLE = ("name", "title"), ("stroke", "nox_tier")
"""Fields of a ship that are no numbers, and those that are whole ones."""

_POSITIVE = (
    "power_max",
    "speed_max",
    "stack_height",
    "stack_diameter",
    "exhaust_per_energy_kg_kwh",
)


@dataclass(frozen=True, kw_only=True)
class Ship:
    """Engine and funnel of a ship. Several engines are one, and their pipes one funnel; auxiliary
    engines are left out.

    Attributes
    ----------
    name : what she is called in files
    title : what she is called in reports
    stroke : strokes of the main engine, 2 or 4
    nox_tier : IMO's tier of NOx, 0 to 3
    power_max : power of the main engine at its maximum continuous rating [W]
    speed_max : speed that this power gives [m/s]
    stack_height : height of the funnel's mouth above the sea [m]
    stack_diameter : inner diameter of the funnel's mouth [m]
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
            raise MeasurementError(f"stroke of {self.name} is {self.stroke}; an engine has 2 or 4")
        if self.nox_tier not in {0, 1, 2, 3}:
            raise MeasurementError(
                f"NOx tier of {self.name} is {self.nox_tier}; there are 0, 1, 2 and 3"
            )
        for name in _POSITIVE:
            if not 0.0 < getattr(self, name) < math.inf:
                raise MeasurementError(
                    f"{name} of {self.name} is {getattr(self, name):g}; give a finite value above 0"
                )
        if not 100.0 <= self.exhaust_temperature_c <= 600.0:
            raise MeasurementError(
                f"exhaust_temperature_c of {self.name} is {self.exhaust_temperature_c:g}; give 100 to 600"
            )
        if not 0.0 <= self.wake_spread <= 20.0:
            raise MeasurementError(
                f"wake_spread of {self.name} is {self.wake_spread:g} m; give 0 to 20, usually 0 to 8"
            )


def ship_preset(name: str) -> Ship:
    """Return the ship ``name``.

    Raises
    ------
    MeasurementError : the name is not known
    """
    return read_ship(preset(_FILE, "ship", name), name)


def ship_of(given: str | Mapping[str, Any]) -> Ship:
    """Return a ship by its name, or from a table; one without a title is called ``OWN``. Errors as
    of the two.
    """
    return (
        ship_preset(given)
        if isinstance(given, str)
        else read_ship(given, str(given.get("title", OWN)))
    )


def read_ship(table: Mapping[str, Any], name: str) -> Ship:
    """Return a ship from a table with the fields of ``Ship``, of which its name and its title may
    be left out.

    Raises
    ------
    MeasurementError : a key is not known or is missing, or a value is not of its kind or range
    """
    where, numbers = (
        f"ship '{name}'",
        [field.name for field in fields(Ship) if field.name not in _WORDS],
    )
    known = ["title", *numbers]
    if unknown := [key for key in table if key not in known]:
        raise MeasurementError(
            f"{where} has the key '{unknown[0]}'{guess(unknown[0], known)} it may have {', '.join(known)}"
        )
    if missing := [key for key in numbers if key not in table]:
        raise MeasurementError(f"{where} has no {missing[0]}; give all of {', '.join(numbers)}")
    values: dict[str, Any] = {key: number(table[key], key, where) for key in numbers}
    values |= {key: int(values[key]) for key in _WHOLE if values[key].is_integer()}
    return Ship(name=name, title=str(table.get("title", name)), **values)


def funnel_height(given: float | None, ship: str | Mapping[str, Any] | None) -> float:
    """Return the height of a funnel's mouth above the sea: as it is given, else the ship's own,
    else ``WITHOUT_SHIP`` [m].

    Raises
    ------
    MeasurementError : the ship is not known, or its table is of no use
    """
    if given is not None:
        return given
    return WITHOUT_SHIP if ship is None else ship_of(ship).stack_height
