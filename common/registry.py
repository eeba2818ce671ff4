"""Extension points: named parts of one kind, from the project, from installed packages, or from a
Python file.
"""

import functools
import hashlib
import importlib
import importlib.metadata
import importlib.util
import pkgutil
import sys
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType
from typing import Any, Generic, TypeVar

from common.spelling import did_you_mean

Part = TypeVar("Part")

ENTRY_POINTS = "plume_flight_study"
"""Packages announce parts in groups of this name and the registry's:
``plume_flight_study.steering_law``.
"""


class PluginError(ValueError):
    """A part that is unknown, or does not load, or is not what it should be. The message is one
    line.
    """


class Registry(Generic[Part]):
    """The parts of one kind.

    A part is known by its name where a module of ``folder`` registers it, or an installed package
    has an entry point of that name in the group ``plume_flight_study.KIND``. It may also be named
    by its file, as in ``mylaw.py:MyLaw``.

    Parameters
    ----------
    kind : of the parts, as in "steering_law"
    folder : package whose modules register the project's own parts when they are imported
    protocol : module of the Protocol, which may register parts, too; ``folder`` if it is not given
    methods : that every part has to have, unless it is a function that makes one: those of its
        Protocol; of some, "this|that"
    """

    def __init__(
        self, kind: str, *, folder: str, protocol: str = "", methods: Sequence[str] = ()
    ) -> None:
        self.kind = kind
        self._folder, self._methods = folder, tuple(methods)
        self._protocol = protocol or folder
        self._parts: dict[str, Part] = {}
        self._complete = False

    @property
    def words(self) -> str:
        """Return the kind in words."""
        return self.kind.replace("_", " ")

    def register(self, name: str) -> Callable[[Part], Part]:
        """Return a decorator that makes a part known by ``name``."""

        def added(part: Part) -> Part:
            self._parts[name] = part
            return part

        return added

    @contextmanager
    def lent(self, name: str, part: Part) -> Iterator[None]:
        """Know a part by ``name`` inside the context: one that is given as an object, and not by
        its name.

        Raises
        ------
        PluginError : another part is known by this name
        """
        if self._parts.get(name) is part:
            yield
            return
        if name in self.names():
            raise PluginError(
                f"{self.words} '{name}' is known already, and is not the object that was given; rename yours"
            )
        self._parts[name] = part
        try:
            yield
        finally:
            del self._parts[name]

    def name_of(self, part: object) -> str | None:
        """Return the name of a part that is registered, or None if it is not."""
        return next((name for name, known in self._parts.items() if known is part), None)

    def names(self) -> list[str]:
        """Return every known name, in alphabetical order."""
        return sorted({*self._known(), *self._entry_points()})

    def own_names(self) -> list[str]:
        """Return the names of the project's own parts, in alphabetical order: those that modules of
        ``folder`` register.
        """
        return sorted(
            name
            for name, part in self._known().items()
            if f"{getattr(part, '__module__', '')}.".startswith(
                (f"{self._folder}.", f"{self._protocol}.")
            )
        )

    def __contains__(self, name: str) -> bool:
        """Return whether a part is known by ``name``; installed packages are asked last, which
        takes longest.
        """
        return name in self._known() or name in self._entry_points()

    def get(self, name: str) -> Part:
        """Return the part of this name, or that of a file, ``FILE.py:NAME``.

        Raises
        ------
        PluginError : there is none, or it does not load, or it lacks a method, or is an object, of
            which no flight makes its own
        """
        if name.endswith(".py:"):
            raise self._without_name(name)
        if is_file_part(name):
            return self.checked(name, self._callable(name, part_in_file(name)))
        if (
            name not in self._parts
            and name.isidentifier()
            and importlib.util.find_spec(f"{self._folder}.{name}")
        ):
            # A file of its name comes first: the others may take long to import.
            importlib.import_module(f"{self._folder}.{name}")
        if name in self._parts or name in self._known():
            return self._parts[name]
        if (found := self._entry_points().get(name)) is not None:
            try:
                return self.checked(name, self._callable(name, found.load()))
            except PluginError:
                raise
            except Exception as error:
                raise PluginError(
                    f"{self.words} '{name}' of package {found.value}: {type(error).__name__}: {error}"
                ) from error
        if name.endswith(".py"):
            raise self._without_name(name)
        names = self.names()
        raise PluginError(
            f"unknown {self.words} '{name}'{did_you_mean(name, names) or ';'} known are {', '.join(names)}, or FILE.py:NAME"
        )

    def _callable(self, name: str, part: Any) -> Any:
        if self._methods and not callable(part):
            raise PluginError(
                f"{self.words} '{name}' is an object of class {type(part).__name__}; give the class itself"
            )
        return part

    def _without_name(self, name: str) -> PluginError:
        return PluginError(
            f"{self.words} '{name}' names a file, and no part in it; give {name.removesuffix(':')}:NAME"
        )

    def _known(self) -> dict[str, Part]:
        if not self._complete:
            package = importlib.import_module(self._folder)
            for module in pkgutil.iter_modules(package.__path__):
                importlib.import_module(f"{self._folder}.{module.name}")
            # Not before: a module that does not load is to be tried, and to fail, at every call.
            self._complete = True
        return self._parts

    def _entry_points(self) -> dict[str, importlib.metadata.EntryPoint]:
        return announced(self.kind)

    def checked(self, name: str, part: Any) -> Part:
        """Return a part called ``name`` that has every method of its Protocol.

        Raises
        ------
        PluginError : it lacks one
        """
        for method in () if isinstance(part, FunctionType) else self._methods:
            if not any(
                callable(getattr(part, alternative, None)) for alternative in method.split("|")
            ):
                missing = method.replace("|", "() or ")
                raise PluginError(
                    f"{self.words} '{name}' has no method {missing}(); see the Protocol in {self._protocol}"
                )
        found: Part = part
        return found


