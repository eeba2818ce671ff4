"""Parts given as objects: each gets a name under which it is registered temporarily."""

import copy
import pickle
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from typing import Any

from common.errors import PluginError
from common.registry import Registry
from scenarios.engine.task import Result, Task, Work
from scenarios.errors import InputError
from scenarios.scenario.added_keys import ADDED
from scenarios.world.ais import AisReports

PLAIN = (bool, int, float, str)
"""Types of values in a scenario file."""

_LAWS = (
    *("guidance.law", "following.margin_law"),
    *(key for keys in ADDED for key in keys.LAW_KEYS),
)
_COPIED = ("vessel.track", "reference.shape")
"""Keys whose part may be an existing object; each flight takes a copy."""


_TABLES_OF_KEYS = ("set", "set_kinematic", "tuning_set")
"""Last words of tables whose entries are dotted keys."""


@dataclass(frozen=True, slots=True)
class Copies:
    """A part that each flight copies, so that flights do not share its state."""

    part: object

    def __call__(self, *_given: object, **_named: object) -> object:
        """Return a copy."""
        return copy.deepcopy(self.part)


@dataclass(frozen=True, slots=True)
class GivenPart:
    """A part that was given as an object.

    Attributes
    ----------
    key : key of the scenario
    name : name in the scenario
    part : the part as the registry has it
    """

    key: str
    name: str
    part: Any


Parts = tuple[GivenPart, ...]


@contextmanager
def registered(parts: Parts) -> Iterator[None]:
    """Register parts under their names inside the context.

    Raises
    ------
    InputError : another part has one of the names
    """
    from scenarios.planning.reference import orbits

    with ExitStack() as stack:
        for given in parts:
            try:
                stack.enter_context(
                    _registry(given.key).temporarily_registered(given.name, given.part)
                )
            except PluginError as error:
                raise InputError(f"{given.key}: {error}") from None
        if any(given.key == "reference.shape" for given in parts):
            # The cache's key is the shape's name, which may have belonged to another shape.
            orbits.cache_clear()
        yield


@dataclass(frozen=True, slots=True)
class WorkWithParts:
    """Work together with parts given as objects, so that other processes can register them."""

    wrapped: Work
    parts: Parts

    @property
    def model(self) -> Path | None:
        """Return the directory of the files that the work needs, or None."""
        return self.wrapped.model

    def moved(self, model: Path) -> "WorkWithParts":
        """Return the same work with its files in another directory."""
        return WorkWithParts(self.wrapped.moved(model), self.parts)

    def run(self, task: Task) -> Result:
        """Do a task."""
        with registered(self.parts):
            return self.wrapped.run(task)

    def lost(self, task: Task, reason: str) -> Result:
        """Return the result of a task whose process was lost."""
        return self.wrapped.lost(task, reason)


def check_picklable(parts: Parts) -> None:
    """Refuse parts that cannot be sent to other processes.

    Raises
    ------
    InputError : a part cannot be pickled
    """
    for given in parts:
        try:
            pickle.dumps(given)
        except Exception as error:  # noqa: BLE001 - a user's part may raise anything
            what = f"{type(error).__name__}: {error}".splitlines()[0]
            raise InputError(
                f"{given.key}: '{given.name}' cannot be sent to other processes ({what});"
                " define it at the top of a module"
            ) from None


def named(given: Mapping[str, Any]) -> tuple[dict[str, Any], Parts]:
    """Return a table with names in place of objects, and the named parts.

    An existing steering law also sets the keys of its fields: ``law=MyLaw(gain=2.0)`` sets ``gain``
    as well. AIS reports that have been read also set file and vessel: ``track=read_ais("ais.csv",
    mmsi=219999001)``.

    Parameters
    ----------
    given : a table of a scenario, or dotted keys

    Raises
    ------
    InputError : a key does not take an object, an object is not a part of its key, or two objects
        have the same name
    """
    namer = _Namer()
    table = namer.table(given, "")
    return table, tuple(namer.found.values())


