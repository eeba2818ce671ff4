"""What of a run is done, on disk as it goes."""

import time
from collections.abc import Sequence
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
    crossing_columns : of the table of crossings
    """

    def __init__(
        self, run: RunDirectory, flights: Sequence[str], *, tables: Sequence[Table], crossing_columns: tuple[str, ...]
    ) -> None:
        self._run, self._tables, self._crossing_columns = run, tables, crossing_columns
        self._order = {flight: i for i, flight in enumerate(flights)}
        found = [row for table in tables for row in run.read_rows(table.name) if row.get("message") != DIED]
        self._rows: dict[str, Row] = {row["flight_id"]: row for row in found if row.get("flight_id") in self._order}
        self._crossings = [row for row in run.read_rows("crossings.csv") if row.get("flight_id") in self._rows]
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

    def add(self, flight: str, row: Row, crossings: Sequence[Row]) -> None:
        """Take in a flight that is done."""
        self._rows[flight] = row
        self._crossings += crossings
        self._waiting.add(flight)
        if time.monotonic() - self._written >= _FLUSH_INTERVAL:
            self.flush()

    def flush(self) -> None:
        """Write what has not been written yet. A flight counts as done once its row is on disk, and its crossings are by then."""
        if not self._waiting:
            return
        self._crossings.sort(key=lambda row: (self._order[row["flight_id"]], row["crossing"]))
        self._run.write_rows("crossings.csv", self._crossings, self._crossing_columns)
        for table in self._tables:
            if self._waiting & table.flights:
                self._run.write_rows(table.name, self.rows(table), table.columns)
        self._waiting.clear()
        self._written = time.monotonic()
