"""The reader of all tables that users give: AIS reports, winds and logs of sniffers.

A table is text: a head with the names of the columns, perhaps below other lines, and rows.
Separator, decimal mark, encoding, comment lines and a row of units are found automatically, or the
user gives them (``TableFormat``). ``Table.described`` says in one line what was found.

Lines are counted as in an editor, from 1.
"""

import bz2
import codecs
import csv
import gzip
import io
import itertools
import lzma
import math
import re
import zipfile
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, fields
from datetime import UTC, date, datetime
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from common.geodesy import cartesian
from common.text import did_you_mean

Array = npt.NDArray[np.float64]


class TableError(ValueError):
    """A table cannot be read, or only with a format that the caller gives. The message is one
    line.
    """


@dataclass(frozen=True, kw_only=True)
class TableFormat:
    """The format of a table, as far as it is given; an attribute that is None is found
    automatically.

    Attributes
    ----------
    separator : of columns: one mark, or "whitespace"
    decimal : mark of decimals, "." or ","
    encoding : a name that Python knows
    time_format : of dates and times, as in ``datetime.strptime``
    time_unit : of times in numbers: "s", "ms" or "us"
    """

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None
    time_format: str | None = None
    time_unit: str | None = None

    def given(self) -> list[str]:
        """Return the names of the attributes that are not None."""
        return [each.name for each in fields(self) if getattr(self, each.name) is not None]


FOUND = TableFormat()
"""Nothing is given: all is found."""


def table_format(given: Mapping[str, Any]) -> TableFormat:
    """Return the format that a section ``[table]`` gives.

    Raises
    ------
    TableError : it has an unknown key or an unusable value
    """
    known = [each.name for each in fields(TableFormat)]
    for key, value in given.items():
        if key not in known:
            raise TableError(f"table.{key} is not known{did_you_mean(key, known)}")
        if not isinstance(value, str) or not value:
            raise TableError(f"table.{key} is {value!r}; it must be a text")
        if not value.replace("\t", "").isprintable():
            raise TableError(f"table.{key} is {value!r}; it must be a text of one line")
    chosen = TableFormat(**given)
    separator = chosen.separator
    if separator not in (None, "whitespace") and not _is_mark(separator or ""):
        raise TableError(
            f"table.separator is {separator!r}; it must be one mark, as ';', or 'whitespace'"
        )
    if chosen.decimal not in (None, ".", ","):
        raise TableError(f"table.decimal is {chosen.decimal!r}; it must be '.' or ','")
    if chosen.time_unit not in (None, *_TIME_UNITS):
        raise TableError(
            f"table.time_unit is {chosen.time_unit!r}; it must be one of {', '.join(_TIME_UNITS)}"
        )
    if chosen.time_format is not None:
        _check_dated(chosen.time_format)
    if chosen.encoding is not None:
        try:
            # Refuses codecs that do not decode text, too, such as "hex".
            io.TextIOWrapper(io.BytesIO(), encoding=chosen.encoding)
        except (LookupError, UnicodeError):
            raise TableError(f"table.encoding is {chosen.encoding!r}; Python knows none") from None
    return chosen


def _is_mark(separator: str) -> bool:
    """Return whether a text can separate columns and is not part of a number."""
    return len(separator) == 1 and not separator.isalnum() and separator not in "\"'.-+"


def _check_dated(pattern: str) -> None:
    """Raise a TableError for a format of times that has no day, month or year."""
    try:
        days = {datetime(*day, tzinfo=UTC).strftime(pattern) for day in _DAYS}
    except ValueError:
        days = set()
    if "%" not in pattern or len(days) < len(_DAYS):
        raise TableError(
            f"table.time_format is {pattern!r}; it must have year, month and day, as"
            ' "%d.%m.%Y %H:%M:%S"; times of the day, as 12:00:00, need none'
        )


_DAYS = ((2026, 6, 1), (2026, 6, 2), (2026, 7, 1), (2025, 6, 1))
"""Days that a format of times has to tell apart."""


@dataclass(frozen=True, kw_only=True)
class Moments:
    """The times of a table's rows.

    Attributes
    ----------
    seconds : since 1970 in UTC, or since the table's own zero, shape (n,) [s]; NaN where a row has
        none, and where it names a leap second
    dated : whether they are since 1970
    offset : whether the table gives their offset from UTC; times without one are taken as UTC
    leap : number of rows with a leap second
    plain : whether the table has them as numbers of seconds
    numeric : whether the table has them as numbers
    """

    seconds: Array
    dated: bool
    offset: bool
    leap: int = 0
    plain: bool = False
    numeric: bool = False


