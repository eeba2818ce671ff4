"""Designs and their cache; its key is a hash of everything that a design depends on.

A flight with a cached design does not import python-control.

A design is stored as JSON. Numbers are restored to the last bit, and stored text is never executed.
A dataclass is written as an object of its fields and read back by their declared types; anything
else is rejected.
"""

import contextlib
import dataclasses
import functools
import hashlib
import importlib.metadata
import json
import os
import platform
import tempfile
import types
import typing
from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np

import aircraft
import common
import innerloop
from aircraft.model import model_hash
from aircraft.spec import AircraftError, AircraftSpec
from common.files import files_hash, json_text, write_whole
from innerloop.jsbsim.system import write_root
from innerloop.margins import Check
from innerloop.schedule import LoopBandwidths, Schedule

SUFFIX = ".design.json"
"""Suffix of files with cached designs."""

Record = dict[str, Any]
"""The record of a design for its report, as plain data."""

Kind = TypeVar("Kind")

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot")

_JSON_TYPES = (float, str, bool, int)


class DesignError(AircraftError):
    """No design of an aircraft has the required margins."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """An autopilot and its margins.

    Attributes
    ----------
    schedule : the autopilot's tables
    bandwidths : bandwidths of the loops
    checks : margins at and between the points of the grid, also with the perturbed aircraft
    """

    schedule: Schedule
    bandwidths: LoopBandwidths
    checks: tuple[Check, ...]


@dataclass(frozen=True, kw_only=True)
class Designed:
    """A design and its record."""

    design: Design
    record: Record

    @functools.cached_property
    def record_text(self) -> str:
        """The record as one line of JSON, about half a megabyte, for run directories."""
        return json_text(self.record, indent=None)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Entry:
    """An entry of the cache: a design, or the refusal and whether margins are its reason."""

    made: Designed | None = None
    refusal: str
    lacks_margins: bool = False


def designed(spec: AircraftSpec, altitude: float = 100.0) -> Designed:
    """Return the design of an aircraft at ``altitude`` [m] and its record.

    The design is taken from the cache if nothing that it depends on has changed (``design_key``).
    Refusals are cached as well.

    Raises
    ------
    AircraftError : the aircraft has no usable envelope, or no equilibrium in part of the envelope
    DesignError : no design has the required margins
    """
    key = design_key(spec, altitude)
    entry = _cached(key)
    if entry is None:
        text = as_text(_design(spec, altitude))
        _store(key, text)
        # The text is always read back, so that this run has the same design as later ones.
        entry = _entry(text)
    if entry.made is None:
        raise (DesignError if entry.lacks_margins else AircraftError)(entry.refusal)
    return _with_model_of(spec, entry.made)


def is_cached(spec: AircraftSpec, altitude: float) -> bool:
    """Return whether the cache has a design or a refusal."""
    return _cached(design_key(spec, altitude)) is not None


def design_key(spec: AircraftSpec, altitude: float) -> str:
    """Return the hash of everything that a design depends on.

    It covers the aircraft's spec and files (not their place on disk), the altitude [m] and
    ``program_hash``.
    """
    wherever = repr(replace(spec, root=Path(), folder=None, other_roots=()))
    return _digest(f"{wherever}{altitude!r}{model_hash(spec.files)}{program_hash()}")


@functools.cache
def program_hash() -> str:
    """Return the hash of the design program; it is computed once per process.

    It covers the source of ``aircraft``, ``common`` and ``innerloop``, and the versions of Python,
    JSBSim and the numerical packages.
    """
    versions = [f"{package} {importlib.metadata.version(package)}" for package in _PACKAGES]
    sources = [
        files_hash(Path(folder), sorted(Path(folder).rglob("*.py")))
        for package in (aircraft, common, innerloop)
        for folder in package.__path__
    ]
    return _digest("".join([platform.python_version(), *versions, *sources]))


def cache_directory() -> Path | None:
    """Return the directory of cached designs; None if the user has no home directory."""
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    if not base:
        try:
            base = str(Path.home() / ".cache")
        except RuntimeError:
            return None
    return Path(base) / "plume-flight-study"


def _design(spec: AircraftSpec, altitude: float) -> _Entry:
    # These modules import python-control, which a flight with a cached design does not need.
    from innerloop.designer import design_autopilot
    from innerloop.record import design_record

    try:
        design = design_autopilot(spec, altitude)
    except AircraftError as error:
        return _Entry(refusal=str(error), lacks_margins=isinstance(error, DesignError))
    with tempfile.TemporaryDirectory() as folder:
        record = design_record(design, write_root(design.schedule, Path(folder)))
    return _Entry(made=Designed(design=design, record=record), refusal="")


def _with_model_of(spec: AircraftSpec, found: Designed) -> Designed:
    """Return a design with the ``spec``'s paths of the model files.

    The same files may have been elsewhere on disk when the design was made.
    """
    schedule = found.design.schedule
    placed = replace(
        schedule.spec, root=spec.root, folder=spec.folder, other_roots=spec.other_roots
    )
    if placed == schedule.spec:
        return found
    schedule = replace(schedule, spec=placed)
    return replace(found, design=replace(found.design, schedule=schedule))


def _cached(key: str) -> _Entry | None:
    """Return the cached entry of a key; None if it is absent or damaged."""
    directory = cache_directory()
    if directory is None:
        return None
    try:
        # The first line is the hash of the rest, because a damaged number would not be noticed.
        content = (directory / f"{key}{SUFFIX}").read_text(encoding="utf-8")
        digest, _, text = content.partition("\n")
        return _entry(text) if digest == _digest(text) else None
    except (OSError, ValueError):
        return None


@functools.lru_cache(maxsize=4)
def _entry(text: str) -> _Entry:
    """Return the entry in a text; parsed entries are cached."""
    return from_text(text, _Entry)


def _store(key: str, text: str) -> None:
    """Cache an entry; if writing fails, the next run designs again."""
    directory = cache_directory()
    if directory is None:
        return
    with contextlib.suppress(OSError):
        directory.mkdir(parents=True, exist_ok=True)
        content = f"{_digest(text)}\n{text}"
        write_whole(
            directory / f"{key}{SUFFIX}", lambda path: path.write_text(content, encoding="utf-8")
        )


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def as_text(value: object) -> str:
    """Return a dataclass as JSON text; NaN and infinity are written as Python's json does."""
    return json.dumps(value, default=_plain, separators=(",", ":"))


