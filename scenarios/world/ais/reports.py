"""Reports of one vessel from a file: a table in one of the known layouts, or NMEA sentences as
received (``!AIVDM,...``, decoded by pyais). Unusable rows are left out and counted.
"""

import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from itertools import islice, pairwise
from numbers import Integral
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from common.geodesy import cartesian
from common.physics import METRES_PER_SECOND_PER_KNOT
from common.tables import (
    FOUND,
    Jump,
    Table,
    TableError,
    TableFormat,
    find_jumps,
    longitude_within,
    read_table,
    table_format,
)
from common.text import other_units
from scenarios.errors import InputError
from scenarios.scenario.sections.world import GAP_MAX
from scenarios.world.ais.sentences import (
    MILLISECONDS_FROM,
    POSITION_REPORTS,
    SENTENCE,
    TAG_TIME,
    SentenceDecoder,
)
from scenarios.world.ais.size import SIZE_COLUMNS, ShipSize, ship_size, size_of_all


class AisRow(NamedTuple):
    """A report as in its file; NaN for missing values.

    Attributes
    ----------
    line : of the file, from 1
    time : since 1970 in UTC [s]
    latitude, longitude : [deg]
    speed, course : over the ground, course from true north [kt, deg]
    """

    line: int
    time: float
    latitude: float
    longitude: float
    speed: float
    course: float


Array = npt.NDArray[np.float64]

_SPEED_MAX_KN = 102.2
"""Largest speed in a report; 102.3 means "not available" (ITU-R M.1371-5, table 48) [kt]."""

_AT_REST_KN = 0.5
"""Speed below which a report needs no course: a vessel at rest has none [kt]."""

_REACH_SPEED, _REACH = 50.0, 500.0
"""Largest distance of a report from its neighbours: speed of the fastest vessel, and error of
satellite navigation [m/s, m].
"""

_IMPOSSIBLE_SPEED = 60.0
"""Speed that no vessel reaches and that no report can contain (102.2 kt are 52.6 m/s) [m/s]."""

NO_TIME, NO_PLACE, NO_SPEED, DUPLICATE, OUT_OF_ORDER, OUT_OF_REACH = (
    "without a time",
    "without a possible position",
    "without speed or course",
    "with the time of another",
    "out of order",
    "out of reach of others",
)
"""Reasons why rows are not used."""

_DROPPED_MOST = 0.1
"""Share of a vessel's rows that may be dropped without a warning; duplicates do not count."""

_METRES_PER_DEGREE = 111_195.0
"""Length of a degree of latitude, on a sphere."""

_HOUR = 3600.0
"""[s]"""

_ALONE = 3600.0
"""Least time to the nearest report of a vessel that suggests a wrong clock [s]."""

_SECTORS, _SECTOR_ROWS = 12, 3
"""Number of sectors of the direction of travel, and number of dropped rows in a sector that is no
chance.
"""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AisReports:
    """Reports of one vessel, in the order of their times.

    Attributes
    ----------
    path, mmsi : the file, and the vessel's identity
    read : how the file was read, in words
    line : of the file, from 1
    time : since 1970 in UTC [s]
    latitude, longitude : [rad]
    speed, course : over the ground, course from true north [m/s, rad]
    rows : of the vessel in the file
    dropped : number of unusable rows, by the reason
    size : of the vessel, where the file has it
    size_remark : values of the size in the file that are not used, or that other rows contradict
    lost_directions : directions of travel [deg], by sectors, whose rows were all dropped
    """

    path: Path
    mmsi: int
    read: str
    line: Array
    time: Array
    latitude: Array
    longitude: Array
    speed: Array
    course: Array
    rows: int
    dropped: dict[str, int]
    size: ShipSize | None = None
    size_remark: str = ""
    lost_directions: tuple[int, ...] = ()

    @property
    def warning(self) -> str:
        """Warning to the reader of results about dropped reports; empty without one."""
        if self.lost_directions:
            towards = ", ".join(f"{course} deg" for course in self.lost_directions)
            return (
                f"{self.path.name}: all reports of MMSI {self.mmsi} on the way towards {towards}"
                " were dropped: its track there is not known"
            )
        lost = sum(count for why, count in self.dropped.items() if why != DUPLICATE)
        share = lost / self.rows
        if share <= _DROPPED_MOST:
            return ""
        return f"{self.path.name}: {share:.0%} of the reports of MMSI {self.mmsi} were dropped"

    def jumps(self, part: slice = slice(None)) -> list[Jump]:
        """Return the ways between neighbouring reports that are too long for any vessel."""
        return _jumps(
            self.time[part],
            np.degrees(self.latitude[part]),
            np.degrees(self.longitude[part]),
        )

    def lines(self) -> list[str]:
        """Return the file's lines for a console: how it was used, and a warning if there is one."""
        return [self.described(), *([f"warning: {self.warning}"] if self.warning else [])]

    def record(self) -> dict[str, Any]:
        """Return a record for JSON: how the file was used, and the ship's size where the file has
        it.
        """
        return {
            "read": self.read,
            "rows": self.rows,
            "used": len(self.time),
            "dropped": self.dropped,
            "warning": self.warning,
            "size": asdict(self.size) if self.size else None,
            "size_remark": self.size_remark,
        }

    def described(self) -> str:
        """Return how many rows were used and dropped, and how the file was read, in a line."""
        dropped = ", ".join(f"{count} {why}" for why, count in self.dropped.items())
        used = f"{self.path.name}: {len(self.time)} of {self.rows} rows of MMSI {self.mmsi} used"
        described = self.size.described() if self.size else ""
        size = "; ".join(filter(None, [described, self.size_remark]))
        return "; ".join(filter(None, [used, size, dropped and f"dropped: {dropped}", self.read]))


