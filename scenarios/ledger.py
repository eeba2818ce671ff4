"""What of a run is done, on disk as it goes."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from scenarios.pool import DIED
from scenarios.run_directory import RunDirectory

Row = dict[str, Any]

_FLUSH_INTERVAL = 2.0
"""Shortest time between two writings of the tables [s]: they are written whole, and grow."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table of the run directory.

    Attributes
    ----------
    name : of its file
    columns : in order
    flights : whose rows it holds
    """

    name: str
    columns: tuple[str, ...]
    flights: frozenset[str]


class Ledger:
    """Rows of flights, written to the run directory within two seconds of being done.

    Parameters
    ----------
    run : the run directory; what it holds already is taken over, but for flights whose process died: they are flown again
    flights : all that are planned, in their order
    tables : for their rows; each flight in one of them
    details : columns of the tables that hold several rows of a flight, each with its time, by their names
    """

    def __init__(
        self, run: RunDirectory, flights: Sequence[str], *, tables: Sequence[Table], details: Mapping[str, tuple[str, ...]]
    ) -> None:
        self._run, self._tables, self._columns = run, tables, dict(details)
        self._order = {flight: i for i, flight in enumerate(flights)}
        found = [row for table in tables for row in run.read_rows(table.name) if row.get("message") != DIED]
        self._rows: dict[str, Row] = {row["flight_id"]: row for row in found if row.get("flight_id") in self._order}
        self._details = {name: [row for row in run.read_rows(name) if row.get("flight_id") in self._rows] for name in self._columns}
        self._waiting: set[str] = set()
        self._written = -_FLUSH_INTERVAL

    @property
    def done(self) -> set[str]:
        """Return the flights that are done."""
        return set(self._rows)

    def rows(self, table: Table) -> list[Row]:
        """Return the rows of a table, in the order of the flights."""
        rows = [row for flight, row in self._rows.items() if flight in table.flights]
        return sorted(rows, key=lambda row: self._order[row["flight_id"]])

    def add(self, flight: str, row: Row, details: Mapping[str, Sequence[Row]]) -> None:
        """Take in a flight that is done."""
        self._rows[flight] = row
        for name, rows in details.items():
            self._details[name] += rows
        self._waiting.add(flight)
        if time.monotonic() - self._written >= _FLUSH_INTERVAL:
            self.flush()

    def flush(self) -> None:
        """Write what has not been written yet. A flight counts as done once its row is on disk, and its details are by then."""
        if not self._waiting:
            return
        for name, rows in self._details.items():
            rows.sort(key=lambda row: (self._order[row["flight_id"]], row["time_s"]))
            self._run.write_rows(name, rows, self._columns[name])
        for table in self._tables:
            if self._waiting & table.flights:
                self._run.write_rows(table.name, self.rows(table), table.columns)
        self._waiting.clear()
        self._written = time.monotonic()
