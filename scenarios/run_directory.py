"""A run directory: what is in it, and writing it whole or not at all."""

import json
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from reports.files import write_json, write_whole
from scenarios.errors import InputError

Row = dict[str, Any]


class RunDirectory:
    """Paths and files of one run.

    Parameters
    ----------
    path : the directory; created by ``open_new``
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.manifest = path / "manifest.json"
        self.innerloop = path / "innerloop.json"
        self.bounds = path / "bounds.json"
        self.model = path / "model"
        self.flights = path / "flights"
        self.trajectories = path / "trajectories"

    def open(self, config_hash: str, *, resume: bool) -> None:
        """Open the directory for a new run, or to go on with one of this configuration; see ``open_new`` and ``open_existing``."""
        if resume:
            self.open_existing(config_hash)
        else:
            self.open_new()

    def open_new(self) -> None:
        """Create the directory.

        Raises
        ------
        InputError : it holds something already, or cannot be written
        """
        self.refuse_taken()
        self._create()

    def refuse_taken(self) -> None:
        """Raise an InputError where the directory holds something already."""
        if self.manifest.exists():
            raise InputError(
                f"output directory '{self.path}' holds another run; choose another --out, or continue it with --resume"
            )
        if self.path.is_dir() and any(self.path.iterdir()):
            raise InputError(f"output directory '{self.path}' is not empty; choose another --out")

    def open_existing(self, config_hash: str) -> None:
        """Open a directory that holds an unfinished or finished run of the same configuration.

        Raises
        ------
        InputError : there is no run, its configuration differs, or it cannot be written
        """
        if not self.manifest.is_file():
            raise InputError(f"'{self.path}' holds no run to resume; leave out --resume to start one")
        try:
            found = json.loads(self.manifest.read_text(encoding="utf-8"))["config_hash"]
        except (ValueError, KeyError, TypeError, OSError):
            raise InputError(f"'{self.manifest}' cannot be read; start a new run in another --out") from None
        if found != config_hash:
            raise InputError(
                f"'{self.path}' was run with another configuration; resume it with the same scenario, --seed and --set values"
            )
        self._create()

    def _create(self) -> None:
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            probe = self.path / f".probe-{uuid.uuid4().hex}"
            probe.touch()
            probe.unlink()
        except OSError as error:
            raise InputError(f"output directory '{self.path}' cannot be written: {error.strerror}; choose another --out") from None

    def write_json(self, path: Path, value: Mapping[str, Any]) -> None:
        """Write a JSON file, whole or not at all."""
        write_json(path, value)

    def write_rows(self, name: str, rows: list[Row], columns: tuple[str, ...]) -> None:
        """Write a table with exactly ``columns`` to ``name``, whole or not at all; figures that a row lacks are empty."""
        self.write_frame(name, pd.DataFrame(rows, columns=list(columns)))

    def write_frame(self, name: str, frame: pd.DataFrame) -> None:
        """Write a table to ``name``, a CSV or Parquet file by its ending, whole or not at all."""
        write = frame.to_parquet if name.endswith(".parquet") else frame.to_csv
        write_whole(self.path / name, lambda part: write(part, index=False))

    def read_frame(self, name: str) -> pd.DataFrame | None:
        """Return the table of a Parquet file, or none where there is no such file."""
        path = self.path / name
        return pd.read_parquet(path) if path.is_file() else None

    def read_rows(self, name: str) -> list[Row]:
        """Return the rows of a table, or none where there is no such file."""
        path = self.path / name
        if not path.is_file():
            return []
        records = pd.read_csv(path, keep_default_na=False, na_values=[""]).to_dict("records")
        return [{str(k): v for k, v in row.items() if not pd.isna(v)} for row in records]

    def write_history(self, flight_id: str, history: pd.DataFrame) -> None:
        """Write a flight's time history, whole or not at all."""
        self.flights.mkdir(exist_ok=True)
        self.write_frame(f"{self.flights.name}/{flight_id}.parquet", history)
