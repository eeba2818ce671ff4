"""The journal: a database with the results of a study, stored as they arrive.

However the program ends, the next program finds every result that was added. Tables are written
from the journal in the order of the tasks, one row at a time, because a study may have more rows
than fit into memory. Every result has a checksum; a journal with a wrong checksum is refused.
"""

import csv
import hashlib
import json
import random
import sqlite3
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from common.files import plain_number
from common.text import cell
from scenarios.engine.task import Result, Row, Task
from scenarios.errors import InputError

_LARGEST = 2**63 - 1
"""SQLite's largest integer."""

_BUSY = (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED, sqlite3.SQLITE_PROTOCOL)
"""SQLite's error codes for a file that another connection uses."""

_ATTEMPTS = 6
"""Attempts to open a journal: SQLite may refuse two programs that open it at the same time."""

_WAIT = 0.05
"""Longest wait between attempts [s]; it is random, so that two programs do not collide again."""

CONTINUE = "continue with --resume"
"""Remedy once a run can be written again."""

_COLUMNS = ("number", "point", "items", "lost", "tables", "checksum")

_SCHEMA = (
    "CREATE TABLE IF NOT EXISTS results"
    " (number INTEGER PRIMARY KEY, point TEXT, items INTEGER, lost INTEGER, tables TEXT,"
    " checksum TEXT)"
)


class Journal:
    """Results of a study by task number.

    Parameters
    ----------
    path : path of the file, which is created if it does not exist
    reading : whether the journal is only read, so that nothing is written into somebody else's run

    Raises
    ------
    InputError : another program is writing the journal, or it is damaged or unusable
    """

    def __init__(self, path: Path, *, reading: bool = False) -> None:
        self._path = path
        # A write-ahead log shows that a program was killed or is writing: SQLite has to handle it.
        closed = reading and not path.with_name(f"{path.name}-wal").exists()
        for attempt in range(1, _ATTEMPTS + 1):
            try:
                self._database = _opened(path, writing=not closed)
                break
            except sqlite3.DatabaseError as error:
                if _code(error) not in _BUSY:
                    raise self._explained(error, reading=reading) from None
                if attempt == _ATTEMPTS:
                    raise InputError(
                        f"another program is writing to '{path.parent}'; wait until it has"
                        " ended, or choose another --out"
                    ) from None
                time.sleep(random.SystemRandom().uniform(0.0, _WAIT))
        try:
            self._check()
        except sqlite3.DatabaseError as error:
            self._database.close()
            raise self._explained(error, reading=reading) from None
        except InputError:
            self._database.close()
            raise

    def _explained(self, error: sqlite3.DatabaseError, *, reading: bool) -> Exception:
        """Return the error to raise for an error of SQLite; that of a full disk stays unchanged."""
        if is_full(error) and not reading:
            return error
        return unusable(self._path, error, then="try again" if reading else CONTINUE)

    def _check(self) -> None:
        """Raise an InputError if the journal or one of its results is damaged."""
        columns = tuple(
            name for _, name, *_ in self._database.execute("PRAGMA table_info(results)")
        )
        if columns != _COLUMNS:
            raise InputError(
                f"'{self._path}' is not a journal of this version; start a new run in another --out"
            )
        for *fields, checksum in self._database.execute(
            f"SELECT {', '.join(_COLUMNS)} FROM results"
        ):
            if checksum != _checksum(*fields) or not _is_tables(fields[-1]):
                raise damaged(
                    self._path, f": the result of task {fields[0]} does not agree with its checksum"
                )

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    def add(self, result: Result) -> None:
        """Store a result durably, replacing an earlier one of its task."""
        fields = (
            result.task.number,
            json.dumps(result.task.point),
            result.items,
            int(result.lost),
            json.dumps(result.tables, default=plain_number),
        )
        self._database.execute(
            "INSERT OR REPLACE INTO results VALUES (?, ?, ?, ?, ?, ?)",
            (*fields, _checksum(*fields)),
        )

    def is_empty(self) -> bool:
        """Return whether the journal has no results."""
        return self._database.execute("SELECT 1 FROM results LIMIT 1").fetchone() is None

    def done(self) -> set[int]:
        """Return the numbers of the tasks that are done, without those whose process was lost."""
        return {
            number
            for (number,) in self._database.execute("SELECT number FROM results WHERE NOT lost")
        }

    def task(self, number: int) -> Task:
        """Return the task of a result."""
        ((point,),) = self._database.execute(
            "SELECT point FROM results WHERE number = ?", (number,)
        )
        return Task(number=number, point=tuple(json.loads(point)))

    def items(self) -> int:
        """Return the number of items in the results that are done."""
        return int(
            self._database.execute(
                "SELECT COALESCE(SUM(items), 0) FROM results WHERE NOT lost"
            ).fetchone()[0]
        )

    def without_items(self) -> int:
        """Return the number of results that are done and have no item."""
        return int(
            self._database.execute(
                "SELECT COUNT(*) FROM results WHERE NOT lost AND items = 0"
            ).fetchone()[0]
        )

    def numbered(
        self, table: str, *, first: int = 0, below: int = _LARGEST
    ) -> Iterator[tuple[int, Row]]:
        """Yield task number and row of a table, for tasks from ``first`` to below ``below``."""
        query = (
            "SELECT number, tables FROM results WHERE number >= ? AND number < ? ORDER BY number"
        )
        found = self._database.execute(query, (first, below))
        for number, text in found:
            for row in json.loads(text).get(table, ()):
                yield number, row

    def rows(self, table: str, *, first: int = 0, below: int = _LARGEST) -> Iterator[Row]:
        """Yield the rows of a table, for tasks in order from ``first`` to below ``below``."""
        return (row for _, row in self.numbered(table, first=first, below=below))

    def export(self, table: str, columns: tuple[str, ...], file: IO[str]) -> int:
        """Write a table as CSV with exactly ``columns``; return the number of rows.

        Missing values are empty.
        """
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        count = 0
        for row in self.rows(table):
            writer.writerow([cell(row.get(name)) for name in columns])
            count += 1
        return count


