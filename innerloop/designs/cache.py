"""A cache of designs, by the hash of everything they depend on, so that a stale one is never used."""

import contextlib
import hashlib
import importlib.metadata
import io
import os
import pickle
import platform
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import control

import aircraft
import common
import innerloop
from aircraft.errors import AircraftError
from aircraft.simulation.model_copy import copy_model
from aircraft.spec import AircraftSpec
from common.files import write_whole
from innerloop.designs.designer import Design, DesignError, design_autopilot
from innerloop.designs.record import Record, design_record
from innerloop.jsbsim.root import write_root

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot")
_DIGEST = hashlib.sha256().digest_size


@dataclass(frozen=True, slots=True, kw_only=True)
class Designed:
    """A design and its record."""

    design: Design
    record: Record


@dataclass(frozen=True, slots=True, kw_only=True)
class _Refused:
    """A design that failed, and why."""

    message: str
    is_margins: bool


def designed(spec: AircraftSpec, altitude: float = 100.0) -> Designed:
    """Return the design of an aircraft at ``altitude`` [m] and its record: from the cache if nothing it depends on has
    changed.

    It depends on the aircraft's spec and files, the altitude, the source of ``aircraft``, ``common`` and ``innerloop``,
    and on the versions of Python, JSBSim and the numerical packages. A failed design is cached as well.

    Raises
    ------
    AircraftError : the aircraft cannot fly the study, or one of its design conditions
    DesignError : no design has the margins
    """
    key = design_key(spec, altitude)
    found = _cached(key)
    if found is None:
        found = _design(spec, altitude)
        _store(key, found)
    if isinstance(found, _Refused):
        raise (DesignError if found.is_margins else AircraftError)(found.message)
    return _at(spec.root, found)


def _at(root: Path, found: Designed) -> Designed:
    """Return a design whose model is in ``root``: the same files may have been elsewhere when it was made."""
    schedule = found.design.schedule
    schedule = replace(schedule, spec=replace(schedule.spec, root=root))
    return replace(found, design=replace(found.design, schedule=schedule))


def design_key(spec: AircraftSpec, altitude: float) -> str:
    """Return the hash of everything a design depends on."""
    digest = hashlib.sha256()
    for text in (
        repr(replace(spec, root=Path())),
        repr(altitude),
        platform.python_version(),
        *(f"{package} {importlib.metadata.version(package)}" for package in _PACKAGES),
    ):
        digest.update(text.encode())
    for package in (aircraft, common, innerloop):
        for folder in package.__path__:
            _add_files(digest, Path(folder), "*.py")
    with tempfile.TemporaryDirectory() as copy:
        copy_model(spec.root, spec.model, Path(copy))
        _add_files(digest, Path(copy), "*.xml")
    return digest.hexdigest()


def _add_files(digest: Any, folder: Path, pattern: str) -> None:
    for path in sorted(folder.rglob(pattern)):
        digest.update(str(path.relative_to(folder)).encode())
        digest.update(path.read_bytes())


def _design(spec: AircraftSpec, altitude: float) -> Designed | _Refused:
    try:
        design = design_autopilot(spec, altitude)
    except AircraftError as error:
        return _Refused(message=str(error), is_margins=isinstance(error, DesignError))
    with tempfile.TemporaryDirectory() as folder:
        return Designed(design=design, record=design_record(design, write_root(design.schedule, Path(folder))))


def cache_directory() -> Path:
    """Return the cache of designs: ``plume-flight-study`` in the user's cache directory."""
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA") or Path.home() / ".cache"
    return Path(base) / "plume-flight-study"


def _cached(key: str) -> Designed | _Refused | None:
    """Return the cached design of a key; None if it is absent or cannot be read."""
    try:
        content = (cache_directory() / f"{key}.design").read_bytes()
        # A damaged file might still unpickle, as another autopilot.
        if content[:_DIGEST] != hashlib.sha256(content[_DIGEST:]).digest():
            return None
        found = pickle.loads(content[_DIGEST:])
    except (OSError, pickle.UnpicklingError, EOFError, AttributeError, ImportError, TypeError, ValueError, IndexError):
        return None
    return found if isinstance(found, Designed | _Refused) else None


def _store(key: str, found: Designed | _Refused) -> None:
    """Cache a design; if it cannot be written, it is made again the next time."""
    buffer = io.BytesIO()
    _Pickler(buffer).dump(found)
    content = hashlib.sha256(buffer.getvalue()).digest() + buffer.getvalue()
    with contextlib.suppress(OSError):
        cache_directory().mkdir(parents=True, exist_ok=True)
        write_whole(cache_directory() / f"{key}.design", lambda path: path.write_bytes(content))


class _Pickler(pickle.Pickler):
    """Pickles linear systems as their matrices: python-control's objects hold functions, which do not pickle."""

    def reducer_override(self, obj: object) -> tuple[Callable[..., object], tuple[object, ...]]:
        if isinstance(obj, control.StateSpace):
            labels = (list(obj.state_labels), list(obj.input_labels), list(obj.output_labels))
            return _state_space, (obj.A, obj.B, obj.C, obj.D, *labels)
        return NotImplemented


def _state_space(a: Any, b: Any, c: Any, d: Any, states: list[str], inputs: list[str], outputs: list[str]) -> control.StateSpace:
    return control.ss(a, b, c, d, states=states, inputs=inputs, outputs=outputs)
