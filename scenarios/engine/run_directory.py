"""The run directory: writing its files, and checking a run that is resumed.

Files are written completely or not at all. A run is resumed only with the same configuration and
the same software.
"""

import functools
import importlib.metadata
import json
import os
import platform
import re
import uuid
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from common.files import files_hash, write_json, write_text, write_whole
from common.run_layout import (
    BOUNDS,
    DESIGN_RECORD,
    EXPORT,
    FILES,
    HISTORY_SUFFIX,
    JOURNAL,
    MANIFEST,
    MODEL,
    REPORT_HTML,
    REPORT_PDF,
    STATISTICS,
)
from common.text import cell
from scenarios.errors import InputError

if TYPE_CHECKING:
    # Commands that only list or refuse something do not wait for the import.
    import pandas as pd


_BEGUN = re.compile(
    rf"{re.escape(JOURNAL)}(-.*)?|\.probe-[0-9a-f]*\.part|\.{re.escape(MANIFEST)}\.\d+\.part"
)
"""Files of a run that was killed before its manifest was written."""

_PARQUET_END = b"PAR1"
"""End of a Parquet file (Apache Parquet, file format)."""

_PATH_SHOWN = 120
"""Largest number of characters of a path in a message."""

_PACKAGES = ("jsbsim", "numpy", "scipy", "control", "slycot", "pydantic", "cma")
SOURCE = ("aircraft", "common", "extensions", "gnc", "innerloop", "measurement", "scenarios")
"""Packages of the project that results depend on, which is all but ``reports``."""

_SUFFIXES = (".json", ".py", ".toml", ".xml")
"""Suffixes of source and of the data that it reads: aircraft models, presets and tables."""

_CATALOG = "catalog"
"""Folders left out of the source's hash, because a run has its scenario in its configuration."""

_KEYS_NAMED = 3
"""Largest number of differing keys in a message."""

_VALUE_SHOWN = 60
"""Largest number of characters of a value in a message."""


