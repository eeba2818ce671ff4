"""Tables of a run as read from disk: those that were cut or saved otherwise are refused."""

import csv
import os
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from common.columns import Table
from common.text import MARK, from_cell
from reports.errors import ReportError

REMEDY = "repeat the run's command with --resume, which writes the tables anew"
"""What is done about tables that were changed."""

_NAMES = ("flight_id", "trial", "variant", "beside", "confirms")
"""Columns of names, which stay text where they are all digits, in a run that does not say so."""

_TRUTH = ("True", "False", "", "nan", "None")
"""What a column of truth values may hold; of a flight without one it is empty."""

_OTHER_SEPARATORS = (";", "\t")
"""Of a table that a spreadsheet has saved."""

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
