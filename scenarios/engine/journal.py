"""The journal: results of a study, stored on disk as they arrive.

A result is either in the journal or not: whenever and however the program ends, the next one finds every result that
was added. Tables are written from the journal in the order of the tasks, one row at a time: a study may have more rows
than fit into memory.
"""

import csv
import json
import math
import sqlite3
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError

_LARGEST = 2**63 - 1
"""SQLite's largest integer."""

_SCHEMA = "CREATE TABLE IF NOT EXISTS results (number INTEGER PRIMARY KEY, point TEXT, items INTEGER, lost INTEGER, tables TEXT)"


class Journal:
    """Results of a study, by the numbers of their tasks.

    Parameters
    ----------
    path : path of the file; created if it does not exist

    Raises
    ------
    InputError : another program is writing to it, or it is damaged
    """

    def __init__(self, path: Path) -> None:
        self._database = sqlite3.connect(path, isolation_level=None, timeout=0.0)
        try:
            # Exclusive: two programs that fly the same study would overwrite each other's results.
            self._database.execute("PRAGMA locking_mode = EXCLUSIVE")
            self._database.execute("PRAGMA journal_mode = WAL")
            self._database.execute("PRAGMA synchronous = NORMAL")
            self._database.execute(_SCHEMA)
        except sqlite3.OperationalError as error:
            self._database.close()
            if "locked" not in str(error):
                raise
            raise InputError(
                f"another program is writing to '{path.parent}'; wait until it has ended, or choose another --out"
            ) from None
        except sqlite3.DatabaseError as error:
            self._database.close()
            if not is_damaged(error):
                raise
            raise InputError(f"'{path}' is damaged; start a new run in another --out") from None

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    def add(self, result: Result) -> None:
        """Store a result, replacing an earlier one of its task; from then on it survives any end of the program."""
        self._database.execute(
            "INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?, ?)",
            (
                result.task.number,
                json.dumps(result.task.point),
                result.items,
                result.lost,
                json.dumps(result.tables, default=_plain),
            ),
        )

    def done(self) -> set[int]:
        """Return the numbers of the tasks that are done; tasks whose process was lost are not."""
        return {number for (number,) in self._database.execute("SELECT number FROM results WHERE NOT lost")}

    def task(self, number: int) -> Task:
        """Return the task of a result."""
        ((point,),) = self._database.execute("SELECT point FROM results WHERE number = ?", (number,))
        return Task(number=number, point=tuple(json.loads(point)))

    def items(self) -> int:
        """Return the number of items that are done."""
        return int(self._database.execute("SELECT COALESCE(SUM(items), 0) FROM results WHERE NOT lost").fetchone()[0])

    def numbered(self, table: str, *, first: int = 0, below: int = _LARGEST) -> Iterator[tuple[int, Row]]:
        """Yield task number and row of a table, by ascending task number from ``first`` to below ``below``."""
        query = "SELECT number, tables FROM results WHERE number >= ? AND number < ? ORDER BY number"
        found = self._database.execute(query, (first, below))
        for number, text in found:
            for row in json.loads(text).get(table, ()):
                yield number, row

    def rows(self, table: str, *, first: int = 0, below: int = _LARGEST) -> Iterator[Row]:
        """Yield the rows of a table, by ascending task number from ``first`` to below ``below``."""
        return (row for _, row in self.numbered(table, first=first, below=below))

    def export(self, table: str, columns: tuple[str, ...], file: IO[str]) -> int:
        """Write a table as CSV with exactly ``columns``, missing values empty; return the number of rows."""
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        count = 0
        for count, row in enumerate(self.rows(table), start=1):  # noqa: B007 - the last one is returned
            writer.writerow([_text(row.get(name)) for name in columns])
        return count


def is_full(error: sqlite3.DatabaseError) -> bool:
    """Return whether the disk was full."""
    return _code(error) == sqlite3.SQLITE_FULL


def is_damaged(error: sqlite3.DatabaseError) -> bool:
    """Return whether the file is damaged, or not a journal."""
    return _code(error) in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)


def _code(error: sqlite3.DatabaseError) -> int:
    """Return the primary error code of SQLite."""
    return int(error.sqlite_errorcode) & 0xFF


def _plain(value: Any) -> Any:
    """Return a numpy scalar as a Python number."""
    return value.item()


def _text(value: Any) -> Any:
    return "" if value is None or (isinstance(value, float) and math.isnan(value)) else value
