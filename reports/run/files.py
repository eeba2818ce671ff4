"""Files that reports write, and runs that they cannot read."""

import sqlite3
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

from common.files import is_file, write_whole
from common.run_layout import JOURNAL
from reports.errors import ReportError


def refuse_running(directory: Path) -> None:
    """Refuse a run that another program is writing to: it holds the journal locked. Nothing is
    written, not even a lock.

    Raises
    ------
    ReportError : another program is writing to it
    """
    journal = (directory / JOURNAL).absolute()
    if not is_file(journal):
        return
    try:
        with closing(
            sqlite3.connect(f"{journal.as_uri()}?mode=ro", uri=True, timeout=0.0)
        ) as database:
            # Otherwise SQLite would leave an index beside the journal of a program that was killed.
            database.execute("PRAGMA locking_mode = EXCLUSIVE")
            database.execute("SELECT 1 FROM sqlite_master")
    except sqlite3.Error as error:
        # Any other error is no lock: reports do not read the journal.
        if getattr(error, "sqlite_errorcode", None) == sqlite3.SQLITE_BUSY:
            raise ReportError(
                f"another program is writing to '{directory}'; wait until it has ended"
            ) from None


@contextmanager
def damage_named(*directories: Path) -> Iterator[None]:
    """Refuse a run in one line, where reading what it holds fails; of several, one of them.

    Raises
    ------
    ReportError : names the run and what failed
    """
    try:
        yield
    except ReportError:
        raise
    # An empty table of the manifest has no first entry.
    except (LookupError, StopIteration, TypeError, ValueError, AttributeError, OSError) as error:
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        names = " or ".join(f"'{directory}'" for directory in directories)
        raise ReportError(f"{names} is damaged ({what}); run it again in another --out") from None


@contextmanager
def failure_named(what: str) -> Iterator[None]:
    """Refuse in one line what cannot be drawn or written of a run that was read; ``what`` names it.

    Raises
    ------
    ReportError : ``what``, and the reason
    """
    try:
        yield
    except ReportError:
        raise
    except (
        LookupError,
        TypeError,
        ValueError,
        AttributeError,
        ArithmeticError,
        RuntimeError,
    ) as error:
        reason = next(iter(str(error).splitlines()), "") or "no reason given"
        raise ReportError(f"{what}: {type(error).__name__}: {reason}") from error


def written(path: Path, write: Callable[[Path], object]) -> Path:
    """Write a file, whole or not at all, and return its path.

    Raises
    ------
    ReportError : it cannot be written
    """

    def whole(part: Path) -> None:
        write(part)
        if not part.exists():
            raise ReportError(
                f"'{path}': what was to write it wrote no file; an exporter writes to the path that"
                " it is given"
            )

    try:
        if not path.parent.is_dir():
            raise ReportError(
                f"'{path}' cannot be written: there is no directory '{path.parent}'; make it, or"
                " give another path"
            )
        write_whole(path, whole)
    except OSError as error:
        # An error of a library may have no number, and so no text for it.
        reason = error.strerror or next(iter(str(error).splitlines()), "")
        raise ReportError(
            f"'{path}' cannot be written: {reason}; check permissions and space"
        ) from None
    return path
