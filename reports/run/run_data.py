"""A run directory and its tables as read from disk."""

import csv
import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa

from common.columns import Column, Table, column_of, from_json
from common.files import is_file
from common.run_layout import (
    COLUMNS,
    COMPARISON,
    CROSSINGS,
    DERIVED,
    DESIGN_RECORD,
    DRAWS,
    FILES,
    FORMAT,
    MANIFEST,
    OVERRIDES,
    STATISTICS,
    SULPHUR,
    SUMMARY,
    VERDICT,
    evaluation_path,
    is_file_name,
    smoke_path,
    time_history_path,
    traffic_path,
)
from common.text import MARK, from_cell, from_json_cell
from common.verdict import RunVerdict, read_verdict
from reports.errors import ReportError
from reports.run.columns import Mask
from reports.run.files import refuse_running

REMEDY = "repeat the run's command with --resume, which writes the tables anew"
"""What is done about tables that were changed."""

_NAMES = ("flight_id", "trial", "variant", "beside", "confirms")
"""Columns of names, which stay text where they are all digits, in a run that does not say so."""

_TRUTH = ("True", "False", "", "nan", "None")
"""What a column of truth values may hold; of a flight without one it is empty."""

_OTHER_SEPARATORS = (";", "\t")
"""Separators of a table that a spreadsheet has saved."""

_LINE_MOST = 1_000_000
"""Bytes of a row at most."""


def read_table(
    path: Path, columns: Table | None = None, *, empty: Sequence[str] = ("flight_id",)
) -> pd.DataFrame:
    """Return a table of a run; one without rows if the run has none.

    Parameters
    ----------
    path : of the file
    columns : by the run; those of text stay text where they are all digits
    empty : columns of a table that the run does not have

    Raises
    ------
    ReportError : it cannot be read, is not separated by commas, or its last line is cut off
    """
    if not path.is_file():
        return pd.DataFrame(columns=list(empty))
    try:
        with path.open(encoding="utf-8") as file:
            head = file.readline()
        if max(map(head.count, _OTHER_SEPARATORS)) > head.count(","):
            raise ReportError(
                f"'{path}' is not separated by commas: it was saved by another program; {REMEDY}"
            )
        text = [name for name, column in (columns or {}).items() if column.kind == "text"]
        frame = pd.read_csv(
            path, keep_default_na=False, na_values=[""], dtype=dict.fromkeys(text or _NAMES, str)
        )
    except ReportError:
        raise
    except (ValueError, OSError) as error:
        raise ReportError(
            f"'{path}' cannot be read: {str(error).splitlines()[0]}; {REMEDY}"
        ) from None
    if _last_row(path) < len(frame.columns):
        raise ReportError(f"the last line of '{path}' is cut off; {REMEDY}")
    # Few tables hold a mark, and to look for one in each cell takes a quarter of the time. Columns
    # of nothing are of numbers.
    marked = MARK in path.read_text(encoding="utf-8")
    for name in frame.select_dtypes(exclude=["number", "bool"]).columns:
        if marked or frame[name].isna().all():
            frame[name] = frame[name].map(from_cell)
    for name in ("criteria_met", "kept_out"):
        if name in frame:
            cells = pd.Series([str(value) for value in frame[name]], frame.index, dtype=str)
            if len(others := cells[~cells.isin(_TRUTH)]):
                raise ReportError(
                    f"'{path}' has {others.iloc[0]!r} in {name}; it must be True or False: {REMEDY}"
                )
            frame[name] = cells == "True"
    for name in ("message", "outcome"):
        if name in frame:
            frame[name] = ["" if pd.isna(value) else str(value) for value in frame[name]]
    # In one piece: pandas warns of a frame whose many columns were replaced one by one.
    return frame.copy()