def read_ais(path: str | Path, mmsi: int | None = None, **table: str) -> AisReports:
    """Read the reports of one vessel.

    Parameters
    ----------
    path : of a table in one of the known layouts, or of NMEA sentences (docs/howto/ais_and_wind.md)
    mmsi : of the vessel; may be left out where the file has only one vessel
    table : format of a table, where it is not found automatically: ``separator``, ``decimal``,
        ``encoding``, ``time_format``, ``time_unit``, as in a section ``[table]``

    Raises
    ------
    InputError : as in ``read_reports``, or ``table`` has an unknown key or an unusable value
    """
    try:
        return read_reports(path, mmsi, table_format(table))
    except TableError as error:
        raise InputError(f"{path}: {error}") from None


def read_reports(path: str | Path, mmsi: int | None, written: TableFormat) -> AisReports:
    """Read the reports of one vessel.

    Parameters
    ----------
    path, mmsi : as in ``read_ais``
    written : how a table is written, as far as it is given

    Raises
    ------
    InputError : the file cannot be read, its layout is unknown, fewer than two rows of the vessel
        are usable, or its units are wrong; or ``mmsi`` is not a whole number
    """
    path = Path(path)
    if mmsi is not None and (isinstance(mmsi, bool) or not isinstance(mmsi, Integral)):
        raise InputError(f"{path}: mmsi is {mmsi!r}; give a whole number, as in mmsi=219999001")
    identity, rows, sizes, read = rows_of(path, mmsi, written)
    found = _sorted_out(rows)
    kept, dropped = found.kept, found.dropped
    if len(kept) < 2:
        why = ", ".join(
            f"{count} {reason} (first in line {found.first[reason]})"
            for reason, count in dropped.items()
        )
        jumps = _jumps_of_rows(found.placed)
        if jumps:
            why += f"; {jumps[0].described([row.line for row in found.placed])}"
        raise InputError(
            f"{path}: {len(kept)} of {len(rows)} rows of MMSI {identity} used, two are"
            f" needed;{f' dropped: {why};' if why else ''} correct the rows, or give another file"
        )
    reports = _reports(path, identity, rows, found, sizes, read)
    mistaken = [jump for jump in reports.jumps() if jump.mistake]
    if mistaken:
        raise InputError(
            f"{path}: {mistaken[0].described(reports.line)}: correct the rows that are wrong, or"
            " remove them"
        )
    check_units(
        path, reports.time, reports.latitude, reports.longitude, reports.speed, reports.course
    )
    return reports


