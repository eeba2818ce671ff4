"""Extension points: find parts by name in the project, in installed packages or in files."""

import functools
import hashlib
import importlib
import importlib.metadata
import importlib.util
import pkgutil
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, Generic, TypeVar

from common.errors import PluginError
from common.plugins import call_plugin
from common.text import did_you_mean

Part = TypeVar("Part")

ENTRY_POINTS = "plume_flight_study"
"""Prefix of groups of entry points, as in ``plume_flight_study.steering_law``."""


class Registry(Generic[Part]):
    """The parts of one kind, such as steering laws.

    A module of ``folder`` registers a part under a name, or an installed package announces a part
    by an entry point in the group ``plume_flight_study.KIND``. A part can also be named by its
    file, as in ``mylaw.py:MyLaw``.

    Parameters
    ----------
    kind : kind of the parts, as in "steering_law"
    folder : package whose modules register the project's parts at import, or a single module
    protocol : module of the Protocol, for messages; by default ``folder``
    methods : methods of the Protocol that a part must have, unless it is a function that creates
        one; "this|that" if one of two is enough
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
        """The kind in words."""
        return self.kind.replace("_", " ")

    def register(self, name: str) -> Callable[[Part], Part]:
        """Return a decorator that registers a part under a name."""

        def registered(part: Part) -> Part:
            self._parts[name] = part
            return part

        return registered

    @contextmanager
    def temporarily_registered(self, name: str, part: Part) -> Iterator[None]:
        """Register a part inside the context only.

        Raises
        ------
        PluginError : another part has this name
        """
        if self._parts.get(name) is part:
            yield
            return
        if name in self.names():
            raise PluginError(
                f"{self.words} '{name}' exists already and is another object; rename yours"
            )
        self._parts[name] = part
        try:
            yield
        finally:
            del self._parts[name]

    def name_of(self, part: object) -> str | None:
        """Return the name of a part, or None for an unregistered part."""
        return next((name for name, known in self._parts.items() if known is part), None)

    def names(self) -> list[str]:
        """Return all known names, in alphabetical order."""
        return sorted({*self._known(), *announced(self.kind)})

    def installed_names(self) -> list[str]:
        """Return the names of the project's and the installed packages' parts, sorted."""
        builtin = {
            name
            for name, part in self._known().items()
            if f"{getattr(part, '__module__', '')}.".startswith(
                (f"{self._folder}.", f"{self._protocol}.")
            )
        }
        return sorted({*builtin, *announced(self.kind)})

    def __contains__(self, name: str) -> bool:
        """Return whether a name is known; installed packages are searched last, because that takes
        time.
        """
        return name in self._known() or name in announced(self.kind)

    def get(self, name: str) -> Part:
        """Return a part by its name, or by its file as ``FILE.py:NAME``.

        Raises
        ------
        PluginError : the part does not exist, does not load or lacks a method, or is an object
            instead of a class, from which each flight creates its own object
        """
        if name.endswith((".py", ".py:")):
            raise PluginError(
                f"{self.words} '{name}' names a file, and no part in it; "
                f"give {name.removesuffix(':')}:NAME"
            )
        if is_file_part(name):
            return self._class(name, part_in_file(name))
        if (
            name not in self._parts
            and name.isidentifier()
            and any(of.name == name for of in self._modules())
        ):
            # Try the module of that name first: importing all modules may take long.
            importlib.import_module(f"{self._folder}.{name}")
        if name in self._parts or name in self._known():
            return self._parts[name]
        if name in announced(self.kind):
            return self._class(name, load_announced(self.kind, name))
        names = self.names()
        raise PluginError(
            f"unknown {self.words} '{name}'{did_you_mean(name, names) or ';'} "
            f"known are {', '.join(names)}, or FILE.py:NAME"
        )

    def _class(self, name: str, part: Any) -> Part:
        if self._methods and not callable(part):
            raise PluginError(
                f"{self.words} '{name}' is an object of class {type(part).__name__}; "
                "give the class itself"
            )
        return self.checked(name, part)

    def _known(self) -> dict[str, Part]:
        if not self._complete:
            for module in self._modules():
                importlib.import_module(f"{self._folder}.{module.name}")
            # Set last, so that a module that does not load fails at every call.
            self._complete = True
        return self._parts

    def _modules(self) -> Iterable[pkgutil.ModuleInfo]:
        """Return the modules of ``folder``; a single module has none."""
        package = importlib.import_module(self._folder)
        return pkgutil.iter_modules(getattr(package, "__path__", ()))

    def checked(self, name: str, part: Any) -> Part:
        """Check that a part has every method of its Protocol; return the part.

        Raises
        ------
        PluginError : a method is missing
        """
        lacking = [
            method
            for method in self._methods
            if not any(callable(getattr(part, each, None)) for each in method.split("|"))
        ]
        if lacking and not isinstance(part, FunctionType):
            raise PluginError(
                f"{self.words} '{name}' has no method {lacking[0].replace('|', '() or ')}(); "
                f"see the Protocol in {self._protocol}"
            )
        found: Part = part
        return found


def announced(kind: str) -> dict[str, importlib.metadata.EntryPoint]:
    """Return the installed packages' entry points for parts of a kind, by name."""
    return {
        point.name: point
        for point in _points(f"{ENTRY_POINTS}.{kind}", importlib.metadata.entry_points, _places())
    }


