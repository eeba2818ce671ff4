"""Find an aircraft by name: those that this project brings, and those that JSBSim itself brings."""

import difflib

from aircraft.errors import AircraftError
from aircraft.fleet.aerosonde import AEROSONDE
from aircraft.fleet.stock import stock_names, stock_spec
from aircraft.fleet.x8 import X8
from aircraft.spec import AircraftSpec

OWN: dict[str, AircraftSpec] = {aircraft.name: aircraft for aircraft in (X8, AEROSONDE)}
"""Aircraft of this project, from published data."""


def aircraft_names() -> list[str]:
    """Return the name of every aircraft there is, this project's own first. Not all of them can be flown."""
    return [*OWN, *(name for name in stock_names() if name not in OWN)]


def find_spec(name: str) -> AircraftSpec:
    """Return the aircraft called ``name``.

    Raises
    ------
    AircraftError : there is none, or it is none that an autopilot could fly, with the reason
    """
    if name in OWN:
        return OWN[name]
    if name in stock_names():
        return stock_spec(name)
    close = difflib.get_close_matches(name.lower(), [known.lower() for known in aircraft_names()], n=1)
    guess = next((f"; did you mean '{known}'" for known in aircraft_names() if known.lower() in close), "")
    raise AircraftError(f"unknown aircraft '{name}'{guess}; `python -m innerloop.design --list` names those there are")