def read_others(
    path: str | Path,
    *,
    without: int | None,
    only: int | None,
    begin: float,
    end: float,
    written: TableFormat = FOUND,
) -> list[AisReports]:
    """Read the reports of all vessels of a file but one, between two times.

    Unusable rows are left out, and so are vessels with fewer than two usable rows, and vessels
    whose neighbouring reports are too far apart for any vessel, such as two that share an MMSI.

    Parameters
    ----------
    path : of the file, as in ``read_ais``
    without, only : MMSI of a vessel that is left out; or of the only one that is read
    begin, end : of the time, since 1970 [s]
    written : how a table is written, as far as it is given

    Raises
    ------
    InputError : the file cannot be read, or its layout is unknown
    """
    path = Path(path)
    rows: dict[int, list[AisRow]] = {}
    sizes: dict[int, list[tuple[ShipSize, str]]] = {}
    with _refusing(path):
        contents = (
            _contents(path, only, written, _may_be_within(begin, end))
            if written.time_format is None
            else _contents(path, only, written)
        )
        for said in contents.said:
            if said.mmsi == without or (only is not None and said.mmsi != only):
                continue
            if said.size is not None:
                sizes.setdefault(said.mmsi, []).append(said.size)
            if said.row is not None and begin <= said.row.time <= end:
                rows.setdefault(said.mmsi, []).append(said.row)
    others = []
    for mmsi, of_vessel in sorted(rows.items()):
        found = _sorted_out(of_vessel)
        if len(found.kept) > 1:
            reports = _reports(path, mmsi, of_vessel, found, sizes.get(mmsi, []), contents.read)
            if not reports.jumps():
                others.append(reports)
    return others


_HOUR_OF_DAY = re.compile(
    r"(?:(\d{4})-(\d\d)-(\d\d)[ T]|(\d\d)/(\d\d)/(\d{4}) )(\d\d):[\d:.]*\s*([+-]\d)?"
)
"""Date and hour in the known layouts, and the text after them where an offset to UTC is given."""


def _may_be_within(begin: float, end: float) -> Callable[[str], bool]:
    """Return a test that lets a line of a table pass unless its only time is in UTC, and in an hour
    that is not between two times, since 1970 [s].
    """
    hours = set()
    hour = math.floor(begin / _HOUR)
    while hour * _HOUR <= end:
        hours.add(f"{datetime.fromtimestamp(hour * _HOUR, UTC):%Y%m%d%H}")
        hour += 1

    def test(line: str) -> bool:
        found = _HOUR_OF_DAY.findall(line)
        if len(found) != 1:
            return True
        year, month, day, day_first, month_second, year_last, hour_of_day, offset = found[0]
        date = year + month + day or year_last + month_second + day_first
        return bool(offset) or date + hour_of_day in hours

    return test


class _SortedOut(NamedTuple):
    """Rows of a vessel after the selection: the usable rows in the order of their times, the rows
    with a possible place, the number of dropped rows by the reason, and the first line of each
    reason.
    """

    kept: list[AisRow]
    placed: list[AisRow]
    dropped: dict[str, int]
    first: dict[str, int]


def _sorted_out(rows: list[AisRow]) -> _SortedOut:
    """Return the usable rows of a vessel."""
    dropped: Counter[str] = Counter()
    first: dict[str, int] = {}
    kept = placed = rows
    for sorted_out in (why_unused, _by_their_clock, _by_their_times, _by_their_places):
        reasons = sorted_out(kept)
        placed = kept
        for row, reason in zip(kept, reasons, strict=True):
            if reason:
                dropped[reason] += 1
                first.setdefault(reason, row.line)
        kept = [row for row, reason in zip(kept, reasons, strict=True) if not reason]
        if sorted_out is _by_their_clock:
            kept.sort(key=lambda row: row.time)
    return _SortedOut(kept, placed, dict(dropped), first)


def _reports(
    path: Path,
    mmsi: int,
    rows: Sequence[AisRow],
    found: _SortedOut,
    sizes: Sequence[tuple[ShipSize, str]],
    read: str,
) -> AisReports:
    """Return the reports of a vessel of a file from its rows and its usable rows."""
    size, size_remark = size_of_all(sizes)
    columns = np.array(found.kept).T
    directed = np.isfinite(columns[5]) & (columns[5] < 360.0)
    return AisReports(
        path=path,
        mmsi=mmsi,
        read=read,
        line=columns[0],
        time=columns[1],
        latitude=np.radians(columns[2]),
        longitude=np.radians(columns[3]),
        # A speed without a course is almost 0, and has no direction.
        speed=METRES_PER_SECOND_PER_KNOT * np.where(directed, columns[4], 0.0),
        course=np.radians(np.where(directed, columns[5], 0.0)),
        rows=len(rows),
        dropped=found.dropped,
        size=size,
        size_remark=size_remark,
        lost_directions=_lost_directions(rows, found.kept),
    )


