"""The aircraft of a directory in a scenario: ``--aircraft-dir DIR`` says where the aircraft that it
names is.
"""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from aircraft.fleet.find import folder_names, folder_path
from aircraft.spec import AircraftError
from scenarios.errors import InputError
from scenarios.scenario.load import load_document
from scenarios.scenario.overrides import parse_override

KEY = "aircraft"


def aircraft_from(directory: Path, name: str, overrides: Sequence[str]) -> list[str]:
    """Return overrides that take the aircraft from ``directory``: that of ``--set aircraft=NAME``,
    else the scenario's if it is there, else the only one there.

    Parameters
    ----------
    directory : with folders of aircraft
    name : of the scenario
    overrides : of its keys

    Raises
    ------
    InputError : no such scenario, directory or aircraft, or several to choose from
    """
    keys = [parse_override(override) for override in overrides]
    demanded = next((str(value) for key, value in reversed(keys) if key == KEY), None)
    if demanded is None and (usual := load_document(name, overrides).get(KEY)) in _names(directory):
        demanded = str(usual)
    path = folder_of(directory, demanded)
    return [
        *(override for override, (key, _) in zip(overrides, keys, strict=True) if key != KEY),
        f"{KEY}={json.dumps(path)}",
    ]


def folder_of(directory: Path, name: str | None) -> str:
    """Return the path of an aircraft in ``directory``: of the one called ``name``, or else of the
    only one.

    Raises
    ------
    InputError : there is none of this name, or there are several
    """
    with _explained():
        return folder_path(directory, name)


def _names(directory: Path) -> list[str]:
    with _explained():
        return folder_names(directory)


@contextmanager
def _explained() -> Iterator[None]:
    try:
        yield
    except AircraftError as error:
        raise InputError(str(error)) from None
