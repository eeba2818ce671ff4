"""The software that results depend on: versions of packages, and the project's own source with its
data.
"""

import functools
import importlib.metadata
import platform
from collections.abc import Mapping
from pathlib import Path

from common.files import files_hash

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot", "pydantic", "cma")
SOURCE = ("aircraft", "common", "extensions", "gnc", "innerloop", "measurement", "scenarios")
"""Packages of the project that results depend on: all that flies or measures; ``reports`` only
shows it.
"""

_SUFFIXES = (".json", ".py", ".toml", ".xml")
"""Source, and the data that it reads: aircraft models, presets and tables."""

_CATALOG = "catalog"
"""Folders that are left out: a run is compared by what its scenario contains, wherever that was read from."""


@functools.cache
def fingerprint() -> dict[str, str]:
    """Return the versions of Python and of the packages that results depend on, and a hash of the
    project's source.
    """
    versions = {package: importlib.metadata.version(package) for package in _PACKAGES}
    return {
        "python": platform.python_version(),
        **versions,
        "source": source_hash(Path(__file__).parents[2]),
    }


def source_hash(project: Path) -> str:
    """Return a hash of the files of a project that results depend on, by their paths in it and
    their contents.
    """
    found = (
        path
        for package in SOURCE
        for path in sorted((project / package).rglob("*.*"))
        if path.suffix in _SUFFIXES
    )
    counted = (path for path in found if _CATALOG not in path.relative_to(project).parts)
    return files_hash(project, counted)[:16]


def differences(theirs: Mapping[str, str]) -> list[str]:
    """Return the names of the entries in which another fingerprint differs from that of this
    program.
    """
    return [name for name, mine in fingerprint().items() if theirs.get(name) != mine]
