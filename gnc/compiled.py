"""Modules that `make fast` has compiled: they are run in place of their sources until one of these
is edited.
"""

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
"""Environment variable; whatever it is set to, the sources are run."""

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "build" / f"compiled-{sys.implementation.cache_tag}"
"""What was compiled for this Python: apart from the sources, so that no other commit finds it."""

INDEX = FOLDER / "index.json"
"""``sources``, their hash; ``modules``, names of modules and of files. Written last: without it
there is nothing.
"""

_PACKAGES = ("aircraft", "common", "gnc", "innerloop", "scenarios")
"""Whose sources count: those of compiled modules, and what these import."""


class _Finder:
    """Finds modules in files of other names than Python looks for.

    Parameters
    ----------
    files : by the names of modules
    """

    def __init__(self, files: Mapping[str, Path]) -> None:
        self._files = files

    def find_spec(
        self, name: str, _path: Sequence[str] | None, _target: ModuleType | None = None
    ) -> ModuleSpec | None:
        file = self._files.get(name)
        return spec_from_file_location(name, file) if file else None


def sources_hash() -> str:
    """Return a hash of the sources as they are."""
    return files_hash(
        ROOT, (path for package in _PACKAGES for path in sorted((ROOT / package).rglob("*.py")))
    )


def compiled_modules() -> dict[str, Path]:
    """Return the file of each compiled module by its name: none if one is missing, the sources are
    others by now, or asked for.
    """
    if os.environ.get(SOURCES):
        return {}
    try:
        index = json.loads(INDEX.read_text(encoding="utf-8"))
        files = {name: FOLDER / file for name, file in index["modules"].items()}
    except (OSError, ValueError, LookupError, TypeError):
        # There is none, or it is damaged.
        return {}
    whole = all(file.is_file() for file in files.values()) and index["sources"] == sources_hash()
    return files if whole else {}


def choose() -> None:
    """Have compiled modules be imported from now on, if there are any that are to be run."""
    if files := compiled_modules():
        sys.meta_path.insert(0, _Finder(files))
