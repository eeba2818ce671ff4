"""The run directory: its files, each written completely or not at all."""

import json
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from common.files import write_json, write_whole
from common.run_layout import BOUNDS, DESIGN_RECORD, HISTORY_SUFFIX, JOURNAL, MANIFEST, MODEL, STATISTICS
from scenarios.engine.fingerprint import differences, fingerprint
from scenarios.errors import InputError

if TYPE_CHECKING:
    # Commands that only list or refuse something need not wait for it.
    import pandas as pd


class RunDirectory:
    """Paths and files of one run.

    Parameters
    ----------
    path : the directory; created by ``open_new``
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.manifest = path / MANIFEST
        self.journal = path / JOURNAL
        self.innerloop = path / DESIGN_RECORD
        self.bounds = path / BOUNDS
        self.statistics = path / STATISTICS
        self.model = path / MODEL

    def open(self, config_hash: str, *, resume: bool) -> None:
        """Open the directory for a new run, or to resume one of this configuration."""
        if resume:
            self.open_existing(config_hash)
        else:
            self.open_new()

    def open_new(self) -> None:
        """Create the directory.

        Raises
        ------
        InputError : the directory is not empty, or cannot be written
        """
        self.refuse_taken()
        self._create()

    def refuse_taken(self) -> None:
        """Raise an InputError if the directory is not empty."""
        if self.manifest.exists():
            raise InputError(
                f"output directory '{self.path}' holds another run; choose another --out, or continue it with --resume"
            )
        if self.path.is_dir() and any(self.path.iterdir()):
            raise InputError(f"output directory '{self.path}' is not empty; choose another --out")

    def open_existing(self, config_hash: str) -> None:
        """Open a directory with an unfinished or finished run of the same configuration.

        Raises
        ------
        InputError : there is no run, its configuration or software differs, or the directory cannot be written
        """
        if not self.manifest.is_file():
            raise InputError(f"'{self.path}' holds no run to resume; leave out --resume to start one")
        try:
            manifest = json.loads(self.manifest.read_text(encoding="utf-8"))
            found, theirs = manifest["config_hash"], dict(manifest.get("fingerprint", {}))
        except (ValueError, KeyError, TypeError, OSError):
            raise InputError(f"'{self.manifest}' cannot be read; start a new run in another --out") from None
        if found != config_hash:
            raise InputError(
                f"'{self.path}' was run with another configuration; resume it with the same scenario, --seed and --set values"
            )
        if differing := differences(theirs):
            name = differing[0]
            before, now = theirs.get(name, "unknown"), fingerprint()[name]
            raise InputError(
                f"'{self.path}' was started with {name} {before}, now it is {now}: results would not be comparable;"
                f" resume it with the same {name}, or start a new run in another --out"
            )
        self._create()

    def sweep(self) -> None:
        """Remove partly written files of a program that was killed. No other program may be writing."""
        for part in self.path.rglob(".*.part"):
            part.unlink()

    def _create(self) -> None:
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            probe = self.path / f".probe-{uuid.uuid4().hex}"
            probe.touch()
            probe.unlink()
        except OSError as error:
            raise InputError(f"output directory '{self.path}' cannot be written: {error.strerror}; choose another --out") from None

    def write_json(self, path: Path, value: Mapping[str, Any]) -> None:
        """Write a JSON file, completely or not at all."""
        write_json(path, value)

    def write_frame(self, name: str, frame: "pd.DataFrame") -> None:
        """Write a table to ``name``, a CSV or Parquet file by its suffix, completely or not at all."""
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write = frame.to_parquet if name.endswith(HISTORY_SUFFIX) else frame.to_csv
        write_whole(path, lambda part: write(part, index=False))

    def write_bytes(self, name: str, content: bytes) -> None:
        """Write a file of the run, completely or not at all."""
        path = self.path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, lambda part: part.write_bytes(content))