def why_unused(rows: Sequence[AisRow]) -> list[str]:
    """Return why each row is unusable by its values; empty for a usable one. In ITU-R M.1371-5, 91,
    181, 102.3 and 360 mean "not available".
    """
    reasons = []
    for row in rows:
        place = abs(row.latitude) <= 90.0 and abs(row.longitude) <= 180.0
        speed = 0.0 <= row.speed <= _SPEED_MAX_KN and (
            0.0 <= row.course < 360.0 or row.speed < _AT_REST_KN
        )
        timed = not math.isnan(row.time)
        reasons.append(
            NO_TIME if not timed else NO_PLACE if not place else NO_SPEED if not speed else ""
        )
    return reasons


def _by_their_clock(rows: Sequence[AisRow]) -> list[str]:
    """Return why each row is unusable by its clock: its time is far from all others, although it
    stands among them in the file.
    """
    lines = {row.line for row in rows}
    ends = (min(lines), max(lines)) if lines else ()
    by_time = sorted(rows, key=lambda row: row.time)
    alone = set()
    for run in (by_time, by_time[::-1]):
        for row, following in pairwise(run):
            if abs(following.time - row.time) <= _ALONE or row.line in ends:
                break
            alone.add(row.line)
    return [OUT_OF_ORDER if row.line in alone else "" for row in rows]


def _by_their_times(rows: Sequence[AisRow]) -> list[str]:
    """Return why each row is unusable by its time: the first of several rows at the same time is
    kept.
    """
    return [
        DUPLICATE if number and row.time == rows[number - 1].time else ""
        for number, row in enumerate(rows)
    ]


def _lost_directions(rows: Sequence[AisRow], kept: Sequence[AisRow]) -> tuple[int, ...]:
    """Return the directions of travel whose rows were all dropped [deg].

    The direction is that of the way to the next place; the course in the row does not count.
    """
    used = {row.line for row in kept}
    taken: Counter[int] = Counter()
    lost: Counter[int] = Counter()
    timed = sorted((row for row in rows if math.isfinite(row.time)), key=lambda row: row.time)
    placed = [row for row in timed if abs(row.latitude) <= 90.0 and abs(row.longitude) <= 180.0]
    for row, after in pairwise(placed):
        north = after.latitude - row.latitude
        east = (after.longitude - row.longitude) * math.cos(math.radians(row.latitude))
        if math.hypot(north, east) > _WAY_MIN / _METRES_PER_DEGREE:
            course = math.degrees(math.atan2(east, north)) % 360.0
            sector = round(course * _SECTORS / 360.0) % _SECTORS
            (taken if row.line in used else lost)[sector] += 1
    return tuple(
        sector * 360 // _SECTORS
        for sector, count in sorted(lost.items())
        if count >= _SECTOR_ROWS and not taken[sector]
    )


def _by_their_places(rows: Sequence[AisRow]) -> list[str]:
    """Return why each row is unusable by its place: a vessel could not have come from the row
    before, nor reached the next.
    """
    _, time, latitude, longitude, _, _ = (
        (np.array(column) for column in zip(*rows, strict=True)) if rows else np.empty((6, 0))
    )
    apart = np.linalg.norm(
        np.diff(cartesian(np.radians(latitude), np.radians(longitude)), axis=0), axis=-1
    )
    near = (apart <= _REACH + _REACH_SPEED * np.diff(time)).tolist()
    if len(near) < 2:
        return [""] * len(rows)
    # At an end the only neighbour decides, if that one fits its other neighbour.
    alone = [
        not near[0] and near[1],
        *(not (before or after) for before, after in pairwise(near)),
        not near[-1] and near[-2],
    ]
    return [OUT_OF_REACH if row_alone else "" for row_alone in alone]


def _jumps(time: Array, latitude: Array, longitude: Array) -> list[Jump]:
    """Return the jumps of a track of places [deg]."""
    return find_jumps(
        time,
        cartesian(np.radians(latitude), np.radians(longitude)),
        speed_max=_IMPOSSIBLE_SPEED,
        error=_REACH,
        degrees=(latitude, longitude),
    )