def _last_row(path: Path) -> int:
    """Return how many cells the last line has."""
    with path.open("rb") as file:
        file.seek(max(0, os.fstat(file.fileno()).st_size - _LINE_MOST))
        line = file.read().rstrip(b"\r\n").rpartition(b"\n")[-1]
    return len(next(csv.reader([line.decode("utf-8", errors="replace")]), []))


WITHOUT_SUMMARY = ("design", "measurement")
"""Studies that have nothing to count."""

WITH_SECTIONS = ("sniffer",)
"""Instruments that have sections of their own in reports; the figures of others share one."""


FLIGHT_ENTRIES = ("title", "trials", "trial_parameters", "modes")
"""What reports on flights need of a manifest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunData:
    """What a run left behind.

    Attributes
    ----------
    path : the run directory
    manifest : its configuration and provenance
    judgement : the verdict that its study has written; None of a design, a measured flight, and a
        run that did not end
    summary : a row per flight of the study, or per trajectory and law; empty for a design
    comparison : a row per flight of the comparisons, possibly none
    crossings : a row per crossing
    innerloop : the autopilot's design record, or none if the run ended before
    statistics : what a Monte Carlo study shows and how sure that is, or none of any other run
    draws : of each flight, what was swept or sampled
    overrides : the keys that each flight has otherwise than its trial, by its name
    columns : what the columns of its tables are, by file and name
    unread : files that are there and cannot be read, as found so far
    """

    path: Path
    manifest: dict[str, Any]
    summary: pd.DataFrame
    comparison: pd.DataFrame
    crossings: pd.DataFrame
    innerloop: dict[str, Any] | None
    statistics: dict[str, Any] | None
    draws: pd.DataFrame
    judgement: RunVerdict | None = None
    overrides: Mapping[str, Mapping[str, object]] = field(default_factory=dict)
    columns: Mapping[str, Table] = field(default_factory=dict)
    unread: set[str] = field(default_factory=set)

    @property
    def verdict(self) -> RunVerdict:
        """What the run has shown.

        Raises
        ------
        ReportError : it has no verdict that can be read, as one that was killed
        """
        if self.judgement is None:
            raise ReportError(
                f"'{self.path}' has no {VERDICT} that can be read: its run did not end, or the file"
                " was"
                " changed; continue the run with --resume, which writes it anew"
            )
        return self.judgement

    def column(self, name: str, table: str = SUMMARY) -> Column:
        """Return a column of a table; of the summary also a figure that follows from it."""
        derived = table == SUMMARY and name not in self.columns.get(SUMMARY, {})
        return column_of(self.columns, DERIVED if derived else table, name)

    def added(self, table: str) -> dict[str, Column]:
        """Return the columns of a table that a user's instrument or study fills, by their names."""
        return {
            name: column
            for name, column in self.columns.get(table, {}).items()
            if column.part not in ("", *WITH_SECTIONS)
        }

    def history(self, flight_id: str) -> pd.DataFrame | None:
        """Return a flight's time history, or None if it has none that can be read."""
        return self.parquet(time_history_path(flight_id)) if is_file_name(flight_id) else None

    def evaluation(self, flight_id: str) -> dict[str, Any] | None:
        """Return what an instrument made of a flight, or None if there is nothing that can be
        read.
        """
        return (
            _record(self.path / evaluation_path(flight_id), self.unread)
            if is_file_name(flight_id)
            else None
        )

    def smoke(self, flight_id: str) -> dict[str, Any] | None:
        """Return the parcels of a flight's exhaust, or None if there are none that can be read."""
        return (
            _record(self.path / smoke_path(flight_id), self.unread)
            if is_file_name(flight_id)
            else None
        )

    def traffic(self, flight_id: str) -> list[dict[str, Any]]:
        """Return the tracks of the other ships of a flight that can be read."""
        if not is_file_name(flight_id):
            return []
        found = _record(self.path / traffic_path(flight_id), self.unread)
        ships: list[dict[str, Any]] = found.get("ships", []) if found else []
        return ships

    @property
    def sulphur(self) -> dict[str, Any] | None:
        """Statistics of the flights with a sniffer, or None of a run without."""
        return _record(self.path / SULPHUR, self.unread)

    def has_history(self, flight_id: str) -> bool:
        """Return whether a flight has a time history."""
        return is_file_name(flight_id) and is_file(self.path / time_history_path(flight_id))

    def with_history(self, rows: pd.DataFrame) -> Mask:
        """Return which flights have a time history, given their rows."""
        return np.array(
            [self.has_history(str(flight_id)) for flight_id in rows["flight_id"]], dtype=np.bool_
        )

    def recorded(self) -> list[str]:
        """Return the names of the flights that have a time history, those of the study before those
        of its comparisons.
        """
        return [str(row["flight_id"]) for row in self.recorded_rows()]

    def recorded_rows(self) -> list[dict[str, object]]:
        """Return the rows of the flights that have a time history, those of the study before those
        of its comparisons.
        """
        # The rows of a study of something else than flights name none.
        tables = [rows for rows in (self.summary, self.comparison) if "flight_id" in rows]
        rows = [
            {str(key): value for key, value in row.items()}
            for table in tables
            for row in table.to_dict("records")
        ]
        return [row for row in rows if self.has_history(str(row["flight_id"]))]

    def of_flight(self, flight_id: str) -> "RunData":
        """Return the same run with one flight alone."""
        tables = {
            name: rows[rows["flight_id"] == flight_id] if "flight_id" in rows else rows
            for name in ("summary", "comparison", "crossings", "draws")
            for rows in [getattr(self, name)]
        }
        return replace(self, **tables)

    def missing(self) -> list[str]:
        """Return the files that the run had when it ended, and that are gone or, as far as they
        were needed, cannot be read.
        """
        listed = self.manifest.get(FILES)
        names = [str(name) for name in listed] if isinstance(listed, list) else []
        return sorted({*(name for name in names if not is_file(self.path / name)), *self.unread})

    def parquet(self, name: str) -> pd.DataFrame | None:
        """Return a Parquet file of the run, or None if there is none that can be read."""
        if not is_file(self.path / name):
            return None
        # The file is read whole and in one thread: pandas takes twice as long for the same.
        from pyarrow.parquet import ParquetFile

        try:
            with ParquetFile(self.path / name) as file:
                frame: pd.DataFrame = file.read(use_threads=False).to_pandas(use_threads=False)
                return frame
        except (ValueError, OSError, pa.ArrowException):
            self.unread.add(name)
            return None

    def crossings_of(self, flight_id: str) -> pd.DataFrame:
        """Return the crossings of a flight."""
        return self.crossings[self.crossings["flight_id"] == flight_id]


