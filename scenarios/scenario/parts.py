"""The parts that a scenario names: by a registered name, or by a Python file, FILE.py:NAME."""

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from common.files import is_data_file, is_file, is_path
from common.registry import file_of, is_file_part
from scenarios.errors import InputError
from scenarios.scenario.scenario import Scenario

_WORDS = ("title", "description", "author", "organisation")
"""Keys whose values are no names."""

_DATA = ("track", "table")
"""Last words of keys whose values may be files of data."""

_AIRCRAFT = "aircraft"
"""Key, and last word of keys, whose value may be a folder."""

_PICTURE = "logo"
"""Last word of the key whose value is the file of a picture."""

_TRIALS = "trials"
"""Key whose values may be scenario files."""

_OVERRIDES = "set"
"""Key of a list of trials, whose values are overrides, key=value."""


def part_names(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Yield the key and the name of each part of a scenario, including those among which its random
    variables choose.
    """
    named: dict[str, object] = {
        _AIRCRAFT: scenario.aircraft,
        "study": scenario.study,
        "reference.shape": scenario.reference.shape,
        "guidance.law": scenario.guidance.law,
        "following.margin_law": scenario.following.margin_law,
        "vessel.track": scenario.vessel.track,
        "plume.model": scenario.plume.model,
        "wind.table": scenario.wind.table,
        "search.methods": scenario.search.methods,
        "payload.instruments": scenario.payload.instruments,
    }
    drawn = [
        (draw.key, choice)
        for draw in scenario.draws
        if draw.key in named
        for choice in draw.choice or ()
    ]
    for key, value in [*named.items(), *drawn]:
        if isinstance(value, list | tuple):
            yield from ((key, str(name)) for name in value)
        elif value is not None:
            yield key, str(value)


def with_absolute_files(value: Any, folder: Path, key: str = "") -> Any:
    """Return a document, or a value of one, with absolute paths of the files of parts, data and
    trials, and of the folders of aircraft.

    Parameters
    ----------
    value : the document, a table, a list or a single value
    folder : directory that the files are relative to
    key : key of the value; only the keys in ``_DATA`` name files of data, and only ``_PICTURE``
        names a picture

    Raises
    ------
    InputError : a key is not text, which is possible in a program's mapping, but not in a TOML file
    """
    last = key.rpartition(".")[2]
    if last in _WORDS or (key == _OVERRIDES and isinstance(value, list)):
        return value
    if isinstance(value, dict):
        for name in value:
            if not isinstance(name, str):
                where, kind = f"'{key}'" if key else "the scenario", type(name).__name__
                raise InputError(
                    f"{where} has the key {name!r}, a value of {kind}; keys are words in text"
                )
        # In a random variable the key is an entry beside the choices.
        named = str(value.get("key", ""))
        return {
            name: with_absolute_files(below, folder, named if name == "choice" else name)
            for name, below in value.items()
        }
    if isinstance(value, list):
        return [with_absolute_files(below, folder, key) for below in value]
    if isinstance(value, str) and (
        (value and last == _PICTURE) or (key == _TRIALS and value.endswith(".toml"))
    ):
        return os.path.normpath(folder.absolute() / value)
    if isinstance(value, str) and (
        is_file_part(value) or (last in _DATA and is_data_file(value)) or names_folder(last, value)
    ):
        return os.path.normpath(folder.absolute() / value)
    return value


def refuse_missing(key: str, value: Any, absolute: Any) -> None:
    """Refuse a part whose file does not exist, if a program or the command line names it relative
    to the current directory.

    Parameters
    ----------
    key, value : as given
    absolute : the value with absolute paths

    Raises
    ------
    InputError : there is no such file
    """
    given, found = (of if isinstance(of, list) else [of] for of in (value, absolute))
    for name, path in zip(given, found, strict=True):
        if (
            isinstance(path, str)
            and path != name
            and is_file_part(path)
            and not is_file(file_of(path))
        ):
            raise InputError(
                f"{key}: {file_of(path)}: there is no such file; check the path, relative to the"
                " current directory"
            )


def names_folder(key: str, name: str) -> bool:
    """Return whether a key's value is the folder of an aircraft, DIR/NAME."""
    return key == _AIRCRAFT and is_path(name) and not is_file_part(name)


def names_file(name: str) -> bool:
    """Return whether the name of a part is a file: FILE.py:NAME, or a file of data."""
    return is_file_part(name) or is_data_file(name)