@dataclass(frozen=True, kw_only=True)
class Table:
    """The cells of a table as text.

    Attributes
    ----------
    names : of the columns as they stand in the head, without blanks around them
    rows : cells without blanks around them, as many as there are names; short rows end empty
    lines : line of the file for each row, shape (n,)
    head_line : line of the head
    units : of columns, by their names, from a row of units or from the head
    format : format by which it was read; an attribute is None only if no column needed it
    decimal_given : whether the decimal mark was given; the other mark then separates thousands
    """

    names: list[str]
    rows: list[list[str]]
    lines: list[int]
    head_line: int
    units: Mapping[str, str]
    format: TableFormat
    decimal_given: bool = False
    _columns: dict[str, int] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        numbers: dict[str, int] = {}
        for number, name in enumerate(self.names):
            numbers.setdefault(name, number)
        object.__setattr__(self, "_columns", numbers)

    def __contains__(self, name: str) -> bool:
        return name in self._columns

    def __len__(self) -> int:
        return len(self.rows)

    def described(self) -> str:
        """Return how the table was read, in one line."""
        separator = _SEPARATOR_NAMES.get(self.format.separator or ",", repr(self.format.separator))
        decimal = "comma" if self.format.decimal == "," else "point"
        head = f", head in line {self.head_line}" if self.head_line > 1 else ""
        return f"separated by {separator}, decimal {decimal}, {self.format.encoding}{head}"

    def column(self, name: str) -> list[str]:
        """Return the cells of a column.

        Raises
        ------
        TableError : two columns have the name
        """
        if self.names.count(name) > 1:
            raise TableError(f"column '{name}' is there twice; rename or remove one")
        number = self._columns[name]
        return [row[number] for row in self.rows]

    def numbers(self, name: str, *, words: bool = False) -> Array:
        """Return a column as numbers, NaN where a cell is empty, shape (n,).

        Parameters
        ----------
        name : of the column
        words : whether words count as NaN, for a table whose rows may have no value

        Raises
        ------
        TableError : a cell is no number, or is infinite
        """
        cells = self.column(name)
        values = self._as_numbers(cells)
        if words:
            return np.where(np.isfinite(values), values, np.nan)
        bad = [i for i in np.flatnonzero(~np.isfinite(values)).tolist() if not _is_empty(cells[i])]
        if bad:
            cell, line = cells[bad[0]], self.lines[bad[0]]
            if np.isinf(values[bad[0]]):
                raise TableError(
                    f"column '{name}' is infinite in row {line}; where it stands for a reading out"
                    " of range, leave the record out from there, or leave the cell empty"
                )
            raise TableError(
                f"column '{name}' has {cell!r} in row {line}; it must hold numbers, or be empty"
                f"{_other_decimal(cell, self.format.decimal)}"
            )
        return values

    def _as_numbers(self, cells: Sequence[str]) -> Array:
        """Return cells as numbers, NaN where a cell is no number, shape (n,)."""
        decimal = self.format.decimal
        other = "." if decimal == "," else ","
        # A column that has the other mark anywhere except at thousands uses it for decimals.
        given = self.decimal_given and all(
            _GROUPED.fullmatch(cell) for cell in cells if other in cell
        )
        return np.array([_number(cell, decimal, given=given) for cell in cells], dtype=np.float64)

    def times(self, name: str, *, day: date | None = None, usual: str = "") -> Moments:
        """Return a column as times.

        Numbers are seconds, or have the unit of ``time_unit`` or of the column. Times from 1979 on
        count since 1970, if the unit is known or their size shows milliseconds or microseconds.
        Times of day belong to ``day``, and continue over midnight. ``usual`` is the format of
        tables of this kind, used if the user gives none.

        Raises
        ------
        TableError : a cell cannot be read
        """
        moments = _times(self, name, day, self.format.time_format or usual)
        if self.format.time_unit and not moments.numeric and len(self):
            raise TableError(
                f"table.time_unit is '{self.format.time_unit}', and times in column '{name}' are no"
                f" numbers, but as {self.column(name)[0]!r}; leave it out"
            )
        return moments

    def dated_times(self, name: str, *, usual: str = "") -> Array:
        """Return a column as times since 1970 in UTC [s]; parameters as in ``times``.

        Raises
        ------
        TableError : a cell cannot be read, or the times have no date
        """
        moments = self.times(name, usual=usual)
        if not moments.dated and len(self):
            raise TableError(
                f"times in column '{name}' have no date, as {self.column(name)[0]!r} (row"
                f" {self.lines[0]}); give dates and times, as 2026-06-01T12:00:00Z, or seconds"
                " since 1970"
            )
        return moments.seconds


_SEPARATOR_NAMES = {
    ",": "commas", ";": "semicolons", "\t": "tabs", "|": "bars", "whitespace": "blanks",
}  # fmt: skip
"""Separators that are looked for, the likeliest first where two fit as well."""

_EMPTY = ("", "nan", "na", "n/a", "n.a.", "#n/a", "#na", "null", "none")
"""Cells without a value, in small letters and without dashes."""

_COMMENT = ("#", "%", "//")
"""How a line begins that is no row."""

_LOOKED_AT = 40
"""Lines by which a table is judged."""

_CONTROL = re.compile(r"[\x00-\x08\x0e-\x1f]")
"""Letters that no text has."""


def _is_empty(cell: str) -> bool:
    """Return whether a cell says that there is no value."""
    return cell.strip("-–—").lower() in _EMPTY