def _jumps_of_rows(rows: Sequence[AisRow]) -> list[Jump]:
    if not rows:
        return []
    _, time, latitude, longitude, _, _ = (np.array(column) for column in zip(*rows, strict=True))
    return _jumps(time, latitude, longitude)


_NAMED = 5
"""Largest number of vessels of a file in a message."""

_COUNTED = 100_000
"""Number of rows of a file in which other vessels are searched for, where it has no rows of the
requested vessel.
"""

_SHOWN = 60
"""Largest number of letters of a header in a message."""


_LOOKED_AT = 200
"""Number of lines of a file in which a sentence of AIS is searched for."""

_SIGNED_SPEED, _SIGNED_COURSE = 102.4, 409.6
"""Correction of negative speeds and courses in Marine Cadastre's files of 2015 to 2017: their ten
and twelve bits were read as signed numbers [kt, deg]."""


@dataclass(frozen=True, slots=True)
class Layout:
    """Columns of a table of reports.

    Attributes
    ----------
    name : of the layout
    columns : heads of time, identity, latitude, longitude, speed [kt] and course [deg], in lower
        case
    time_format : of the first of them, empty for ISO 8601
    signed : whether speeds and courses may have been read as signed numbers
    """

    name: str
    columns: tuple[str, ...]
    time_format: str = ""
    signed: bool = False


LAYOUTS = (
    Layout("plain", ("time_utc", "mmsi", "lat_deg", "lon_deg", "sog_kn", "cog_deg")),
    Layout(
        "Danish Maritime Authority",
        ("timestamp", "mmsi", "latitude", "longitude", "sog", "cog"),
        "%d/%m/%Y %H:%M:%S",
    ),
    Layout(
        "Marine Cadastre up to 2024",
        ("basedatetime", "mmsi", "lat", "lon", "sog", "cog"),
        signed=True,
    ),
    Layout(
        "Marine Cadastre from 2025",
        ("base_date_time", "mmsi", "latitude", "longitude", "sog", "cog"),
    ),
)
"""The project's own; that of the Danish Maritime Authority ("# Timestamp,Type of mobile,MMSI,...");
and those of NOAA's Marine Cadastre ("MMSI,BaseDateTime,LAT,LON,...", and
"mmsi,base_date_time,longitude,latitude,...")."""


class _Said(NamedTuple):
    """A vessel's data in a line of a file: a report, its size, or both."""

    mmsi: int
    row: AisRow | None = None
    size: tuple[ShipSize, str] | None = None


class _Contents(NamedTuple):
    """The data of vessels in a file.

    Attributes
    ----------
    read : how it was read, in words
    said : in the order of the file; not all rows of other vessels than the requested one
    """

    read: str
    said: Iterable[_Said]


@contextmanager
def _refusing(path: Path) -> Iterator[None]:
    """Refuse a file that cannot be read as an InputError, with its name."""
    try:
        yield
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}; check the path") from None
    except TableError as error:
        raise InputError(f"{path}: {error}") from None


def _contents(
    path: Path,
    mmsi: int | None,
    written: TableFormat,
    of_use: Callable[[str], bool] = bool,
) -> _Contents:
    """Return the contents of a file; unusable lines of a table may be left out.

    Raises
    ------
    InputError, TableError : its layout is unknown, or it is not a table in the format of
        ``written``
    OSError : it cannot be opened
    """
    with path.open("rb") as file:
        begin = b"".join(islice(file, _LOOKED_AT))
    if not begin.strip():
        raise InputError(f"{path}: the file is empty; give a file of AIS reports")
    # Regardless of the file's name, and of the lines of other receivers above the first report.
    if SENTENCE.search(begin.decode("latin-1")) or path.suffix.lower() == ".nmea":
        if given := written.given():
            raise InputError(
                f"{path}: table.{given[0]} is given, and the file has NMEA sentences and no table;"
                " leave it out, or name another table in table.file"
            )
        return _Contents("NMEA sentences", _from_sentences(path))
    return _from_table(path, mmsi, written, of_use)