def load_announced(kind: str, name: str) -> Any:
    """Return the part that an installed package announces.

    Raises
    ------
    PluginError : the part does not load
    """
    point = announced(kind)[name]
    words = kind.replace("_", " ")
    return call_plugin(f"{words} '{name}' of package {point.value}", point.load)


def announced_folders(kind: str) -> dict[str, Path]:
    """Return the folders of packages that entry points of a kind name, without importing them."""
    found = {}
    for name, point in announced(kind).items():
        spec = importlib.util.find_spec(point.module)
        if spec is not None and spec.submodule_search_locations:
            found[name] = Path(next(iter(spec.submodule_search_locations)))
    return found


@functools.lru_cache(maxsize=64)
def _points(
    group: str, find: Callable[..., importlib.metadata.EntryPoints], _: tuple[tuple[str, int], ...]
) -> importlib.metadata.EntryPoints:
    """Return the entry points of a group, cached because every installed package is searched.

    The last argument is ``_places()``, so that installing or removing a package updates the result.
    """
    return find(group=group)


def _places() -> tuple[tuple[str, int], ...]:
    """Return the folders of packages with their times of change [ns]; 0 if unknown."""
    return tuple((place, _changed(place)) for place in sys.path)


def _changed(place: str) -> int:
    try:
        return Path(place).stat().st_mtime_ns
    except (OSError, ValueError):
        return 0


def is_file_part(name: str) -> bool:
    """Return whether a name has the form ``FILE.py:NAME``."""
    return ".py:" in name


def file_of(name: str) -> Path:
    """Return the file in ``FILE.py:NAME``, or a data file itself."""
    return Path(name.rpartition(":")[0] if is_file_part(name) else name)


def file_hash(name: str) -> str:
    """Return the hash of the file in ``FILE.py:NAME``, or of a data file.

    Raises
    ------
    PluginError : the file cannot be read
    """
    try:
        with file_of(name).open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()[:16]
    except OSError as error:
        raise PluginError(
            f"{file_of(name)}: cannot be read: {error.strerror}; "
            "check the path, in a scenario file relative to that file"
        ) from None


def part_in_file(name: str) -> Any:
    """Return the part NAME from ``FILE.py:NAME``.

    Raises
    ------
    PluginError : the file cannot be read or does not load, or the name is missing in it
    """
    path, _, attribute = name.rpartition(":")
    module = _module_in(Path(path), file_hash(name))
    if not hasattr(module, attribute):
        raise PluginError(f"{path} has no '{attribute}'{did_you_mean(attribute, vars(module))}")
    return getattr(module, attribute)


@functools.lru_cache(maxsize=64)
def _module_in(path: Path, digest: str) -> Any:
    """Return the module in a file; it is loaded again only if its hash changes."""
    name = f"plume_flight_study_{path.stem}_{digest}"

    def load() -> ModuleType:
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        # Dataclasses look up their module in sys.modules.
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module

    try:
        return call_plugin(str(path), load)
    except PluginError:
        sys.modules.pop(name, None)
        raise