def read_table(
    path: Path,
    given: TableFormat = FOUND,
    *,
    keep: Callable[[str], bool] | None = None,
    head: Sequence[str] = (),
) -> Table:
    """Return the table of a file, which may be compressed.

    Parameters
    ----------
    path : of the file
    given : format of the table, as far as it is known
    keep : test whether to read a line below the head; by default all lines are read. In a day's
        file with millions of lines, the lines of other ships are skipped unread
    head : names of columns, some of which are in the head and not in lines above it

    Raises
    ------
    TableError : the file is not a table in text. The message does not name the file
    OSError : it cannot be opened
    """
    encoding, text = _opened(path, given.encoding)
    with text:
        try:
            return _read(text, given, encoding, keep, head)
        except UnicodeError:
            raise TableError(
                f"not text in {encoding}; save it in UTF-8, or give table.encoding"
            ) from None
        except (EOFError, lzma.LZMAError, gzip.BadGzipFile, zlib.error) as error:
            raise TableError(
                f"cannot be unpacked: {error}; give a whole file, or the table itself"
            ) from None


def _read(
    text: io.TextIOBase,
    given: TableFormat,
    encoding: str,
    keep: Callable[[str], bool] | None,
    head: Sequence[str],
) -> Table:
    lines = enumerate(text, start=1)
    first = [(number, line) for number, line in _some(lines, _LOOKED_AT) if line.strip()]
    if not first:
        raise TableError("empty; it needs a head line and a row per reading")
    if any(_CONTROL.search(line) for _, line in first):
        raise TableError("not a table as text; save it as CSV in UTF-8")
    separator, place = _layout([line for _, line in first], given.separator, head)
    head_line, heading = first[place]
    names = [name.strip("\ufeff \t\r\n\u00a0") for name in _cells(_uncommented(heading), separator)]
    while names and not names[-1]:
        names.pop()
    if not names:
        raise TableError(f"line {head_line} names no columns; the first line has to name them")
    below = [(number, line) for number, line in first[place + 1 :]]
    units = {name: unit for name in names if (unit := unit_in(name))}
    if below and (found := _unit_row(names, below, separator)) is not None:
        units |= found
        below = below[1:]
    rows, numbers = [], []
    for number, line in _chained(below, lines):
        if not line.strip() or line.lstrip().startswith(_COMMENT):
            continue
        if keep is not None and not keep(line):
            continue
        if _CONTROL.search(line):
            raise TableError(
                f"line {number} has a letter that no text has: the file is damaged there;"
                " delete the line"
            )
        cells = [cell.strip() for cell in _cells(line, separator, number)]
        while len(cells) > len(names) and not cells[-1]:
            cells.pop()
        if len(cells) > len(names):
            raise TableError(_long_row(number, cells, names))
        rows.append(cells + [""] * (len(names) - len(cells)))
        numbers.append(number)
    decimal = given.decimal or _decimal(rows, separator)
    return Table(
        names=names,
        rows=rows,
        lines=numbers,
        head_line=head_line,
        units=units,
        format=TableFormat(
            separator=separator,
            decimal=decimal,
            encoding=encoding,
            time_format=given.time_format,
            time_unit=given.time_unit,
        ),
        decimal_given=given.decimal is not None,
    )


def _some(lines: Iterator[tuple[int, str]], most: int) -> Iterator[tuple[int, str]]:
    for _ in range(most):
        following = next(lines, None)
        if following is None:
            return
        yield following


def _chained(
    first: list[tuple[int, str]], rest: Iterator[tuple[int, str]]
) -> Iterator[tuple[int, str]]:
    yield from first
    yield from rest


# The bytes of the file


def _unzipped(path: Path) -> Any:
    archive = zipfile.ZipFile(path)
    names = archive.namelist()
    if len(names) != 1:
        raise TableError(f"{len(names)} files in it; give the table itself")
    return archive.open(names[0])


_PACKED: Mapping[bytes, Callable[[Path], Any]] = {
    b"\x1f\x8b": gzip.open, b"BZh": bz2.open, b"\xfd7zX": lzma.open, b"PK\x03\x04": _unzipped,
}  # fmt: skip
"""How files are unpacked, by how they begin."""


def _opened(path: Path, given: str | None) -> tuple[str, io.TextIOWrapper]:
    """Return a file's encoding and its text, unpacked if it is compressed."""
    with path.open("rb") as file:
        begins = file.read(4)
    # The caller closes the text, and with it the file.
    unpack: Callable[[Path], Any] = next(
        (how for magic, how in _PACKED.items() if begins.startswith(magic)),
        lambda plain: plain.open("rb"),
    )
    try:
        packed = unpack(path)
    except zipfile.BadZipFile as error:
        raise TableError(f"cannot be unpacked: {error}; give a whole file") from None
    raw = (
        io.BufferedReader(packed, 1 << 16) if not isinstance(packed, io.BufferedReader) else packed
    )
    try:
        encoding = given or _encoding(raw.peek(1 << 16))
    except (EOFError, OSError, lzma.LZMAError, zlib.error) as error:
        raise TableError(
            f"cannot be unpacked: {error}; give a whole file, or the table itself"
        ) from None
    return encoding, io.TextIOWrapper(raw, encoding=encoding, newline=None)