class _Namer:
    """Replaces the objects in a table by names, and collects them."""

    def __init__(self) -> None:
        self.found: dict[tuple[str, str], GivenPart] = {}

    def table(self, given: Mapping[str, Any], key: str) -> dict[str, Any]:
        made: dict[str, Any] = {}
        for name, value in given.items():
            below = _key(key, name, given)
            if below in _LAWS and is_dataclass(value) and not isinstance(value, type):
                made[name] = self.part(below, type(value))
                section = name.rpartition(".")[0]
                keys = {
                    of.name: f"{section}.{of.name}" if section else of.name
                    for of in fields(value)
                    if of.init
                }
                made |= {
                    of_law: self.value(of_law, getattr(value, of)) for of, of_law in keys.items()
                }
            elif below == "vessel.track" and isinstance(value, AisReports):
                made[name] = str(value.path)
                made[f"{name.removesuffix('track')}mmsi"] = value.mmsi
            else:
                made[name] = self.value(below, value)
        return made

    def value(self, key: str, value: Any) -> Any:
        if isinstance(value, Mapping):
            return self.table(value, key)
        if isinstance(value, list | tuple):
            return [self.value(key, item) for item in value]
        if isinstance(value, Path):
            return str(value)
        if isinstance(value, PLAIN) and type(value) in PLAIN:
            return value
        # NumPy's numbers and arrays, times, and other types with a plain form.
        if hasattr(value, "tolist"):
            return value.tolist()
        return value if value is None or hasattr(value, "isoformat") else self.part(key, value)

    def part(self, key: str, part: Any) -> str:
        """Return the name of an object that is given for a key, and collect the object."""
        from aircraft.fleet.find import stock_names

        key = key.removeprefix("sweep.")
        registry = _registry(key)
        if known := registry.name_of(part):
            return known
        made = not isinstance(part, type) and not hasattr(part, "__code__")
        if key == "aircraft":
            name = str(getattr(part, "name", type(part).__name__))
        elif not made:
            name = part.__name__
        elif key in _COPIED:
            name = type(part).__name__
        elif key in _LAWS and not is_dataclass(part):
            raise InputError(
                f"{key} is an object of class {type(part).__name__}, which is not a dataclass;"
                " write @dataclass(frozen=True) before"
                " the class: its fields, each with a default, are keys of [guidance]"
            )
        else:
            raise InputError(
                f"{key} is an object of class {type(part).__name__}; give the class itself,"
                " from which each flight creates its own object"
            )
        if key != "aircraft" and not name.isidentifier():
            raise InputError(f"{key} is {name}, which has no name; define it by class or def")
        try:
            registry.checked(name, part)
        except PluginError as error:
            raise InputError(f"{key}: {error}") from None
        if key == "aircraft" and name in stock_names():
            raise InputError(
                f"aircraft is an object called '{name}', the name of one of JSBSim's own;"
                " rename yours"
            )
        given = GivenPart(key, name, Copies(part) if made and key in _COPIED else part)
        if self.found.setdefault((registry.kind, name), given).part != given.part:
            raise InputError(f"{key}: two objects are called '{name}'; give each a name of its own")
        return name


def _key(key: str, name: str, beside: Mapping[str, Any]) -> str:
    """Return the dotted key of an entry; choices of a random variable belong to its key."""
    if name == "choice" and "key" in beside:
        return str(beside["key"])
    within = "" if key.rpartition(".")[2] in _TABLES_OF_KEYS or not key else f"{key}."
    return f"{within}{name}"


def _registry(key: str) -> Registry[Any]:
    """Return the registry of a key's parts.

    Raises
    ------
    InputError : the key takes no part
    """
    from aircraft.fleet import AIRCRAFT
    from gnc.laws import STEERING_LAWS
    from scenarios.search.method import SEARCH_METHODS
    from scenarios.studies.base import STUDIES
    from scenarios.studies.checks import PART_REGISTRIES

    registries: dict[str, Registry[Any]] = {
        **PART_REGISTRIES,
        "aircraft": AIRCRAFT,
        "search.methods": SEARCH_METHODS,
        "study": STUDIES,
        **dict.fromkeys(_LAWS, STEERING_LAWS),
    }
    if key not in registries:
        raise InputError(
            f"{key} is an object; it takes a number, a word or a list: objects are for"
            f" {', '.join(registries)}"
        )
    return registries[key]