class RunDirectory:
    """Paths and files of one run.

    Parameters
    ----------
    path : the directory, which ``open`` creates

    Attributes
    ----------
    missing_files : files of the finished run that are now deleted or truncated; known after
        ``open`` with ``resume``
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.manifest = path / MANIFEST
        self.journal = path / JOURNAL
        self.innerloop = path / DESIGN_RECORD
        self.bounds = path / BOUNDS
        self.statistics = path / STATISTICS
        self.model = path / MODEL
        self.missing_files: list[str] = []

    def open(
        self,
        config_hash: str,
        *,
        resume: bool,
        manifest: Callable[[], Mapping[str, Any]] | None = None,
    ) -> dict[str, Any]:
        """Open the directory; return the manifest of a resumed run, empty for a new run.

        Parameters
        ----------
        config_hash : hash of the configuration to be flown
        resume : whether to continue an existing run
        manifest : function that returns the manifest of the study to be flown, for error messages
            about differing keys

        Raises
        ------
        InputError : the directory cannot be written; to be resumed, it holds no run of this
            configuration and software; or to be new, it is not empty
        """
        try:
            # A run that was killed before its manifest was written is started again.
            if resume and (self.manifest.exists() or not self._is_begun()):
                return self._open_existing(config_hash, manifest)
            self.refuse_taken()
            self._create()
        except OSError as error:
            raise self._unwritable(error) from None
        return {}

    def plugins(self) -> dict[str, str]:
        """Return the hash of each file with parts of the run; empty without a readable manifest."""
        try:
            return dict(json.loads(self.manifest.read_text(encoding="utf-8")).get("plugins", {}))
        except (ValueError, TypeError, AttributeError, OSError, RecursionError):
            return {}

    def _is_begun(self) -> bool:
        """Return whether the directory has only the first files of a killed run."""
        names = [path.name for path in self.path.iterdir()] if self.path.is_dir() else []
        return bool(names) and all(_BEGUN.fullmatch(name) for name in names)

    def refuse_taken(self) -> None:
        """Raise an InputError if the directory has more than the first files of a killed run."""
        try:
            if self.manifest.exists():
                raise InputError(
                    f"output directory '{self.path}' holds another run; choose another --out,"
                    " or continue it with --resume"
                )
            if self.path.is_dir() and any(self.path.iterdir()) and not self._is_begun():
                raise InputError(
                    f"output directory '{self.path}' is not empty; choose another --out"
                )
        except OSError as error:
            raise self._unwritable(error) from None

    def _open_existing(
        self, config_hash: str, ours: Callable[[], Mapping[str, Any]] | None
    ) -> dict[str, Any]:
        if not self.manifest.is_file():
            raise InputError(
                f"'{self.path}' holds no run to resume; leave out --resume to start one"
            )
        try:
            manifest = dict(json.loads(self.manifest.read_text(encoding="utf-8")))
            found, theirs = manifest["config_hash"], dict(manifest.get("fingerprint", {}))
        except (ValueError, KeyError, TypeError, OSError, RecursionError):
            raise InputError(
                f"'{self.manifest}' cannot be read; start a new run in another --out"
            ) from None
        if found != config_hash:
            keys = changed_keys(manifest, ours()) if ours else ""
            raise InputError(
                f"'{self.path}' was run with another"
                f" configuration{f': {keys}' if keys else ''}; resume it with the same scenario,"
                " --seed and --set values"
            )
        self._refuse_other_software(theirs)
        self._refuse_links()
        self._create()
        listed = manifest.get(FILES)
        names = [str(name) for name in listed] if isinstance(listed, list) else []
        self.missing_files = [name for name in names if not _is_whole(self.path / name)]
        return manifest

    def _refuse_other_software(self, theirs: Mapping[str, str]) -> None:
        for name in differences(theirs)[:1]:
            before, now = theirs.get(name, "unknown"), fingerprint()[name]
            raise InputError(
                f"'{self.path}' was started with {name} {before}, now it is {now}: results"
                " would not be comparable;"
                f" resume it with the same {name}, or start a new run in another --out"
            )

    def _refuse_links(self) -> None:
        for path in self.path.iterdir():
            if path.is_symlink():
                raise InputError(
                    f"'{path}' is a link; results are written into '{self.path}' alone: replace"
                    " it by what it links to"
                )

    def remove_partial_files(self) -> None:
        """Remove partly written files of a killed program; no other program may be writing."""
        for part in self.path.rglob(".*.part"):
            part.unlink()

    def files(self) -> list[str]:
        """Return the paths of the run's files, without journal, manifest, reports and exports."""
        names = (
            path.relative_to(self.path).as_posix()
            for path in self.path.rglob("*")
            if path.is_file()
        )
        apart = (JOURNAL, MANIFEST, REPORT_HTML, REPORT_PDF, f"{EXPORT}/", ".")
        return sorted(name for name in names if not name.startswith(apart))

    def _create(self) -> None:
        self.path.mkdir(parents=True, exist_ok=True)
        probe = self.path / f".probe-{uuid.uuid4().hex}.part"
        probe.touch()
        probe.unlink()

    def _unwritable(self, error: OSError) -> InputError:
        shown = str(self.path)
        shown = shown if len(shown) <= _PATH_SHOWN else f"{shown[:_PATH_SHOWN]}..."
        return InputError(
            f"output directory '{shown}' cannot be written: {error.strerror}; choose another --out"
        )

    def _inside(self, name: str) -> Path:
        """Return the path of a file of the run; create its directory.

        Raises
        ------
        InputError : the name leads out of the run directory
        """
        path = self.path / name
        if not path.parent.resolve().is_relative_to(self.path.resolve()):
            raise InputError(
                f"file {name!r} would be written outside of '{self.path}'; do not use this run"
            )
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def write_json(self, path: Path, value: Mapping[str, Any], *, indent: int | None = 1) -> None:
        """Write a JSON file, completely or not at all; an ``indent`` of None gives one line."""
        write_json(path, value, indent=indent)

    def write_text(self, path: Path, text: str) -> None:
        """Write a text file, completely or not at all."""
        write_text(path, text)

    def write_frame(self, name: str, frame: "pd.DataFrame") -> None:
        """Write a table to a CSV or Parquet file, by its suffix, completely or not at all."""
        path = self._inside(name)
        if name.endswith(HISTORY_SUFFIX):
            write_whole(path, lambda part: frame.to_parquet(part, index=False))
            return
        texts = frame.select_dtypes(exclude="number").columns
        shown = frame.assign(**{column: frame[column].map(cell) for column in texts})
        write_whole(path, lambda part: shown.to_csv(part, index=False))

    def write_bytes(self, name: str, content: bytes) -> None:
        """Write a file of the run, completely or not at all."""
        write_whole(self._inside(name), lambda part: part.write_bytes(content))