def from_text(text: str, kind: type[Kind]) -> Kind:
    """Return the object of dataclass ``kind`` that ``as_text`` wrote.

    Raises
    ------
    ValueError : the text does not hold such an object
    """
    try:
        found: Kind = _value(json.loads(text), kind)
    except (LookupError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"not a {kind.__name__}: {error}") from None
    return found


def _plain(value: Any) -> Any:
    """Convert a dataclass, array or mapping to values that JSON can express."""
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if isinstance(value, np.ndarray):
        # The memory order of an array influences the rounding of matrix products.
        order: Literal["C", "F"] = (
            "F" if value.flags.f_contiguous and not value.flags.c_contiguous else "C"
        )
        return {"shape": value.shape, "order": order, "values": value.ravel(order).tolist()}
    if isinstance(value, Mapping):
        return dict(value)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, np.generic):
        return value.item()
    return str(value)


def _value(found: Any, kind: Any) -> Any:
    """Return a value of type ``kind`` from its JSON."""
    if (
        kind is Any
        or (type(found) is kind and kind in _JSON_TYPES)
        or (kind is float and type(found) is int)
    ):
        return found
    arguments = typing.get_args(kind)
    if arguments:
        return _generic_value(found, typing.get_origin(kind), arguments)
    if isinstance(kind, type) and dataclasses.is_dataclass(kind):
        hints = _hints(kind)
        return kind(**{key: _value(item, hints[key]) for key, item in found.items()})
    if kind is Path or issubclass(kind, Enum):
        return kind(found)
    raise TypeError(f"{found!r} where {kind} is declared")


def _generic_value(found: Any, origin: Any, arguments: tuple[Any, ...]) -> Any:
    """Return an array, an optional value, a tuple or a mapping from its JSON."""
    if origin is np.ndarray:
        values = np.array(found["values"], dtype=np.float64)
        return values.reshape(found["shape"], order=found["order"])
    if origin in (typing.Union, types.UnionType):
        (kind,) = (argument for argument in arguments if argument is not types.NoneType)
        return None if found is None else _value(found, kind)
    if origin is tuple:
        kinds = [arguments[0]] * len(found) if arguments[1:] == (...,) else arguments
        return tuple(_value(item, kind) for item, kind in zip(found, kinds, strict=True))
    return {key: _value(item, arguments[1]) for key, item in found.items()}


_hints = functools.cache(typing.get_type_hints)
