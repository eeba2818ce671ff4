"""Keys that installed packages add to scenario files, loaded when the class of scenarios is made.

This module is separate from ``study_keys``, which the packages import: a package may be imported
before this project, as in a process that receives the work of a study.
"""

from collections.abc import Iterator
from typing import Any

from common.errors import PluginError
from common.registry import announced, load_announced
from scenarios.scenario.study_keys import StudyFile, StudyKeys

KEYS, FILES = "keys", "scenario"
"""Groups of entry points, ``plume_flight_study.keys`` and ``plume_flight_study.scenario``."""


def _loaded(kind: str) -> Iterator[tuple[str, Any]]:
    """Yield the entry points of installed packages in a group, by the names of studies."""
    for name in sorted(announced(kind)):
        try:
            yield name, load_announced(kind, name)
        except PluginError:
            # Other studies are flown without it; `check_study` gives the reason if a scenario names
            # this one.
            continue


def check_study(study: str) -> None:
    """Load what a package announces for a study.

    Raises
    ------
    PluginError : it does not load
    """
    for kind in (KEYS, FILES):
        if study in announced(kind):
            load_announced(kind, study)


ADDED: tuple[type[StudyKeys], ...] = tuple(keys for _, keys in _loaded(KEYS))
"""The keys that installed packages add."""


def study_files() -> dict[str, type[StudyFile]]:
    """Return the schemas of scenario files that are not of flights, by the studies of installed
    packages: those announced in the group ``plume_flight_study.scenario``.
    """
    return dict(_loaded(FILES))
