"""Load and change a scenario in a program."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from scenarios.api.given_parts import Parts, named, registered
from scenarios.api.html import table
from scenarios.errors import InputError
from scenarios.scenario.errors import suggestion
from scenarios.scenario.files import AnyStudy, load_document, load_study, sweeps_speed_ratio
from scenarios.scenario.overrides import Document, as_toml

Given = str | os.PathLike[str] | Mapping[str, Any]
"""Source of a scenario: a name of the catalog, a TOML file's path, or its contents."""

_SHORT = {
    "law": "guidance.law",
    "shape": "reference.shape",
    "track": "vessel.track",
    "plume": "plume.model",
}
"""Short words for keys of parts."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """A checked scenario, returned by ``load``; changing it returns another one.

    Attributes
    ----------
    name : name of the scenario, on which the seeds of flights depend
    source : name in the catalog, path of the file, or contents of a file
    changes : keys that have been set, each as ``key=value`` like ``--set`` of the command line
    parts : parts given as objects
    config : the checked configuration with all defaults
    """

    name: str
    source: str | Document
    changes: tuple[str, ...] = ()
    parts: Parts = field(default=(), repr=False)
    config: AnyStudy = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        with registered(self.parts):
            object.__setattr__(self, "config", load_study(self.source, self.changes))

    @property
    def title(self) -> str:
        """Return the title of the scenario."""
        return self.config.title

    def set(self, **keys: object) -> "Scenario":
        """Return a scenario with keys set for every flight, like ``--set`` of the command line.

        Parameters
        ----------
        keys : dotted keys (``**{"wind.speed_mps": 5.0}``), sections (``wind={"speed_mps": 5.0}``),
            keys without a section (``seed=7``), and the words ``nu``, ``law``, ``shape``, ``track``
            and ``plume``: ``docs/reference/api.md``

        Raises
        ------
        InputError : a key is unknown or unused, or a value is out of range
        """
        if not keys:
            return self
        dotted = dict(_dotted(keys))
        if "nu" in dotted:
            nu = dotted.pop("nu")
            dotted = self._speed_ratio_key(nu) | dotted
        values, parts = named(dotted)
        # A part that is given again, as in a repeated notebook cell, replaces the former one.
        kept = [
            given
            for given in self.parts
            if (given.key, given.name) not in {(new.key, new.name) for new in parts}
        ]
        changes = [_change(key, value) for key, value in values.items()]
        return replace(self, changes=(*self.changes, *changes), parts=(*kept, *parts))

    def _speed_ratio_key(self, nu: object) -> dict[str, object]:
        """Return key and value that set the speed ratio, in the sweep or for the vessel."""
        nu = nu.tolist() if hasattr(nu, "tolist") else nu
        if isinstance(nu, list | tuple):
            return {"sweep.nu": nu}
        if not isinstance(nu, int | float) or isinstance(nu, bool):
            raise InputError(f"nu is {nu!r}; give a number, as in nu=0.5, or a list of numbers")
        return {"sweep.nu": [nu]} if sweeps_nu(self) else {"vessel.speed_ratio": nu}

    def __getitem__(self, key: str) -> Any:
        """Return the value of a dotted key.

        Raises
        ------
        InputError : there is no such key
        """
        value: Any = self.config.model_dump()
        for part in key.split("."):
            if isinstance(value, Mapping) and part in value:
                value = value[part]
            elif isinstance(value, list | tuple) and part.isdigit() and int(part) < len(value):
                value = value[int(part)]
            else:
                raise InputError(f"unknown key '{key}'{suggestion(type(self.config), key)}")
        return value

    def _repr_html_(self) -> str:
        """Return name, title and changes as an HTML table, for a notebook."""
        rows = [("name", self.name), ("study", self.config.study), ("title", self.title)]
        return table([*rows, *(tuple(change.split("=", maxsplit=1)) for change in self.changes)])


def sweeps_nu(scenario: Scenario) -> bool:
    """Return whether a scenario sets the speed ratio in its sweep or its cases."""
    return sweeps_speed_ratio(load_document(scenario.source, scenario.changes))


def load(scenario: Given | Scenario, /, *, name: str | None = None, **keys: object) -> Scenario:
    """Load and check a scenario.

    Parameters
    ----------
    scenario : name of a catalog scenario, path of a TOML file, a mapping with the contents of such
        a file, or a ``Scenario``
    name : name of the scenario; by default the file's name, or "scenario"
    keys : keys to set, as in ``Scenario.set``

    Raises
    ------
    InputError : the scenario does not exist, a key is unknown or unused, or a value is out of range
    """
    if isinstance(scenario, Scenario):
        made = replace(scenario, name=name) if name else scenario
    elif isinstance(scenario, Mapping):
        document, parts = named(scenario)
        made = Scenario(name=name or "scenario", source=document, parts=parts)
    elif not isinstance(scenario, str | os.PathLike):
        raise InputError(
            f"scenario is {scenario!r}, of type {type(scenario).__name__}; give the name of a"
            " catalog scenario, the path of a file,"
            " a mapping, or what load returned"
        )
    else:
        made = Scenario(name=name or Path(scenario).stem, source=os.fspath(scenario))
    return made.set(**keys)


def _change(key: str, value: object) -> str:
    """Return ``key=value`` in the form of the command line."""
    try:
        return f"{key}={as_toml(value)}"
    except InputError as error:
        raise InputError(f"{key}: {error}") from None


def _dotted(keys: Mapping[str, object]) -> list[tuple[str, object]]:
    """Return dotted keys and values from sections and short words; empty sections stay."""
    found: list[tuple[str, object]] = []
    for key, value in keys.items():
        if isinstance(value, Mapping) and value and "." not in key:
            found += [(f"{key}.{name}", item) for name, item in value.items()]
        else:
            found.append((_SHORT.get(key, key), value))
    return found