def _from_table(
    path: Path, mmsi: int | None, written: TableFormat, of_use: Callable[[str], bool]
) -> _Contents:
    identifier = "" if mmsi is None else str(mmsi)
    names = [name for layout in LAYOUTS for name in layout.columns]

    def keep(line: str) -> bool:
        return identifier in line and of_use(line)

    # Files of a day have millions of lines: those of other vessels, or of another time, are skipped
    # unread.
    table = read_table(path, written, head=names, keep=keep)
    heads = {name.lower(): name for name in reversed(table.names)}
    layout = next((layout for layout in LAYOUTS if set(layout.columns) <= set(heads)), None)
    if layout is None:
        plain = LAYOUTS[0].columns
        remedy = other_units(heads, plain) or "rename the columns to these"
        raise InputError(
            f"{path}, line {table.head_line}: the header is {','.join(table.names)[:_SHOWN]!r};"
            " known are those of the Danish Maritime Authority and of Marine Cadastre, and"
            f" {','.join(plain)}: {remedy}"
        )
    lower = [name.lower() for name in table.names]
    if twice := [column for column in layout.columns if lower.count(column) > 1]:
        raise InputError(
            f"{path}, line {table.head_line}: the header has '{twice[0]}' twice; leave one of the"
            " columns out"
        )
    time, identities, *others = (heads[column] for column in layout.columns)
    latitude, longitude, speed, course = (table.numbers(name, words=True) for name in others)
    if layout.signed:
        speed = np.where(speed < 0.0, speed + _SIGNED_SPEED, speed)
        course = np.where(course < 0.0, course + _SIGNED_COURSE, course)
    seconds = table.dated_times(time, usual=layout.time_format)
    columns = seconds, latitude, longitude_within(longitude), speed, course
    said = _said_by_rows(table, identities, columns, _sizes(table, heads))
    return _Contents(table.described(), said)


def _said_by_rows(
    table: Table,
    identities: str,
    columns: Sequence[Array],
    size_of: Callable[[int], tuple[ShipSize, str] | None],
) -> Iterator[_Said]:
    """Yield the contents of a table's rows: identities under the names of their columns, and the
    columns of a report as numbers.
    """
    for number, (line, identity) in enumerate(
        zip(table.lines, table.column(identities), strict=True)
    ):
        # Tables that had a gap in this column have whole numbers with decimals.
        digits = identity.removesuffix(".0")
        if digits.isdigit():
            row = AisRow(line, *(float(column[number]) for column in columns))
            yield _Said(int(digits), row, size_of(number))


def _sizes(table: Table, heads: Mapping[str, str]) -> Callable[[int], tuple[ShipSize, str] | None]:
    """Return the size in each row of a table, by the row's number."""
    known = {
        dimension: table.numbers(heads[name], words=True)
        for dimension, names in SIZE_COLUMNS.items()
        if (name := next((name for name in names if name in heads), None))
    }
    if not known:
        return lambda _: None
    return lambda number: ship_size(**{key: float(of[number]) for key, of in known.items()})


class VesselRows(NamedTuple):
    """The rows of one vessel in a file.

    Attributes
    ----------
    identity : its MMSI
    rows : in the order of the file
    sizes : of the vessel, one for each row that has it
    read : how the file was read, in words
    """

    identity: int
    rows: list[AisRow]
    sizes: list[tuple[ShipSize, str]]
    read: str


def rows_of(path: Path, mmsi: int | None, written: TableFormat) -> VesselRows:
    """Return the rows of a vessel.

    Parameters
    ----------
    path : of a table with one of ``LAYOUTS``, or of NMEA sentences
    mmsi : of the vessel; may be left out where the file has only one vessel
    written : how a table is written, as far as it is given

    Raises
    ------
    InputError : the file cannot be read, its layout is unknown, or it has no rows of the vessel
    """
    found: list[AisRow] = []
    counts: Counter[int] = Counter()
    sizes: dict[int, list[tuple[ShipSize, str]]] = {}
    with _refusing(path):
        contents = _contents(path, mmsi, written)
        for said in contents.said:
            if said.size is not None:
                sizes.setdefault(said.mmsi, []).append(said.size)
            if said.row is not None:
                counts[said.mmsi] += 1
                if mmsi is None or said.mmsi == mmsi:
                    found.append(said.row)
    if mmsi is None and len(counts) > 1:
        raise InputError(
            f"{path}: it has {len(counts)} vessels, {_most(counts)}; name one of them by its MMSI"
            " (vessel.mmsi; --mmsi of an estimate)"
        )
    if not found:
        raise _no_row(path, mmsi, written)
    identity = mmsi if mmsi is not None else next(iter(counts))
    return VesselRows(identity, found, sizes.get(identity, []), contents.read)


