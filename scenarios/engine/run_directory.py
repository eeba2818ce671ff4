"""The run directory: its files, each written completely or not at all."""

import json
import os
import re
import uuid
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from common.files import write_json, write_text, write_whole
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
from scenarios.engine.configuration import changed_keys
from scenarios.engine.fingerprint import differences, fingerprint
from scenarios.errors import InputError

if TYPE_CHECKING:
    # Commands that only list or refuse something need not wait for it.
    import pandas as pd


_BEGUN = re.compile(
    rf"{re.escape(JOURNAL)}(-.*)?|\.probe-[0-9a-f]*\.part|\.{re.escape(MANIFEST)}\.\d+\.part"
)
"""Files of a run that was killed before it had a manifest."""

_PARQUET_END = b"PAR1"
"""How a Parquet file ends (Apache Parquet, file format)."""

_SHOWN = 120
"""Letters of a path that a message shows at most: what is refused may be too long."""


class RunDirectory:
    """Paths and files of one run.

    Parameters
    ----------
    path : the directory; created by ``open``

    Attributes
    ----------
    gone : files that the run had when it ended, and that are deleted or cut since; known once it
        has been opened to be resumed
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.manifest = path / MANIFEST
        self.journal = path / JOURNAL
        self.innerloop = path / DESIGN_RECORD
        self.bounds = path / BOUNDS
        self.statistics = path / STATISTICS
        self.model = path / MODEL
        self.gone: list[str] = []

    def open(
        self,
        config_hash: str,
        *,
        resume: bool,
        manifest: Callable[[], Mapping[str, Any]] | None = None,
    ) -> dict[str, Any]:
        """Open the directory and return the manifest of the run that is resumed, empty for a new
        one.

        Parameters
        ----------
        config_hash : of the configuration that is to be flown
        resume : continue the run that is there
        manifest : returns that of what is to be flown, by which an error names the keys that differ

        Raises
        ------
        InputError : the directory cannot be written; it is to be resumed and holds no run of this
            configuration and software, or it is to be new and holds something
        """
        try:
            # A run that was killed before it had a manifest has nothing to continue, and is begun
            # anew.
            if resume and (self.manifest.exists() or not self._is_begun()):
                return self._open_existing(config_hash, manifest)
            self.refuse_taken()
            self._create()
        except OSError as error:
            raise self._unwritable(error) from None
        return {}

    def plugins(self) -> dict[str, str]:
        """Return the hash of each file that the run took parts from; none if it has no manifest
        that can be read.
        """
        try:
            return dict(json.loads(self.manifest.read_text(encoding="utf-8")).get("plugins", {}))
        except (ValueError, TypeError, AttributeError, OSError, RecursionError):
            return {}

    def _is_begun(self) -> bool:
        """Return whether it has nothing but the first files of a run."""
        names = [path.name for path in self.path.iterdir()] if self.path.is_dir() else []
        return bool(names) and all(_BEGUN.fullmatch(name) for name in names)

    def refuse_taken(self) -> None:
        """Raise an InputError if the directory holds anything but the first files of a run that was
        killed.
        """
        try:
            if self.manifest.exists():
                raise InputError(
                    f"output directory '{self.path}' holds another run; choose another --out, or continue it with --resume"
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
                f"'{self.path}' was run with another configuration{f': {keys}' if keys else ''}; resume it with the same scenario,"
                " --seed and --set values"
            )
        if differing := differences(theirs):
            name = differing[0]
            before, now = theirs.get(name, "unknown"), fingerprint()[name]
            raise InputError(
                f"'{self.path}' was started with {name} {before}, now it is {now}: results would not be comparable;"
                f" resume it with the same {name}, or start a new run in another --out"
            )
        for path in self.path.iterdir():
            if path.is_symlink():
                raise InputError(
                    f"'{path}' is a link; results are written into '{self.path}' alone: replace it by what it links to"
                )
        self._create()
        listed = manifest.get(FILES)
        names = [str(name) for name in listed] if isinstance(listed, list) else []
        self.gone = [name for name in names if not _is_whole(self.path / name)]
        return manifest

    def sweep(self) -> None:
        """Remove partly written files of a program that was killed. No other program may be
        writing.
        """
        for part in self.path.rglob(".*.part"):
            part.unlink()

    def files(self) -> list[str]:
        """Return the files of the run by their paths in the directory, without journal, manifest,
        reports and exports.
        """
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
        shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."
        return InputError(
            f"output directory '{shown}' cannot be written: {error.strerror}; choose another --out"
        )

    def _inside(self, name: str) -> Path:
        """Return the path of a file of the run, after making the directory that it is in.

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
        """Write a JSON file, completely or not at all; with an ``indent`` of None on one line."""
        write_json(path, value, indent=indent)

    def write_text(self, path: Path, text: str) -> None:
        """Write a text file, completely or not at all."""
        write_text(path, text)

    def write_frame(self, name: str, frame: "pd.DataFrame") -> None:
        """Write a table to ``name``, a CSV or Parquet file by its suffix, completely or not at all."""
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
    """Return whether there is a file that, as far as its kind shows it, is not cut."""
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
