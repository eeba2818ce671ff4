"""Layouts of files of AIS reports, each recognised by its header, and the rows of one vessel in
them.
"""

import csv
import math
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice
from pathlib import Path
from typing import TextIO

from common.text import other_units
from measurement.tables import decimal_commas, other_separator
from scenarios.errors import InputError
from scenarios.world.ais.nmea import nmea_rows
from scenarios.world.ais.rows import AisRow, number_of, seconds_of

_NAMED = 5
"""Vessels of a file that a message names at most."""

_COUNTED = 100_000
"""Rows of a file in which other vessels are looked for, where it has none of the vessel asked for.
"""

_SHOWN = 60
"""Letters of a header that a message quotes at most."""


def _danish_time(text: str) -> float:
    return datetime.strptime(text.strip(), "%d/%m/%Y %H:%M:%S").replace(tzinfo=UTC).timestamp()


@dataclass(frozen=True, slots=True)
class Layout:
    """Columns of a table of reports.

    Attributes
    ----------
    name : of the layout
    columns : heads of time, identity, latitude, longitude, speed [kt] and course [deg], in lower
        case
    seconds : time since 1970 of what the first of them holds [s]
    time : how that is written
    """

    name: str
    columns: tuple[str, ...]
    seconds: Callable[[str], float]
    time: str = "2026-06-01T10:00:00Z"


LAYOUTS = (
    Layout("plain", ("time_utc", "mmsi", "lat_deg", "lon_deg", "sog_kn", "cog_deg"), seconds_of),
    Layout(
        "Danish Maritime Authority",
        ("timestamp", "mmsi", "latitude", "longitude", "sog", "cog"),
        _danish_time,
        "01/06/2026 10:00:00",
    ),
    Layout(
        "Marine Cadastre up to 2024",
        ("basedatetime", "mmsi", "lat", "lon", "sog", "cog"),
        seconds_of,
    ),
    Layout(
        "Marine Cadastre from 2025",
        ("base_date_time", "mmsi", "latitude", "longitude", "sog", "cog"),
        seconds_of,
    ),
)
"""The project's own; that of the Danish Maritime Authority ("# Timestamp,Type of mobile,MMSI,...");
and those of NOAA's Marine Cadastre ("MMSI,BaseDateTime,LAT,LON,...", and
"mmsi,base_date_time,longitude,latitude,...")."""


def rows_of(path: Path, mmsi: int | None) -> tuple[int, list[AisRow]]:
    """Return the vessel's identity and its rows, in the order of the file.

    Parameters
    ----------
    path : of a table with one of ``LAYOUTS``, or of NMEA sentences
    mmsi : of the vessel; may be left out where the file has one vessel alone

    Raises
    ------
    InputError : the file cannot be read, its layout is unknown, or it has no rows of the vessel
    """
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            found = _of_one(path, mmsi, _all_rows(path, file, mmsi))
            if found is None:
                file.seek(0)
                lines = list(islice((line for line in file if line.strip()), 2))
                if len(lines) == 1 and "!AI" not in lines[0]:
                    raise InputError(
                        f"{path}: it has a header, and no rows below it; give a file of AIS reports"
                    )
                file.seek(0)
                raise _no_row(path, mmsi, islice(_all_rows(path, file, None), _COUNTED))
            return found
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; check the path") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(
            f"{path}: not a table or NMEA sentences as text ({error}); unpack it, or save it in UTF-8"
        ) from None


def _all_rows(path: Path, file: TextIO, mmsi: int | None) -> Iterator[tuple[int, AisRow]]:
    above, head = next(((above, line) for above, line in enumerate(file) if line.strip()), (0, ""))
    if not head:
        raise InputError(f"{path}: the file is empty; give a file of AIS reports")
    if "!AI" in head or path.suffix.lower() == ".nmea":
        file.seek(0)
        return nmea_rows(file, path)
    return _table_rows(path, above + 1, head, file, mmsi)


def _table_rows(
    path: Path, first: int, head: str, file: TextIO, mmsi: int | None
) -> Iterator[tuple[int, AisRow]]:
    """Return the rows below a header, which stands in line ``first``."""
    heads = [name.strip().removeprefix("#").strip().lower() for name in next(csv.reader([head]))]
    layout = next((layout for layout in LAYOUTS if set(layout.columns) <= set(heads)), None)
    if layout is None:
        if words := other_separator(head):
            raise InputError(f"{path} {words}")
        plain = LAYOUTS[0].columns
        remedy = other_units(heads, plain) or "rename the columns to these"
        raise InputError(
            f"{path}, line {first}: the header is {head.strip()[:_SHOWN]!r}; known are those of the Danish Maritime Authority and"
            f" of Marine Cadastre, and {','.join(plain)}: {remedy}"
        )
    if twice := [column for column in layout.columns if heads.count(column) > 1]:
        raise InputError(
            f"{path}, line {first}: the header has '{twice[0]}' twice; leave one of the columns out"
        )
    places = [heads.index(column) for column in layout.columns]
    identifier = "" if mmsi is None else str(mmsi)
    # Files of a day have millions of lines: those of other vessels are passed over as they are.
    lines = (
        (number, line) for number, line in enumerate(file, start=first + 1) if identifier in line
    )
    for number, line in lines:
        cells = next(csv.reader([line]), [])
        if words := decimal_commas(cells, heads, places[2:]):
            raise InputError(f"{path}, line {number} {words}")
        # What a row that is cut off does not have it does not say.
        time, identity, *others = (cells[place] if place < len(cells) else "" for place in places)
        # Tables that had a gap in this column have whole numbers with decimals.
        identity = identity.strip().removesuffix(".0")
        if not identity.isdigit():
            continue
        try:
            seconds = layout.seconds(time) if places[0] < len(cells) else math.nan
        except ValueError:
            raise InputError(
                f"{path}, line {number}: {time[:40]!r} is no time of the layout {layout.name}, as in {layout.time}; correct it, or"
                " delete the line"
            ) from None
        yield int(identity), AisRow(number, seconds, *map(number_of, others))


def _of_one(
    path: Path, mmsi: int | None, rows: Iterable[tuple[int, AisRow]]
) -> tuple[int, list[AisRow]] | None:
    """Return the rows of the given vessel, or of the only one; an empty list if there are none."""
    found: list[AisRow] = []
    counts: Counter[int] = Counter()
    for identity, row in rows:
        counts[identity] += 1
        if mmsi is None or identity == mmsi:
            found.append(row)
    if mmsi is None and len(counts) > 1:
        raise InputError(
            f"{path}: it has {len(counts)} vessels, {_most(counts)}; name one of them by its MMSI (vessel.mmsi)"
        )
    if not found:
        return None
    return mmsi if mmsi is not None else next(iter(counts)), found


def _no_row(path: Path, mmsi: int | None, rows: Iterable[tuple[int, AisRow]]) -> InputError:
    """Return what says that the file has no row of the vessel, and whose rows it has."""
    counts = Counter(identity for identity, _ in rows)
    if not counts:
        return InputError(
            f"{path}: no row has an MMSI in digits, as 219999001, in the column of its name; give a file of AIS reports"
        )
    return InputError(
        f"{path}: no row of MMSI {mmsi}; it has {_most(counts)}: check the number (vessel.mmsi)"
    )


def _most(counts: Counter[int]) -> str:
    named = ", ".join(
        f"{identity} ({rows} row{'s' * (rows > 1)})"
        for identity, rows in counts.most_common(_NAMED)
    )
    return f"{named}, ..." if len(counts) > _NAMED else named