def _opened(path: Path, *, writing: bool) -> sqlite3.Connection:
    """Return a connection to a journal; a writing one excludes all other programs."""
    try:
        database = sqlite3.connect(
            path if writing else f"{path.absolute().as_uri()}?immutable=1",
            uri=not writing,
            isolation_level=None,
            timeout=0.0,
        )
    except sqlite3.Error as error:
        raise InputError(f"'{path}' cannot be opened: {error}; choose another --out") from None
    # Invalid text is found later, by its checksum.
    database.text_factory = lambda text: text.decode(errors="replace")
    if writing:
        try:
            # Two programs that fly the same study would overwrite each other's results.
            database.execute("PRAGMA locking_mode = EXCLUSIVE")
            database.execute("PRAGMA journal_mode = WAL")
            database.execute("PRAGMA synchronous = NORMAL")
            database.execute(_SCHEMA)
        except sqlite3.DatabaseError:
            database.close()
            raise
    return database


def is_full(error: sqlite3.DatabaseError) -> bool:
    """Return whether an error of SQLite says that the disk is full."""
    return _code(error) == sqlite3.SQLITE_FULL


def is_damaged(error: sqlite3.DatabaseError) -> bool:
    """Return whether an error of SQLite says that the file is damaged or not a journal."""
    return _code(error) in (
        sqlite3.SQLITE_CORRUPT,
        sqlite3.SQLITE_NOTADB,
        sqlite3.SQLITE_ERROR,
        sqlite3.SQLITE_MISMATCH,
    )


def unusable(path: Path, error: sqlite3.DatabaseError, *, then: str = CONTINUE) -> InputError:
    """Return the error to raise for a journal that SQLite cannot use; ``then`` ends the remedy."""
    if is_damaged(error):
        return damaged(path)
    return InputError(
        f"'{path}' cannot be used: {error}; make the file and its directory writable, then {then}"
    )


def damaged(path: Path, what: str = "") -> InputError:
    """Return the error to raise for a damaged journal; ``what`` may say what is damaged."""
    return InputError(f"'{path}' is damaged{what}; start a new run in another --out")


def _code(error: sqlite3.DatabaseError) -> int:
    """Return the primary code of an error of SQLite."""
    return int(getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR)) & 0xFF


def _checksum(*fields: object) -> str:
    return hashlib.blake2b(repr(fields).encode(errors="replace"), digest_size=8).hexdigest()


def _is_tables(text: object) -> bool:
    """Return whether a text is JSON with lists of rows by name of table."""
    try:
        tables = json.loads(str(text))
    except (ValueError, RecursionError):
        return False
    return isinstance(tables, dict) and all(
        isinstance(rows, list) and all(isinstance(row, dict) for row in rows)
        for rows in tables.values()
    )
