"""Extension points: parts by name, from the project, an installed package or a Python file."""

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
"""Prefix of the groups of entry points, as in ``plume_flight_study.steering_law``."""


class Registry(Generic[Part]):
    """The parts of one kind.

    A part has a name if a module of ``folder`` registers it, or if an installed package has an
    entry point of that name in the group ``plume_flight_study.KIND``. A part can also be named by
    its file, as in ``mylaw.py:MyLaw``.

    Parameters
    ----------
    kind : of the parts, as in "steering_law"
    folder : package whose modules register the project's parts when they are imported, or one
        module that does
    protocol : module of the Protocol, which may register parts as well; by default ``folder``
    methods : of the Protocol, which a part has to have unless it is a function that makes one;
        "this|that" where one of two is enough
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
                f"{self.words} '{name}' is known already, and is not the object that was given; "
                "rename yours"
            )
        self._parts[name] = part
        try:
            yield
        finally:
            del self._parts[name]

    def name_of(self, part: object) -> str | None:
        """Return the name of a part, or None if it is not registered."""
        return next((name for name, known in self._parts.items() if known is part), None)

    def names(self) -> list[str]:
        """Return all known names, in alphabetical order."""
        return sorted({*self._known(), *announced(self.kind)})

    def installed_names(self) -> list[str]:
        """Return the names that modules of ``folder`` register and those that installed packages
        announce, in alphabetical order.
        """
        builtin = {
            name
            for name, part in self._known().items()
            if f"{getattr(part, '__module__', '')}.".startswith(
                (f"{self._folder}.", f"{self._protocol}.")
            )
        }
        return sorted({*builtin, *announced(self.kind)})

    def __contains__(self, name: str) -> bool:
        """Return whether a name is known; installed packages come last, which takes longest."""
        return name in self._known() or name in announced(self.kind)

    def get(self, name: str) -> Part:
        """Return a part by its name, or by its file as ``FILE.py:NAME``.

        Raises
        ------
        PluginError : there is none, it does not load, it lacks a method, or it is an object where
            a class is needed, because each flight makes a part of its own
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
            # The module of that name first: the others may take long to import.
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
            # Only now: a module that does not load has to fail at every call.
            self._complete = True
        return self._parts

    def _modules(self) -> Iterable[pkgutil.ModuleInfo]:
        """Return the modules of ``folder``: none of a module, which registers its parts itself."""
        package = importlib.import_module(self._folder)
        return pkgutil.iter_modules(getattr(package, "__path__", ()))

    def checked(self, name: str, part: Any) -> Part:
        """Return a part, which has every method of its Protocol.

        Raises
        ------
        PluginError : it lacks one
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
    """Return the entry points of installed packages for parts of a kind, by name."""
    return {
        point.name: point
        for point in _points(f"{ENTRY_POINTS}.{kind}", importlib.metadata.entry_points, _places())
    }


def load_announced(kind: str, name: str) -> Any:
    """Return the part that an installed package announces.

    Raises
    ------
    PluginError : it does not load
    """
    point = announced(kind)[name]
    words = kind.replace("_", " ")
    return call_plugin(f"{words} '{name}' of package {point.value}", point.load)


def announced_folders(kind: str) -> dict[str, Path]:
    """Return the folders of the packages that installed packages announce for a kind, by name.

    The packages are not imported.
    """
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
    """Return the entry points of a group, which takes a look into every installed package.

    The last argument is ``_places()``: the result is kept until a package is installed or removed.
    """
    return find(group=group)


def _places() -> tuple[tuple[str, int], ...]:
    """Return the folders of packages, and when each last changed [ns], or 0."""
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
    """Return the file of a part that is named by its file, or the file of data itself."""
    return Path(name.rpartition(":")[0] if is_file_part(name) else name)


def file_hash(name: str) -> str:
    """Return a hash of the file of a part that is named by its file, or of a file of data.

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
    """Return the part NAME of a Python file, by ``FILE.py:NAME``.

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
    """Return the module in a file, loaded once while its hash stays the same."""
    name = f"plume_flight_study_{path.stem}_{digest}"

    def load() -> ModuleType:
        spec = importlib.util.spec_from_file_location(name, path)
        assert spec is not None
        assert spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        # Dataclasses look their module up.
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module

    try:
        return call_plugin(str(path), load)
    except PluginError:
        sys.modules.pop(name, None)
        raise
