"""Imports the modules that `make fast` has compiled, until a source is edited."""

import json
import os
import sys
from collections.abc import Mapping, Sequence
from importlib.machinery import ModuleSpec
from importlib.util import spec_from_file_location
from pathlib import Path
from types import ModuleType

from common.files import files_hash

SOURCES = "PLUME_FLIGHT_SOURCES"
"""Environment variable: if it is not empty, the sources are run."""

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "build" / f"compiled-{sys.implementation.cache_tag}"
"""Folder of the modules that are compiled for this Python. It is apart from the sources, so that no
other commit finds it.
"""

INDEX = FOLDER / "index.json"
"""Index of the folder: ``sources`` is the hash of the sources, ``modules`` has a file for each
module. It is written last.
"""

_PACKAGES = ("aircraft", "common", "gnc", "innerloop", "scenarios")
"""Packages whose sources are hashed: of compiled modules, and of what these import."""


class _Finder:
    """Finds modules in given files, by their names."""

    def __init__(self, files: Mapping[str, Path]) -> None:
        self._files = files

    def find_spec(
        self, name: str, _path: Sequence[str] | None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        file = self._files.get(name)
        return spec_from_file_location(name, file) if file else None


def sources_hash() -> str:
    """Return a hash of the sources now."""
    return files_hash(
        ROOT, (path for package in _PACKAGES for path in sorted((ROOT / package).rglob("*.py")))
    )


def compiled_modules() -> dict[str, Path]:
    """Return the file of each compiled module by its name; empty where the sources are to be run.

    The sources are run if a file is missing, a source was edited since, or ``SOURCES`` is set.
    """
    if os.environ.get(SOURCES):
        return {}
    try:
        index = json.loads(INDEX.read_text(encoding="utf-8"))
        files = {name: FOLDER / file for name, file in index["modules"].items()}
    except (OSError, ValueError, LookupError, TypeError):
        # There is no index, or it is damaged.
        return {}
    complete = all(file.is_file() for file in files.values())
    return files if complete and index["sources"] == sources_hash() else {}


def choose() -> None:
    """Import compiled modules from now on, if there are any."""
    files = compiled_modules()
    if files:
        sys.meta_path.insert(0, _Finder(files))