def _is_whole(path: Path) -> bool:
    """Return whether a file exists and, if it is a Parquet file, is not truncated."""
    try:
        if path.suffix == HISTORY_SUFFIX:
            with path.open("rb") as file:
                file.seek(-len(_PARQUET_END), os.SEEK_END)
                return file.read() == _PARQUET_END
        if path.suffix == ".json":
            json.loads(path.read_text(encoding="utf-8"))
        return path.is_file()
    except (OSError, ValueError, RecursionError):
        return False


@functools.cache
def fingerprint() -> dict[str, str]:
    """Return versions of Python and of packages that results depend on, and the source's hash."""
    versions = {package: importlib.metadata.version(package) for package in _PACKAGES}
    return {
        "python": platform.python_version(),
        **versions,
        "source": source_hash(Path(__file__).parents[2]),
    }


def source_hash(project: Path) -> str:
    """Return a hash of the paths and contents of a project's files that results depend on."""
    found = (
        path
        for package in SOURCE
        for path in sorted((project / package).rglob("*.*"))
        if path.suffix in _SUFFIXES
    )
    counted = (path for path in found if _CATALOG not in path.relative_to(project).parts)
    return files_hash(project, counted)[:16]


def differences(theirs: Mapping[str, str]) -> list[str]:
    """Return the names of entries in which a fingerprint differs from this program's."""
    return [name for name, mine in fingerprint().items() if theirs.get(name) != mine]


def changed_keys(before: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return the first differing keys with both values, in words; empty if none is found.

    Parameters
    ----------
    before, now : manifest of the run, and manifest of the study that continues it
    """
    if not isinstance(before.get("config"), dict):
        return ""
    then, today = dict(_values(before)), dict(_values(json.loads(json.dumps(now))))
    keys = [key for key in dict.fromkeys([*today, *then]) if then.get(key) != today.get(key)]
    named = [
        f"{key} was {_shown(then.get(key))}, and is {_shown(today.get(key))} now"
        for key in keys[:_KEYS_NAMED]
    ]
    more = [f"and {len(keys) - _KEYS_NAMED} more"] if len(keys) > _KEYS_NAMED else []
    return "; ".join([*named, *more])


def _values(manifest: Mapping[str, Any]) -> Iterator[tuple[str, object]]:
    yield "the scenario's name", manifest.get("name")
    yield from _flat(config := manifest.get("config"), "")
    if isinstance(config, dict) and config.get("study") == "trials":
        # The list of trials in the configuration does not contain their keys.
        yield from _flat(manifest.get("trials"), "")
    yield from _flat(manifest.get("plugins"), "the hash of ")


def _flat(values: object, before: str) -> Iterator[tuple[str, object]]:
    for key, value in values.items() if isinstance(values, dict) else ():
        if isinstance(value, dict) and value:
            yield from _flat(value, f"{before}{key}.")
        else:
            yield f"{before}{key}", value


def _shown(value: object) -> str:
    if value is None:
        return "not set"
    text = json.dumps(value, ensure_ascii=False)
    return text if len(text) <= _VALUE_SHOWN else f"{text[:_VALUE_SHOWN]}..."