def _encoding(begin: bytes) -> str:
    """Return the encoding of a text by its first bytes; a text that is not UTF-8 is taken as
    Latin-1.
    """
    if begin.startswith(codecs.BOM_UTF8):
        return "utf-8-sig"
    if begin.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    if begin and len(begin) > 3:
        # In UTF-16, every second byte of text in Latin letters is 0.
        for start, name in ((1, "utf-16-le"), (0, "utf-16-be")):
            if begin[start::2].count(0) > 0.4 * len(begin):
                return name
    try:
        codecs.getincrementaldecoder("utf-8")().decode(begin)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8"


def _cells(line: str, separator: str, number: int = 0) -> list[str]:
    if separator == "whitespace":
        return line.split()
    _refuse_endless(line, number)
    try:
        return next(csv.reader([line], delimiter=separator, skipinitialspace=True, strict=True), [])
    except csv.Error:
        where = f"the quotation mark in line {number}" if number else "a quotation mark"
        raise TableError(f"{where} is not closed; remove it") from None


def _loose_cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line; quotation marks that are not closed are ignored."""
    if separator == "whitespace":
        return line.split()
    _refuse_endless(line)
    return next(csv.reader([line], delimiter=separator, skipinitialspace=True), [])


def _refuse_endless(line: str, number: int = 0) -> None:
    """Raise a TableError for a line that is longer than the longest cell that csv reads."""
    if len(line) > csv.field_size_limit():
        where = f"line {number}" if number else "a line"
        raise TableError(
            f"{where} has {len(line)} letters, more than {csv.field_size_limit()}; give a file of"
            " one row per line"
        )


def _uncommented(line: str) -> str:
    """Return a head without the mark of a comment, which the Danish Maritime Authority puts
    there.
    """
    return re.sub(r"^\s*(#|%|//)\s*", "", line)


def _layout(lines: list[str], given: str | None, head: Sequence[str]) -> tuple[str, int]:
    """Return the separator, and the index of the head among the first lines.

    Most of the following lines have as many cells as the head; if several separators or heads are
    equally good, the one with more columns is taken. A head with one of the requested names is
    preferred to any other.
    """
    wanted = {name.lower() for name in head}
    best = (-1.0, 0, 0, ",")
    rows = [not line.lstrip().startswith(_COMMENT) for line in lines]
    for separator in [given] if given else list(_SEPARATOR_NAMES):
        cells = [_loose_cells(_uncommented(line), separator) for line in lines]
        for place, names in enumerate(cells):
            count = _filled(names)
            if count < 2:
                continue
            fitting = sum(
                is_row and _fits_head(row, count)
                for is_row, row in zip(rows[place + 1 :], cells[place + 1 :], strict=True)
            )
            named = bool(wanted & {name.strip().lower() for name in names})
            # A comment is taken as the head only if no other line can be the head.
            score = named + (fitting + rows[place] + 0.5) / (sum(rows) + 1.0)
            best = max(best, (score, -place, count, separator), key=lambda of: of[:3])
    if given and best[0] < 0.0:
        raise TableError(
            f"table.separator is {given!r}, which none of the first {len(lines)} lines has; leave"
            " it out, or give the one that the table has"
        )
    return best[3], -best[1]


def _filled(cells: Sequence[str]) -> int:
    """Return the number of cells up to the last one that is not empty."""
    return next((i for i in range(len(cells), 0, -1) if cells[i - 1].strip()), 0)


def _fits_head(row: Sequence[str], count: int) -> bool:
    """Return whether a row has as many cells as the head; separators at its end do not count."""
    return len(row) >= count >= _filled(row)


def _long_row(number: int, cells: Sequence[str], names: Sequence[str]) -> str:
    shown = ",".join(names)
    shown = shown[:60] + "..." * (len(shown) > 60)
    return (
        f"line {number} has {len(cells)} values, more values than the head line has names"
        f" ('{shown}', {len(names)}): the first line has to name every column; remove lines above"
        " it, and write decimals with a point or separate columns by semicolons"
    )


# Numbers

_NUMBER = re.compile(r"[-+−]?(\d[\d.,  ]*|[.,]\d+)(e[-+]?\d+)?", re.IGNORECASE)
_WITH_COMMA = re.compile(r"[-+−]?\d*,\d+(e[-+]?\d+)?", re.IGNORECASE)
_THOUSANDS = re.compile(r"[-+−]?[1-9]\d{0,2}(,\d{3})+")
_DOTTED_THOUSANDS = re.compile(r"[-+−]?\d{1,3}(\.\d{3})+,\d+")
_GROUPED = re.compile(
    r"[-+−]?[1-9]\d{0,2}(?P<mark>[.,'’ \u00a0\u2009\u202f])\d{3}((?P=mark)\d{3})*(?P<rest>[.,]\d+)?"
)
"""A number with a mark between its thousands, the same one throughout."""


def _decimal(rows: Sequence[Sequence[str]], separator: str) -> str:
    """Return the decimal mark: a comma if some numbers have a comma, and none has only a point.

    Raises
    ------
    TableError : every comma might also separate thousands
    """
    commas = points = ambiguous = 0
    for row in rows[: 25 * _LOOKED_AT]:
        for cell in row:
            grouped = _GROUPED.fullmatch(cell)
            if grouped is not None and grouped["mark"] not in ".,":
                commas += (grouped["rest"] or "").startswith(",")
                points += (grouped["rest"] or "").startswith(".")
            elif "," in cell:
                if _DOTTED_THOUSANDS.fullmatch(cell) or (
                    _WITH_COMMA.fullmatch(cell) and not _THOUSANDS.fullmatch(cell)
                ):
                    commas += 1
                elif _THOUSANDS.fullmatch(cell):
                    ambiguous += 1
            elif "." in cell and _NUMBER.fullmatch(cell):
                points += 1
    if commas and not points:
        return ","
    if ambiguous and not points and not commas and separator != ",":
        example = next(cell for row in rows for cell in row if _THOUSANDS.fullmatch(cell))
        raise TableError(
            f"'{example}' may be a decimal or thousands; give table.decimal, ',' or '.'"
        )
    return "."


def _number(cell: str, decimal: str | None, *, given: bool = False) -> float:
    """Return the number in a cell; NaN if it has none.

    ``given`` is whether the mark of decimals was given, and not found: only then a lone group of
    three digits behind the other mark is sure to be of thousands.
    """
    text = cell.replace("−", "-")
    grouped = _GROUPED.fullmatch(text)
    if grouped is not None and _has_thousands(grouped, decimal or ".", given=given):
        text = text.replace(grouped["mark"], "")
    if decimal == "," and _WITH_COMMA.fullmatch(text):
        text = text.replace(",", ".", 1)
    # Python's own numbers may have underscores.
    if "_" in text:
        return np.nan
    try:
        return float(text)
    except ValueError:
        return np.nan


def _has_thousands(grouped: re.Match[str], decimal: str, *, given: bool) -> bool:
    """Return whether the mark between groups of three digits can only separate thousands."""
    mark, rest = grouped["mark"], grouped["rest"]
    if mark == decimal or (rest is not None and rest[0] != decimal):
        return False
    return given or mark not in ".," or rest is not None or grouped[0].count(mark) > 1


def _other_decimal(cell: str, decimal: str | None) -> str:
    """Return the remedy for a number with the other decimal mark; empty for any other text."""
    if decimal == "." and _WITH_COMMA.fullmatch(cell):
        return f"; write decimals with one mark, as in {cell.replace(',', '.')}"
    return ""


# Times

_TIME_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
"""[s]"""

_UNIX_FROM = 3e8
"""Seconds from which on they are since 1970: July 1979, or nine and a half years of a log [s]."""

_BY_SIZE = ((1e14, "us"), (1e11, "ms"))
"""From which on numbers are microseconds or milliseconds since 1970: of seconds the year 5138."""

_COMPACT = 1e13, 1e14
"""Range of dates and times of 14 digits without marks; of milliseconds from the year 2286 on."""

_CLOCK_END = 240_000.0
"""End of a day by a clock without marks, HHMMSS."""

_TIME_OF_DAY = re.compile(r"(\d{1,2}):(\d{2}):(\d{2}([.,]\d+)?)")

_LEAP = re.compile(r":59:60([.,]\d+)?")

_OFFSET = re.compile(r"(Z|[+-]\d{2}:?\d{2})$")

_WITHOUT_DATE_FORMATS = tuple(
    f"{date_format} {clock}"
    for date_format, clock in itertools.product(
        (
            "%d.%m.%Y",
            "%d/%m/%Y",
            "%m/%d/%Y",
            "%d-%m-%Y",
            "%m-%d-%Y",
            "%d.%m.%y",
            "%d/%m/%y",
            "%m/%d/%y",
        ),
        ("%H:%M:%S", "%H:%M:%S.%f", "%H:%M", "%I:%M:%S %p", "%I:%M %p"),
    )
)
"""Formats that an error names where a date fits one of them; only a given format is used."""


def _times(table: Table, name: str, day: date | None, pattern: str) -> Moments:
    import pandas as pd

    cells = table.column(name)
    if not cells:
        return Moments(seconds=np.empty(0), dated=False, offset=False)
    empty = np.array([_is_empty(cell) for cell in cells])
    if pattern:
        try:
            moments = pd.to_datetime(pd.Series(cells), format=pattern, utc=True, errors="coerce")
        except ValueError as error:
            raise TableError(
                f'table.time_format is {pattern!r}: {error}; give one as "%d.%m.%Y %H:%M:%S"'
            ) from None
        example = datetime(2026, 6, 1, 10, tzinfo=UTC).strftime(pattern)
        _refuse_first(table, name, cells, moments.isna().to_numpy() & ~empty, example)
        return Moments(seconds=_since_1970(moments), dated=True, offset="%z" in pattern)
    numbers = table._as_numbers(cells)
    if np.isfinite(numbers).mean() > 0.5:
        _refuse_first(table, name, cells, ~np.isfinite(numbers) & ~empty, "seconds")
        return _numeric_times(table, name, numbers)
    clock = [_TIME_OF_DAY.fullmatch(cell) for cell in cells]
    if sum(match is not None for match in clock) > 0.5 * len(cells):
        return _times_of_day(table, name, cells, day)
    leap = np.array([_LEAP.search(cell) is not None for cell in cells])
    texts = [
        "" if second else cell.replace(",", ".") for cell, second in zip(cells, leap, strict=True)
    ]
    moments = pd.to_datetime(pd.Series(texts), format="ISO8601", utc=True, errors="coerce")
    bad = moments.isna().to_numpy() & ~empty & ~leap
    _refuse_first(table, name, cells, bad, "2024-05-01T12:00:00.0, or seconds")
    first = next((text for text in texts if text), "")
    return Moments(
        seconds=_since_1970(moments),
        dated=True,
        offset=bool(_OFFSET.search(first)) and "T" in first.replace(" ", "T")[8:],
        leap=int(leap.sum()),
    )


def _since_1970(moments: Any) -> Array:
    """Return the seconds since 1970 of times that pandas has read; NaN for times that it could not
    read.
    """
    # Nanoseconds would end in the year 2262, and begin again in 1677.
    whole = moments.to_numpy(dtype="datetime64[us]")
    seconds: Array = whole.astype(np.int64) / 1e6
    return np.where(np.isnat(whole), np.nan, seconds)


def _refuse_first(
    table: Table, name: str, cells: Sequence[str], bad: npt.NDArray[np.bool_], wanted: str
) -> None:
    """Raise a TableError for the first cell that cannot be read."""
    if not bad.any():
        return
    row = int(np.argmax(bad))
    cell = cells[row]
    fitting = [pattern for pattern in _WITHOUT_DATE_FORMATS if _fits(cells, pattern)]
    remedy = f"give {wanted}"
    if fitting and not table.format.time_format:
        remedy = "give its order: " + ", or ".join(f'table.time_format = "{of}"' for of in fitting)
    raise TableError(
        f"time {cell!r} in column '{name}' cannot be read (row {table.lines[row]}); {remedy}"
        f"{_other_decimal(cell, '.')}"
    )


def _fits(cells: Sequence[str], pattern: str) -> bool:
    try:
        for cell in cells:
            datetime.strptime(cell, pattern)
    except ValueError:
        return False
    return True


def _numeric_times(table: Table, name: str, numbers: Array) -> Moments:
    known = numbers[np.isfinite(numbers)]
    least = float(np.min(known))
    unit = table.format.time_unit or _time_unit_in(table, name)
    if unit is None and _COMPACT[0] <= float(known[0]) < _COMPACT[1]:
        raise TableError(
            f"time {known[0]:.0f} in column '{name}' is a date and time without marks; give"
            ' table.time_format = "%Y%m%d%H%M%S", or seconds'
        )
    if unit is None:
        unit, other = (_time_unit_by_size(of) for of in (least, float(np.max(known))))
        # Times since the table's own zero may have any size.
        if unit != other and least >= _UNIX_FROM:
            raise TableError(
                f"times in column '{name}' go from {least:.10g} to {np.max(known):.16g}, {unit} and"
                f" {other} since 1970 by their size; give all in one unit, or table.time_unit"
            )
        _refuse_clock(table, name, numbers)
    seconds = _TIME_UNITS[unit] * numbers
    dated = _TIME_UNITS[unit] * least >= _UNIX_FROM
    return Moments(seconds=seconds, dated=dated, offset=dated, plain=unit == "s", numeric=True)


def _time_unit_by_size(number: float) -> str:
    """Return the unit of a time since 1970, or since the table's own zero, from its size."""
    return next((unit for size, unit in _BY_SIZE if number >= size), "s")