def _no_row(path: Path, mmsi: int | None, written: TableFormat) -> InputError:
    """Return the error that the file has no row of the vessel, with the vessels that it has."""
    with _refusing(path):
        said = islice(_contents(path, None, written).said, _COUNTED)
        counts = Counter(of.mmsi for of in said if of.row is not None)
    if counts:
        return InputError(
            f"{path}: no row of MMSI {mmsi}; it has {_most(counts)}: check the number"
            " (vessel.mmsi; --mmsi of an estimate)"
        )
    return InputError(
        f"{path}: no row below the header has an MMSI in digits, as 219999001, in the column of its"
        " name; give a file of AIS reports"
    )


def _most(counts: Counter[int]) -> str:
    named = ", ".join(
        f"{identity} ({rows} row{'s' * (rows > 1)})"
        for identity, rows in counts.most_common(_NAMED)
    )
    return f"{named}, ..." if len(counts) > _NAMED else named


_AROUND_TIMES = " \t\r\n,;"
"""Separators between a time and its sentence."""

_DATE_FROM = 10_000_000_000_000
"""Least number that is not a time since 1970, but a date without separators, such as
20260601100000; milliseconds reach it in the year 2286."""


def _from_sentences(path: Path) -> Iterator[_Said]:
    """Yield the contents of each sentence; lines that cannot be decoded are skipped.

    Raises
    ------
    InputError : pyais is not installed, a report has no time, or there is no position report
    """
    decoder = SentenceDecoder(str(path))
    others: set[int] = set()
    read = False
    for number, line in _numbered_lines(path):
        message = decoder.decode(line)
        if message is None:
            continue
        if message.places:
            read = True
            time = _time_of(message.before, message.after, path, number)
            values = (message.value(name) for name in ("lat", "lon", "speed", "course"))
            yield _Said(message.mmsi, AisRow(number, time, *values))
        else:
            others.add(int(message.said["msg_type"]))
        if (size := message.size) is not None:
            yield _Said(message.mmsi, size=size)
    if not read:
        types = (
            f"messages of type {', '.join(map(str, sorted(others)))} alone"
            if others
            else "no sentence that can be decoded"
        )
        raise InputError(
            f"{path}: it has {types}; position reports of types"
            f" {', '.join(map(str, POSITION_REPORTS))} are read, others have no"
            " speed and course, or none that is exact enough: give a file with these"
        )


def _numbered_lines(path: Path) -> Iterator[tuple[int, str]]:
    with path.open(encoding="utf-8-sig", errors="replace") as lines:
        yield from enumerate(lines, start=1)


def _time_of(before: str, after: str, path: Path, number: int) -> float:
    """Return the time of reception: of the tag block, or a time in ISO 8601 or seconds since 1970
    before the sentence or after its checksum.
    """
    found = TAG_TIME.search(before)
    text = found[1] if found else before.strip(_AROUND_TIMES) or after.strip(_AROUND_TIMES)
    try:
        time = float(text) if text.replace(".", "", 1).isdigit() else _seconds_of(text)
    except ValueError:
        raise InputError(
            f"{path}, line {number}: the sentence has no time; give each its time of reception, as"
            " in \\c:1780315200*5A\\!AIVDM,... or 2026-06-01T12:00:00Z !AIVDM,..."
        ) from None
    if time >= _DATE_FROM:
        raise InputError(
            f"{path}, line {number}: the time {text} is beyond milliseconds since 1970, and no date"
            " without its marks is read; give"
            " seconds since 1970, as 1780315200, or 2026-06-01T12:00:00Z"
        )
    return time / 1000.0 if time >= MILLISECONDS_FROM else time


def _seconds_of(text: str) -> float:
    """Return seconds since 1970 of a time in ISO 8601, in UTC unless it names its zone.

    Raises
    ------
    ValueError : it is not such a time
    """
    time = datetime.fromisoformat(text)
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


_PAIRS_MIN = 10
"""Least number of pairs of neighbouring reports for a check: with fewer, the scatter of places
decides.
"""

_WAY_MIN, _TIME_MAX = 30.0, 60.0
"""Least way between the places of a pair [m], since places scatter by some metres, and longest time
[s], in which the vessel goes nearly straight.
"""