def refuse_other_version(run: RunData, needed: Sequence[str] = FLIGHT_ENTRIES) -> None:
    """Refuse a run whose manifest lacks an entry, by default one that reports on flights need.

    Raises
    ------
    ReportError : it names the first one that is missing
    """
    if missing := [entry for entry in needed if entry not in run.manifest]:
        raise ReportError(
            f"'{run.path}' was flown by another version: its {MANIFEST} has no '{missing[0]}';"
            " report on it with that version, or"
            " run the scenario again in another --out"
        )


def read_run(path: Path) -> RunData:
    """Read a run directory.

    Raises
    ------
    ReportError : it is not one, is of another version or damaged, holds nothing finished, lacks
        rows, or is being written
    """
    if is_file(path):
        raise ReportError(f"'{path}' is a file; name the directory of its run, '{path.parent}'")
    refuse_running(path)
    try:
        manifest = json.loads((path / MANIFEST).read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise ReportError(
            f"'{path}' holds no run (no {MANIFEST}); give the directory that plume-flight run named"
        ) from None
    except (ValueError, OSError, RecursionError) as error:
        raise ReportError(
            f"'{path}': {MANIFEST} cannot be read: {error}; run the scenario again"
        ) from None
    if not (isinstance(manifest, dict) and isinstance(manifest.get("config"), dict)):
        raise ReportError(
            f"'{path}': {MANIFEST} is not that of a run; run the scenario again in another --out"
        )
    if "trials" in manifest and not (isinstance(manifest["trials"], dict) and manifest["trials"]):
        raise ReportError(
            f"'{path}': {MANIFEST} names no trials, whose flights these are; run the scenario again"
            " in another --out"
        )
    if (version := manifest.get("format")) != FORMAT:
        raise ReportError(
            f"'{path}' is a run of format {version!r}, and this version reads {FORMAT}; use the"
            " version that made it"
        )
    if manifest.get("study") not in WITHOUT_SUMMARY and not (path / SUMMARY).is_file():
        raise ReportError(
            f"'{path}' holds nothing finished (no {SUMMARY}); continue the run with --resume"
        )
    unread: set[str] = set()
    verdict = _verdict(path, unread)
    columns = _columns(path, unread)
    return RunData(
        path=path,
        manifest=manifest,
        summary=_whole(read_table(path / SUMMARY, columns.get(SUMMARY)), path / SUMMARY, verdict),
        comparison=read_table(path / COMPARISON, columns.get(COMPARISON)),
        crossings=read_table(
            path / CROSSINGS,
            columns.get(CROSSINGS),
            empty=("flight_id", "time_s", "distance_m"),
        ),
        innerloop=_record(path / DESIGN_RECORD, unread),
        statistics=_record(path / STATISTICS, unread),
        judgement=verdict,
        draws=read_table(path / DRAWS, columns.get(DRAWS)),
        overrides=read_overrides(path / OVERRIDES, unread),
        columns=columns,
        unread=unread,
    )


def _whole(summary: pd.DataFrame, path: Path, verdict: RunVerdict | None) -> pd.DataFrame:
    """Return the summary, unless it has fewer rows than its verdict counts."""
    if verdict and len(summary) < verdict.counts.done:
        raise ReportError(
            f"'{path}' has {len(summary):,} rows; by {VERDICT} the run ended with"
            f" {verdict.counts.done:,}: {REMEDY}"
        )
    return summary


def _verdict(path: Path, unread: set[str]) -> RunVerdict | None:
    """Return the verdict that a run has written, or None."""
    if not is_file(path / VERDICT):
        return None
    try:
        return read_verdict(path / VERDICT)
    except (OSError, ValueError, TypeError, LookupError, AttributeError, RecursionError):
        unread.add(VERDICT)
        return None


def _columns(path: Path, unread: set[str]) -> dict[str, dict[str, Column]]:
    """Return what the columns of a run's tables are; nothing where that cannot be read."""
    try:
        return from_json(_record(path / COLUMNS, unread) or {})
    except (ValueError, TypeError, AttributeError):
        unread.add(COLUMNS)
        return {}


def read_overrides(path: Path, unread: set[str]) -> dict[str, dict[str, object]]:
    """Return the keys that flights have otherwise than their trials, by the names of flights."""
    if not is_file(path):
        return {}
    try:
        frame = pd.read_csv(path, dtype=str, keep_default_na=False)
    except (ValueError, OSError):
        unread.add(path.name)
        return {}
    keys = [str(key) for key in frame if key not in ("flight_id", "trial", "variant")]
    columns = [frame[key].tolist() for key in keys]
    return {
        str(flight_id): {
            key: from_json_cell(column[i])
            for key, column in zip(keys, columns, strict=True)
            if column[i]
        }
        for i, flight_id in enumerate(frame.get("flight_id", ()))
    }


def _record(path: Path, unread: set[str]) -> dict[str, Any] | None:
    if not is_file(path):
        return None
    try:
        return dict(json.loads(path.read_text(encoding="utf-8")))
    except (ValueError, TypeError, OSError, RecursionError):
        unread.add(path.name)
        return None
