"""A scenario in a program: loaded, changed, looked at."""

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
"""What a scenario is loaded from: a name of the catalog, the path of a TOML file, or what such a
file holds.
"""

_SHORT = {
    "law": "guidance.law",
    "shape": "reference.shape",
    "track": "vessel.track",
    "plume": "plume.model",
}
"""Words for parts that are given as objects or by name, and the keys that they stand for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scenario:
    """A scenario that is checked and can be flown; changing it makes another one. Made by ``load``.

    Attributes
    ----------
    name : of the scenario; the seeds of flights depend on it
    source : name in the catalog, path of the file, or the document that it was loaded from
    changes : keys that were set since, as ``key=value``, as ``--set`` of the command line has them
    parts : what was given as objects
    config : everything, with defaults, checked
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
        """Return its title."""
        return self.config.title

    def set(self, **keys: object) -> "Scenario":
        """Return the scenario with keys set for every flight, as ``--set`` of the command line
        does.

        Parameters
        ----------
        keys : dotted keys (``**{"wind.speed_mps": 5.0}``), sections (``wind={"speed_mps": 5.0}``),
            keys without a section (``seed=7``), and the words ``nu``, ``law``, ``shape``, ``track``
            and ``plume``: ``docs/reference/api.md``

        Raises
        ------
        InputError : an unknown key, a value out of range, or a key that no part of the flights
            uses; one line
        """
        if not keys:
            return self
        dotted = dict(_dotted(keys))
        if "nu" in dotted:
            nu = dotted.pop("nu")
            dotted = self._of_nu(nu) | dotted
        values, parts = named(dotted)
        # A part that is given again, as from a cell that was run again, takes the place of the one
        # before.
        kept = [
            given
            for given in self.parts
            if (given.key, given.name) not in {(new.key, new.name) for new in parts}
        ]
        changes = [_change(key, value) for key, value in values.items()]
        return replace(self, changes=(*self.changes, *changes), parts=(*kept, *parts))

    def _of_nu(self, nu: object) -> dict[str, object]:
        """Return the key that sets the speed ratio: that of the sweep or of the cases, where they
        have one.
        """
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
        """Return name, title and changes as a table, for a notebook."""
        rows = [("name", self.name), ("study", self.config.study), ("title", self.title)]
        return table([*rows, *(tuple(change.split("=", maxsplit=1)) for change in self.changes)])


def sweeps_nu(scenario: Scenario) -> bool:
    """Return whether a scenario sets the speed ratio in its sweep or in its cases."""
    return sweeps_speed_ratio(load_document(scenario.source, scenario.changes))


def load(scenario: Given | Scenario, /, *, name: str | None = None, **keys: object) -> Scenario:
    """Return a scenario, checked.

    Parameters
    ----------
    scenario : a name of the catalog, the path of a TOML file, what such a file holds, as a mapping,
        or a scenario
    name : of the scenario; that of the file, or "scenario", if not given
    keys : same as ``Scenario.set``

    Raises
    ------
    InputError : no such scenario, an unknown key, a value out of range, or a key that no part of
        the flights uses; one line
    """
    if isinstance(scenario, Scenario):
        made = replace(scenario, name=name) if name else scenario
    elif isinstance(scenario, Mapping):
        document, parts = named(scenario)
        made = Scenario(name=name or "scenario", source=document, parts=parts)
    elif not isinstance(scenario, str | os.PathLike):
        raise InputError(
            f"scenario is {scenario!r}, of type {type(scenario).__name__}; give the name of a catalog scenario, the path of a file,"
            " a mapping, or what load returned"
        )
    else:
        made = Scenario(name=name or Path(scenario).stem, source=os.fspath(scenario))
    return made.set(**keys)


def _change(key: str, value: object) -> str:
    """Return ``key=value`` as the command line has it."""
    try:
        return f"{key}={as_toml(value)}"
    except InputError as error:
        raise InputError(f"{key}: {error}") from None


def _dotted(keys: Mapping[str, object]) -> list[tuple[str, object]]:
    """Return keys with dots in place of sections, and of the words that stand for keys; an empty
    section stays, and is set so.
    """
    found: list[tuple[str, object]] = []
    for key, value in keys.items():
        if isinstance(value, Mapping) and value and "." not in key:
            found += [(f"{key}.{name}", item) for name, item in value.items()]
        else:
            found.append((_SHORT.get(key, key), value))
    return found