def announced(kind: str) -> dict[str, importlib.metadata.EntryPoint]:
    """Return the parts of a kind that installed packages announce as entry points, by name."""
    return {
        point.name: point
        for point in _points(f"{ENTRY_POINTS}.{kind}", importlib.metadata.entry_points, _places())
    }


@functools.lru_cache(maxsize=64)
def _points(
    group: str, find: Callable[..., importlib.metadata.EntryPoints], _: tuple[tuple[str, int], ...]
) -> importlib.metadata.EntryPoints:
    """Return the entry points of a group, for which every installed package is looked into: once,
    as long as none is installed.
    """
    return find(group=group)


def _places() -> tuple[tuple[str, int], ...]:
    """Return where packages may lie, and when something was last installed or removed there [ns]; 0
    where there is nothing.
    """
    return tuple((place, _changed(place)) for place in sys.path)


def _changed(place: str) -> int:
    try:
        return Path(place).stat().st_mtime_ns
    except (OSError, ValueError):
        return 0


def is_file_part(name: str) -> bool:
    """Return whether a part is named by its file, ``FILE.py:NAME``."""
    return ".py:" in name


def file_of(name: str) -> Path:
    """Return the file of a part that is named by it, or the file of data that ``name`` is."""
    return Path(name.rpartition(":")[0] if is_file_part(name) else name)


def file_hash(name: str) -> str:
    """Return a hash of the file of a part that is named by it, or of a file of data.

    Raises
    ------
    PluginError : the file cannot be read
    """
    try:
        with file_of(name).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()[:16]
    except OSError as error:
        raise PluginError(
            f"{file_of(name)}: cannot be read: {error.strerror}; check the path, in a scenario file relative to that file"
        ) from None


def part_in_file(name: str) -> Any:
    """Return what a Python file calls NAME, by ``FILE.py:NAME``.

    Raises
    ------
    PluginError : the file cannot be read or does not load, or has nothing of that name
    """
    path, _, attribute = name.rpartition(":")
    module = _module_in(Path(path), file_hash(name))
    if not hasattr(module, attribute):
        raise PluginError(f"{path} has no '{attribute}'{did_you_mean(attribute, vars(module))}")
    return getattr(module, attribute)


@functools.lru_cache(maxsize=64)
def _module_in(path: Path, digest: str) -> Any:
    """Return the module in a file, loaded once as long as its hash stays the same."""
    name = f"plume_flight_study_{path.stem}_{digest}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"{path}: not a Python file")
    module = importlib.util.module_from_spec(spec)
    # Dataclasses look their module up.
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    # A script that ends the process when it is read is no part, and must not end the command
    # without a word.
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise PluginError(
            f"{path} does not load: {type(error).__name__}: {error}{_where(path, error)}{_beside(path, error)}"
        ) from error
    return module


def _where(path: Path, error: BaseException) -> str:
    """Return the line of a file at which its loading failed, if that is known; an error of its
    syntax says it itself.
    """
    lines = [
        frame.lineno
        for frame in traceback.extract_tb(error.__traceback__)
        if frame.filename == str(path.absolute())
    ]
    return f" ({path.name}:{lines[-1]})" if lines else ""


def _beside(path: Path, error: BaseException) -> str:
    """Return a hint where a module is not found that is a file beside a part."""
    name = (error.name or "").partition(".")[0] if isinstance(error, ModuleNotFoundError) else ""
    there = name and ((path.parent / f"{name}.py").is_file() or (path.parent / name).is_dir())
    return (
        f"; '{name}' lies beside it, but a part is one file, or an installed package: put it into {path.name}"
        if there
        else ""
    )
