"""What of a study is done, on disk as it comes.

A result is in the journal or it is not: whatever ends the program, and whenever, the next one finds every result that was
told to be done. Tables are written from it, in the order of the tasks, one row at a time: a study may have more rows than memory.
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
"""SQLite's largest whole number."""

_SCHEMA = "CREATE TABLE IF NOT EXISTS results (number INTEGER PRIMARY KEY, point TEXT, items INTEGER, lost INTEGER, tables TEXT)"


class Journal:
    """Results of a study, by the numbers of their tasks.

    Parameters
    ----------
    path : of its file; made if there is none

    Raises
    ------
    InputError : another program is writing it, or it is none
    """

    def __init__(self, path: Path) -> None:
        self._database = sqlite3.connect(path, isolation_level=None, timeout=0.0)
        try:
            # Alone: two programs that fly the same study would undo each other's work.
            self._database.execute("PRAGMA locking_mode = EXCLUSIVE")
            self._database.execute("PRAGMA journal_mode = WAL")
            self._database.execute("PRAGMA synchronous = NORMAL")
            self._database.execute(_SCHEMA)
        except sqlite3.OperationalError as error:
            self._database.close()
            if "locked" not in str(error):
                raise
            raise InputError(f"'{path.parent}' is being flown by another program; wait for it, or choose another --out") from None
        except sqlite3.DatabaseError as error:
            self._database.close()
            if not is_damaged(error):
                raise
            raise InputError(f"'{path}' is damaged; start a new run in another --out") from None

    def close(self) -> None:
        """Close its file."""
        self._database.close()

    def add(self, result: Result) -> None:
        """Take in a result; no end of the program loses it from then on. One that was there for its task is replaced."""
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
        """Return the numbers of the tasks that are done; those whose process was lost are not."""
        return {number for (number,) in self._database.execute("SELECT number FROM results WHERE NOT lost")}

    def task(self, number: int) -> Task:
        """Return the task of a result."""
        ((point,),) = self._database.execute("SELECT point FROM results WHERE number = ?", (number,))
        return Task(number=number, point=tuple(json.loads(point)))

    def items(self) -> int:
        """Return how many of what the study counts are done."""
        return int(self._database.execute("SELECT COALESCE(SUM(items), 0) FROM results WHERE NOT lost").fetchone()[0])

    def numbered(self, table: str, *, first: int = 0, below: int = _LARGEST) -> Iterator[tuple[int, Row]]:
        """Yield the rows of a table with the numbers of their tasks, in that order: those from ``first`` to below ``below``."""
        query = "SELECT number, tables FROM results WHERE number >= ? AND number < ? ORDER BY number"
        found = self._database.execute(query, (first, below))
        for number, text in found:
            for row in json.loads(text).get(table, ()):
                yield number, row

    def rows(self, table: str, *, first: int = 0, below: int = _LARGEST) -> Iterator[Row]:
        """Yield the rows of a table in the order of their tasks: of those numbered from ``first`` to below ``below``."""
        return (row for _, row in self.numbered(table, first=first, below=below))

    def export(self, table: str, columns: tuple[str, ...], file: IO[str]) -> int:
        """Write a table with exactly ``columns`` as CSV; figures that a row lacks are empty. Return the number of rows."""
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        count = 0
        for count, row in enumerate(self.rows(table), start=1):  # noqa: B007 - the last one is returned
            writer.writerow([_text(row.get(name)) for name in columns])
        return count


def is_full(error: sqlite3.DatabaseError) -> bool:
    """Return whether there was no room left on the disk."""
    return _code(error) == sqlite3.SQLITE_FULL


def is_damaged(error: sqlite3.DatabaseError) -> bool:
    """Return whether the file is no journal, or no longer one."""
    return _code(error) in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)


def _code(error: sqlite3.DatabaseError) -> int:
    """Return the primary code of SQLite's error."""
    return int(error.sqlite_errorcode) & 0xFF


def _plain(value: Any) -> Any:
    """Return a figure of numpy as Python's own."""
    return value.item()


def _text(value: Any) -> Any:
    return "" if value is None or (isinstance(value, float) and math.isnan(value)) else value