def _time_unit_in(table: Table, name: str) -> str | None:
    """Return the unit of a column of times, from its name or from the row of units."""
    unit = table.units.get(name, "").replace("µ", "u")
    return unit if unit in _TIME_UNITS and unit != "s" else None


def _refuse_clock(table: Table, name: str, time: Array) -> None:
    """Raise a TableError for numbers that are hours, minutes and seconds without marks."""
    in_a_day = (time >= 0.0) & (time < _CLOCK_END)
    if not (in_a_day & (time % 100.0 < 60.0) & (time // 100.0 % 100.0 < 60.0)).all():
        return
    minutes = np.flatnonzero(np.diff(time // 100.0) > 0.0)
    # Seconds may skip 60 to 99 once by chance.
    if len(minutes) >= 2:
        row = int(minutes[0])
        raise TableError(
            f"times in column '{name}' go from {time[row]:.10g} to {time[row + 1]:.10g}"
            f" (row {table.lines[row + 1]}), and similarly at each of {len(minutes)} minutes: they"
            " are hours, minutes and seconds without marks; give seconds, or 12:00:00"
        )


def _times_of_day(table: Table, name: str, cells: Sequence[str], day: date | None) -> Moments:
    """Return times of a day; a clock that goes back by more than half a day has passed midnight."""
    seconds = np.full(len(cells), np.nan)
    leap = 0
    for row, cell in enumerate(cells):
        match = _TIME_OF_DAY.fullmatch(cell)
        if match is None:
            if _is_empty(cell):
                continue
            _refuse_first(table, name, cells, np.arange(len(cells)) == row, "a time of day")
        assert match is not None  # refused above
        hour, minute, second = int(match[1]), int(match[2]), float(match[3].replace(",", "."))
        if second >= 60.0:
            leap += 1
            continue
        seconds[row] = 3600.0 * hour + 60.0 * minute + second
    known = np.flatnonzero(np.isfinite(seconds))
    if len(known):
        back = np.diff(seconds[known]) < -43_200.0
        seconds[known] += 86_400.0 * np.concatenate([[0], np.cumsum(back)])
    if day is None:
        return Moments(seconds=seconds, dated=False, offset=False, leap=leap)
    begin = datetime(day.year, day.month, day.day, tzinfo=UTC).timestamp()
    return Moments(seconds=begin + seconds, dated=True, offset=False, leap=leap)


# Units

_UNIT_IN_BRACKETS = re.compile(r"[\[(]\s*([^\[\]()]+?)\s*[\])]\s*$")
_UNIT_AT_THE_END = re.compile(
    r"_(ppb|ppm|percent|ugm3|mgm3|ngm3|cm3|ms|us|mps|kn|kt|deg)$", re.IGNORECASE
)

MASS_TEMPERATURE_C, MASS_PRESSURE_HPA = 20.0, 1013.25
"""State of the air that masses per volume are of unless another is given: that of Directive
2008/50/EC, annex VI [deg C, hPa]."""

_GAS_CONSTANT = 8.314462618
"""[J/(mol K)]"""

_MOLAR_MASS = {"so2": 64.064, "co2": 44.009, "no": 30.006, "no2": 46.005, "ch4": 16.043}
"""[g/mol]"""

_SPELLINGS = {
    "%": "percent",
    "‰": "permille",
    "ugm3": "ug/m3",
    "mgm3": "mg/m3",
    "ngm3": "ng/m3",
    "cm3": "1/cm3",
    "#/cm3": "1/cm3",
    "mps": "m/s",
}


def unit_in(name: str) -> str:
    """Return the unit in a column's name, as in "SO2 [ppb]", "SO2 (ppb)" or "so2_ppb"; empty if it
    has none.
    """
    found = _UNIT_IN_BRACKETS.search(name) or _UNIT_AT_THE_END.search(name)
    return found[1] if found else ""


def unit_factor(
    unit: str,
    to: str,
    *,
    gas: str = "",
    temperature_c: float = MASS_TEMPERATURE_C,
    pressure_hpa: float = MASS_PRESSURE_HPA,
) -> float:
    """Return the factor that converts a value from one unit to another.

    Parameters
    ----------
    unit, to : such as "ppb", "m s**-1", "m s-1", "meters/second", "ug/m3"; "ppb", "ppm" and "%" are
        mole fractions
    gas : gas of a mass per volume of air, such as "so2"
    temperature_c, pressure_hpa : of the air with such a mass

    Raises
    ------
    TableError : a text is not a unit, or the units are of different quantities
    """
    if unit == to:
        return 1.0
    import pint

    registry = _registry()
    try:
        given, wanted = (
            registry.Quantity(1.0, registry.parse_units(_spelt(of))) for of in (unit, to)
        )
        if given.check("[mass]/[length]**3") and wanted.dimensionless and gas in _MOLAR_MASS:
            kelvin, pascal = temperature_c + 273.15, 100.0 * pressure_hpa
            moles = given.to("g/m**3").magnitude / _MOLAR_MASS[gas]
            share = moles * _GAS_CONSTANT * kelvin / pascal
            given = registry.Quantity(share, "dimensionless")
        # Powers of ten without rounding errors.
        return float(f"{given.to(wanted.units).magnitude:.12g}")
    except pint.DimensionalityError:
        raise TableError(f"'{unit}' is no unit of this quantity, which is in {to}") from None
    except (
        pint.UndefinedUnitError,
        pint.DefinitionSyntaxError,
        TypeError,
        ValueError,
        AttributeError,
    ):
        raise TableError(f"'{unit}' is no unit that is known; give one as in '{to}'") from None


def _spelt(unit: str) -> str:
    """Return a unit as pint reads it, with a mark before powers, as in "m s-1" and "ug/m3"."""
    text = (
        _SPELLINGS.get(unit.strip().lower(), unit.strip()).replace("³", "**3").replace("⁻¹", "**-1")
    )
    return re.sub(r"(?<![\d*])([A-Za-zµ]+)\^?(-?\d+)(?![\d.])", r"\1**\2", text)


_registries: list[Any] = []


def _registry() -> Any:
    """Return the registry of units, made once, because loading it takes half a second."""
    if not _registries:
        import pint

        registry: Any = pint.UnitRegistry()
        registry.define("ppb = 1e-9")
        registry.define("permille = 1e-3")
        _registries.append(registry)
    return _registries[0]


def _unit_row(
    names: Sequence[str], below: Sequence[tuple[int, str]], separator: str
) -> dict[str, str] | None:
    """Return the units of a row of units, or None where the first row below the head has no units.

    Such a row has no number, and the one after it does.
    """
    cells = [cell.strip() for cell in _loose_cells(below[0][1], separator)]
    filled = [cell for cell in cells if cell]
    if not filled or any(_NUMBER.match(cell) for cell in filled) or len(below) < 2:
        return None
    after = [cell.strip() for cell in _loose_cells(below[1][1], separator)]
    if sum(bool(_NUMBER.fullmatch(cell)) for cell in after if cell) < 2 and not any(
        bool(_NUMBER.fullmatch(cell)) for cell in after[1:]
    ):
        return None
    return {
        name: (unit_in(cell) or cell)
        for name, cell in zip(names, cells, strict=False)
        if cell and cell not in ("-", "--")
    }


# Places


def longitude_within(degrees: Array) -> Array:
    """Return longitudes from -180 up to 180, from such longitudes or from 0 to 360 [deg].

    Values beyond both ranges stay unchanged.
    """
    values = np.asarray(degrees, dtype=np.float64)
    return np.where((values >= 180.0) & (values <= 360.0), values - 360.0, values)


MISTAKES: Mapping[str, Callable[[Any, Any], tuple[Any, Any]]] = {
    "latitude and longitude exchanged": lambda latitude, longitude: (longitude, latitude),
    "the other sign of longitude": lambda latitude, longitude: (latitude, -longitude),
    "the other sign of latitude": lambda latitude, longitude: (-latitude, longitude),
    "the other signs of both": lambda latitude, longitude: (-latitude, -longitude),
}
"""Mistakes in places, and what corrects latitude and longitude [deg]."""


class Jump(NamedTuple):
    """A distance between two rows that is too long for the time between them.

    Attributes
    ----------
    before, after : indices of the rows
    distance, seconds : between them [m, s]
    speed_max : fastest that was allowed [m/s]
    number : number of such jumps in the table
    mistake : probable mistake, such as "latitude and longitude exchanged"; without it the later
        place would fit to the earlier one. Empty if no known mistake explains the jump
    """

    before: int
    after: int
    distance: float
    seconds: float
    speed_max: float
    number: int
    mistake: str

    def described(self, lines: Sequence[Any] | npt.NDArray[Any]) -> str:
        """Return the error in words; ``lines`` has the line of the file for each row."""
        more = f" (1 of {self.number} such jumps)" if self.number > 1 else ""
        fits = f"; the two fit together with {self.mistake}" if self.mistake else ""
        return (
            f"the place in row {lines[self.after]:.0f} is {self.distance / 1000.0:,.1f} km from"
            f" that in row {lines[self.before]:.0f}, {self.seconds:g} s earlier, which is faster"
            f" than {self.speed_max:g} m/s{more}{fits}"
        )


def find_jumps(
    time: Array,
    place: Array,
    *,
    speed_max: float,
    error: float,
    degrees: tuple[Array, Array] | None = None,
) -> list[Jump]:
    """Return the jumps of a track: distances between rows that are too long for ``speed_max``.

    Parameters
    ----------
    time : of the rows, rising, shape (n,) [s]
    place : in any metres, on a plane or Earth-fixed, NaN where there is none, shape (n, 2 or 3) [m]
    speed_max : largest speed of ships or aircraft [m/s]
    error : largest error of a place [m]
    degrees : latitude and longitude, shape (n,) each, from which a mistake is recognised [deg]
    """
    rows = np.flatnonzero(np.isfinite(place).all(axis=1))
    # A receiver may be slower than the table: only the first row of a new place counts.
    moved = (np.diff(place[rows], axis=0) != 0.0).any(axis=1)
    rows = rows[np.concatenate([[True], moved])] if len(rows) else rows
    distance = np.linalg.norm(np.diff(place[rows], axis=0), axis=1)
    seconds = np.diff(time[rows])
    reach = speed_max * seconds + error
    too_far = np.flatnonzero(distance > reach).tolist()
    return [
        Jump(
            before=int(rows[i]),
            after=int(rows[i + 1]),
            distance=float(distance[i]),
            seconds=float(seconds[i]),
            speed_max=speed_max,
            number=len(too_far),
            mistake=_mistake(degrees, rows[i], rows[i + 1], reach[i]) if degrees else "",
        )
        for i in too_far
    ]


def _mistake(degrees: tuple[Array, Array], before: int, after: int, reach: float) -> str:
    """Return the mistake that explains why a place is beyond reach [m] of the one before it; empty
    if none does.
    """
    latitude, longitude = (float(values[after]) for values in degrees)
    if not math.isfinite(latitude + longitude):
        return ""
    from_there = cartesian(*(np.radians(values[before]) for values in degrees))
    for mistake, corrected in MISTAKES.items():
        north, east = corrected(latitude, longitude)
        there = cartesian(np.radians(np.float64(north)), np.radians(np.float64(east)))
        if abs(north) <= 90.0 and np.linalg.norm(there - from_there) <= reach:
            return mistake
    return ""


def first_columns(names: Iterable[str], most: int = 12) -> str:
    """Return the names of columns for a message, the first ones of many."""
    return ", ".join(f"'{name}'" for name in list(names)[:most])
