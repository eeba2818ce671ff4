"""Which form of a module is run where `make fast` has compiled it: the compiled one, until a source is edited."""

import os
import sys
from collections.abc import Sequence
from importlib.machinery import EXTENSION_SUFFIXES, SOURCE_SUFFIXES, FileFinder, ModuleSpec, SourceFileLoader
from pathlib import Path
from types import ModuleType

SOURCES = "PLUME_FLIGHT_SOURCES"
"""Environment variable; whatever it is set to, the sources are run."""

_ROOM = Path(__file__).parent


class _SourceFinder:
    """Finds the modules of this package as sources alone, as Python does where nothing is compiled."""

    def find_spec(self, name: str, path: Sequence[str] | None, _target: ModuleType | None = None) -> ModuleSpec | None:
        if path is None or not name.startswith(f"{_ROOM.name}."):
            return None
        found = (FileFinder(folder, (SourceFileLoader, SOURCE_SUFFIXES)).find_spec(name) for folder in path)
        return next((spec for spec in found if spec), None)


def compiled_modules() -> dict[Path, Path]:
    """Return the compiled form of each module that is compiled for this Python, by its source."""
    suffix = EXTENSION_SUFFIXES[0]
    forms = {form.with_name(form.name.removesuffix(suffix) + ".py"): form for form in _ROOM.rglob(f"*{suffix}")}
    return {source: form for source, form in forms.items() if source.is_file()}


def runs_compiled() -> bool:
    """Return whether compiled modules are run: there are some, each is newer than its source, and sources are not asked for.

    Compiled modules call each other without a look at their sources: so all of them are run, or none.
    """
    modules = compiled_modules()
    return bool(modules) and not os.environ.get(SOURCES) and all(newer(form, source) for source, form in modules.items())


def newer(form: Path, source: Path) -> bool:
    """Return whether a file is not older than another one."""
    return form.stat().st_mtime >= source.stat().st_mtime


def choose() -> None:
    """Have the sources be imported from now on, unless compiled modules are to be run."""
    if not runs_compiled():
        sys.meta_path.insert(0, _SourceFinder())
