"""A cache of designs, by the hash of everything they depend on, so that a stale one is never used."""

import contextlib
import functools
import hashlib
import importlib.metadata
import os
import platform
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import aircraft
import common
import innerloop
from aircraft.model import model_hash
from aircraft.spec import AircraftError, AircraftSpec
from common.files import files_hash, write_whole
from innerloop.designs.designed import Designed, DesignError
from innerloop.designs.stored import as_text, from_text
from innerloop.jsbsim.root import write_root

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot")

SUFFIX = ".design.json"
"""How the names of cached designs end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Refused:
    """A design that failed, and why."""

    message: str
    is_margins: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class _Entry:
    """An entry of the cache: a design, or why there is none."""

    made: Designed | None = None
    refused: _Refused | None = None


def designed(spec: AircraftSpec, altitude: float = 100.0) -> Designed:
    """Return the design of an aircraft at ``altitude`` [m] and its record: from the cache if
    nothing it depends on has changed.

    It depends on the aircraft's spec and files, the altitude, the source of ``aircraft``,
    ``common`` and ``innerloop``, and on the versions of Python, JSBSim and the numerical packages.
    A failed design is cached as well.

    Raises
    ------
    AircraftError : the aircraft cannot fly the study, or one of its design conditions
    DesignError : no design has the margins
    """
    key = design_key(spec, altitude)
    found = _cached(key)
    if found is None:
        text = as_text(_design(spec, altitude))
        _store(key, text)
        # What is used is what the next run reads, whether or not it was written.
        found = _restored(text)
    if found.refused is not None or found.made is None:
        refused = found.refused or _Refused(
            message=f"aircraft '{spec.name}' has no design", is_margins=False
        )
        raise (DesignError if refused.is_margins else AircraftError)(refused.message)
    return _at(spec, found.made)


def is_cached(spec: AircraftSpec, altitude: float) -> bool:
    """Return whether ``designed`` has its answer in the cache, a design or a refusal; parameters
    are its own.
    """
    return _cached(design_key(spec, altitude)) is not None


def _at(spec: AircraftSpec, found: Designed) -> Designed:
    """Return a design whose model is where that of ``spec`` is: the same files may have been
    elsewhere when it was made.
    """
    schedule = found.design.schedule
    placed = schedule.spec.with_files_of(spec)
    if placed == schedule.spec:
        return found
    schedule = replace(schedule, spec=placed)
    return replace(found, design=replace(found.design, schedule=schedule))


def design_key(spec: AircraftSpec, altitude: float) -> str:
    """Return the hash of everything a design depends on."""
    digest = hashlib.sha256()
    for text in (
        repr(replace(spec, root=Path(), folder=None, other_roots=())),
        repr(altitude),
        model_hash(spec.files),
        _program_hash(),
    ):
        digest.update(text.encode())
    return digest.hexdigest()


@functools.cache
def _program_hash() -> str:
    """Return the hash of the program that designs, which stays what it is while a process runs:
    versions and source.
    """
    digest = hashlib.sha256()
    for text in (
        platform.python_version(),
        *(f"{package} {importlib.metadata.version(package)}" for package in _PACKAGES),
    ):
        digest.update(text.encode())
    for package in (aircraft, common, innerloop):
        for folder in package.__path__:
            digest.update(files_hash(Path(folder), sorted(Path(folder).rglob("*.py"))).encode())
    return digest.hexdigest()


def _design(spec: AircraftSpec, altitude: float) -> _Entry:
    # They need python-control, which a flight with a cached design does without.
    from innerloop.designs.designer import design_autopilot
    from innerloop.designs.record import design_record

    try:
        design = design_autopilot(spec, altitude)
    except AircraftError as error:
        return _Entry(
            refused=_Refused(message=str(error), is_margins=isinstance(error, DesignError))
        )
    with tempfile.TemporaryDirectory() as folder:
        return _Entry(
            made=Designed(
                design=design,
                record=design_record(design, write_root(design.schedule, Path(folder))),
            )
        )


def cache_directory() -> Path | None:
    """Return the cache of designs: ``plume-flight-study`` in the user's cache directory; None for a
    user without a home.
    """
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    if not base:
        try:
            base = str(Path.home() / ".cache")
        except RuntimeError:
            return None
    return Path(base) / "plume-flight-study"


def _cached(key: str) -> _Entry | None:
    """Return the cached entry of a key; None if it is absent or damaged."""
    directory = cache_directory()
    if directory is None:
        return None
    try:
        # In a damaged file the numbers might be those of another autopilot: the first line is the
        # hash of the others.
        digest, _, text = (directory / f"{key}{SUFFIX}").read_text(encoding="utf-8").partition("\n")
        return _restored(text) if digest == _digest(text) else None
    except (OSError, ValueError):
        return None


@functools.lru_cache(maxsize=4)
def _restored(text: str) -> _Entry:
    """Return the entry that a text holds: restored once, however many studies of a process fly with
    it.
    """
    return from_text(text, _Entry)


def _store(key: str, text: str) -> None:
    """Cache an entry; if it cannot be written, the design is made again the next time."""
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