_TURN_MAX, _FASTER_MAX = math.radians(10.0), 1.2
"""Largest change of course [rad], and largest ratio of speeds [-], of a straight and even stretch
in a longer time.
"""

_RATIO = (0.7, 1.4)
"""Limits of the median ratio of speeds to those between places [-]: it is 0.51 for metres per
second in place of knots, 1.85 for km/h.
"""

_CLOSE = 0.3
"""Share of these limits for swapped places: within it they fit, and not by chance."""

_OFF_MAX = 30.0
"""Largest median difference of courses from those between places [deg]."""


def check_units(
    path: Path, time: Array, latitude: Array, longitude: Array, speed: Array, course: Array
) -> None:
    """Raise an InputError where speeds [m/s] or courses [rad] differ from those between places
    [rad], in the median of all pairs.
    """
    judged = _against_places(time, latitude, longitude, speed, course)
    if judged is None or _agree(*judged):
        return
    ratio, off = judged
    swapped = _against_places(time, longitude, latitude, speed, course)
    if swapped is not None and _agree(*swapped, share=_CLOSE):
        raise InputError(
            f"{path}: latitude and longitude are swapped: only so are speeds and courses those"
            " between places; swap the columns' names"
        )
    if not _RATIO[0] <= ratio <= _RATIO[1]:
        raise InputError(
            f"{path}: reported speeds are {ratio:.2f} of those between places, in the median; they"
            " must be in knots (column"
            " sog_kn or SOG), and latitude and longitude in degrees: convert them"
        )
    raise InputError(
        f"{path}: reported courses are {off:.0f} deg off those between places, in the median; they"
        " must be over the ground, in"
        " degrees from true north (column cog_deg or COG): convert them, or take another column"
    )


def _against_places(
    time: Array, latitude: Array, longitude: Array, speed: Array, course: Array
) -> tuple[float, float] | None:
    """Return the median ratio of speeds to those between places [-], and the median difference of
    courses [deg]; None with too few pairs.
    """
    way = np.diff(cartesian(latitude, longitude), axis=0)
    apart, passed = np.linalg.norm(way, axis=-1), np.diff(time)
    mean = 0.5 * (speed[1:] + speed[:-1])
    far = (np.maximum(apart, mean * passed) > _WAY_MIN * np.maximum(1.0, passed / _TIME_MAX)) & (
        apart > 0.0
    )
    judged = far & (passed <= _TIME_MAX)
    if np.count_nonzero(judged) < _PAIRS_MIN:
        judged |= far & _straight(passed, speed, course)
    if np.count_nonzero(judged) < _PAIRS_MIN:
        return None
    sin_lat, cos_lat, sin_lon, cos_lon = (
        f(of[:-1]) for of in (latitude, longitude) for f in (np.sin, np.cos)
    )
    north = -sin_lat * cos_lon * way[:, 0] - sin_lat * sin_lon * way[:, 1] + cos_lat * way[:, 2]
    east = cos_lon * way[:, 1] - sin_lon * way[:, 0]
    middle = np.angle(np.exp(1j * course[1:]) + np.exp(1j * course[:-1]))
    off = np.abs(np.angle(np.exp(1j * (np.arctan2(east, north) - middle))))
    return float(np.median((mean * passed / np.maximum(apart, 1e-9))[judged])), float(
        np.degrees(np.median(off[judged]))
    )


def _straight(passed: Array, speed: Array, course: Array) -> npt.NDArray[np.bool_]:
    """Return which of the pairs that a track bridges, shape (n - 1,), lie with both neighbours
    within a straight and even stretch.
    """
    turned = np.abs(np.angle(np.exp(1j * np.diff(course))))
    slower, faster = np.minimum(speed[1:], speed[:-1]), np.maximum(speed[1:], speed[:-1])
    even = (passed <= GAP_MAX) & (turned <= _TURN_MAX) & (faster <= _FASTER_MAX * slower)
    around = np.concatenate([[True], even, [True]])
    straight: npt.NDArray[np.bool_] = even & around[:-2] & around[2:]
    return straight


def _agree(ratio: float, off: float, share: float = 1.0) -> bool:
    """Return whether speeds and courses agree with those between places, within a share of the
    limits.
    """
    return (
        1.0 + share * (_RATIO[0] - 1.0) <= ratio <= 1.0 + share * (_RATIO[1] - 1.0)
        and off <= share * _OFF_MAX
    )
