"""Reports of one vessel from a file: a table in one of the known layouts, or NMEA sentences as received
(``!AIVDM,...``, decoded by pyais). Unusable rows are left out and counted.
"""

import bisect
import csv
import math
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import islice, pairwise
from numbers import Integral
from pathlib import Path
from typing import Any, NamedTuple, TextIO

import numpy as np
import numpy.typing as npt

from common.geodesy import cartesian
from common.physics import METRES_PER_SECOND_PER_KNOT
from common.text import install_words, other_units
from measurement.tables import decimal_commas, other_separator
from scenarios.errors import InputError
from scenarios.scenario.sections.world import GAP_MAX


class AisRow(NamedTuple):
    """A report as its file has it; NaN where it says nothing.

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


def seconds_of(text: str) -> float:
    """Return seconds since 1970 of a time in ISO 8601, in UTC unless it names its zone.

    Raises
    ------
    ValueError : it is not such a time
    """
    time = datetime.fromisoformat(text.strip())
    return (time if time.tzinfo else time.replace(tzinfo=UTC)).timestamp()


def number_of(text: str | None) -> float:
    """Return a number, with a point or a comma; NaN if there is none."""
    try:
        return float((text or "").strip().replace(",", "."))
    except ValueError:
        return math.nan


Array = npt.NDArray[np.float64]

_SPEED_MAX_KN = 102.2
"""Fastest that a report can say; 102.3 is "not available" (ITU-R M.1371-5, table 48) [kt]."""

_AT_REST_KN = 0.5
"""Speed below which a report needs no course: a vessel at rest has none [kt]."""

_REACH_SPEED, _REACH = 50.0, 500.0
"""How far from its neighbours a report may lie: as far as the fastest vessel goes, and errors of
satellite navigation [m/s, m].
"""

NO_TIME, NO_PLACE, NO_SPEED, DUPLICATE, OUT_OF_ORDER, OUT_OF_REACH = (
    "without a time",
    "without a possible position",
    "without speed or course",
    "with the time of another",
    "out of order",
    "out of reach of others",
)
"""Why rows are not used."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AisReports:
    """Reports of one vessel, in the order of their times.

    Attributes
    ----------
    path, mmsi : the file, and the vessel's identity
    line : of the file, from 1
    time : since 1970 in UTC [s]
    latitude, longitude : [rad]
    speed, course : over the ground, course from true north [m/s, rad]
    rows : of the vessel in the file
    dropped : number of rows that are not used, by the reason
    """

    path: Path
    mmsi: int
    line: Array
    time: Array
    latitude: Array
    longitude: Array
    speed: Array
    course: Array
    rows: int
    dropped: dict[str, int]

    def described(self) -> str:
        """Return how many rows were used and dropped, in a line."""
        dropped = ", ".join(f"{count} {why}" for why, count in self.dropped.items())
        used = f"{self.path.name}: {len(self.time)} of {self.rows} rows of MMSI {self.mmsi} used"
        return f"{used}; dropped: {dropped}" if dropped else used


def read_ais(path: str | Path, mmsi: int | None = None) -> AisReports:
    """Read the reports of one vessel.

    Parameters
    ----------
    path : of a table in one of the known layouts, or of NMEA sentences (docs/howto/ais_and_wind.md)
    mmsi : of the vessel; may be left out where the file has one vessel alone

    Raises
    ------
    InputError : the file cannot be read, its layout is unknown, fewer than two rows of the vessel
        are of use, or its units are others; or ``mmsi`` is no whole number
    """
    path = Path(path)
    if mmsi is not None and (isinstance(mmsi, bool) or not isinstance(mmsi, Integral)):
        raise InputError(f"{path}: mmsi is {mmsi!r}; give a whole number, as in mmsi=219999001")
    identity, rows = rows_of(path, mmsi)
    dropped: Counter[str] = Counter()
    first: dict[str, int] = {}
    kept = rows
    for sorted_out in (_by_what_they_say, _by_their_times, _by_their_places):
        reasons = sorted_out(kept)
        for row, reason in zip(kept, reasons, strict=True):
            if reason:
                dropped[reason] += 1
                first.setdefault(reason, row.line)
        kept = [row for row, reason in zip(kept, reasons, strict=True) if not reason]
    if len(kept) < 2:
        why = ", ".join(
            f"{count} {reason} (first in line {first[reason]})" for reason, count in dropped.items()
        )
        remedy = (
            "sort the file by time"
            if dropped[OUT_OF_ORDER]
            else "correct the rows, or give another file"
        )
        raise InputError(
            f"{path}: {len(kept)} of {len(rows)} rows of MMSI {identity} used, two are"
            f" needed;{f' dropped: {why};' if why else ''} {remedy}"
        )
    columns = np.array(kept).T
    directed = np.isfinite(columns[5]) & (columns[5] < 360.0)
    reports = AisReports(
        path=path,
        mmsi=identity,
        line=columns[0],
        time=columns[1],
        latitude=np.radians(columns[2]),
        longitude=np.radians(columns[3]),
        # A speed without a course is next to none, and has no direction.
        speed=METRES_PER_SECOND_PER_KNOT * np.where(directed, columns[4], 0.0),
        course=np.radians(np.where(directed, columns[5], 0.0)),
        rows=len(rows),
        dropped=dict(dropped),
    )
    check_units(
        path, reports.time, reports.latitude, reports.longitude, reports.speed, reports.course
    )
    return reports


def _by_what_they_say(rows: Sequence[AisRow]) -> list[str]:
    """Return why a row is not used by its own values, empty where it is: ITU-R M.1371-5 has 91,
    181, 102.3 and 360 for none.
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


def _by_their_times(rows: Sequence[AisRow]) -> list[str]:
    """Return why a row is not used by its time: the longest run of rows whose times rise is
    kept.
    """
    last: list[int] = []
    times: list[float] = []
    before = [-1] * len(rows)
    for i, row in enumerate(rows):
        at = bisect.bisect_left(times, row.time)
        before[i] = last[at - 1] if at else -1
        if at < len(times):
            # Of rows with the same time the first one stays.
            if times[at] > row.time:
                times[at], last[at] = row.time, i
        else:
            times.append(row.time)
            last.append(i)
    kept = set()
    i = last[-1] if last else -1
    while i >= 0:
        kept.add(i)
        i = before[i]
    known = {rows[i].time for i in kept}
    return [
        "" if i in kept else DUPLICATE if row.time in known else OUT_OF_ORDER
        for i, row in enumerate(rows)
    ]


def _by_their_places(rows: Sequence[AisRow]) -> list[str]:
    """Return why a row is not used by its place: a vessel could not have come from the row
    before, nor gone to the next.
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
    # At an end the only neighbour decides, where that one fits to its own other neighbour.
    alone = [
        not near[0] and near[1],
        *(not (before or after) for before, after in pairwise(near)),
        not near[-1] and near[-2],
    ]
    return [OUT_OF_REACH if row_alone else "" for row_alone in alone]


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
            f"{path}: not a table or NMEA sentences as text ({error}); unpack it, or save it in"
            " UTF-8"
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
            f"{path}, line {first}: the header is {head.strip()[:_SHOWN]!r}; known are those of the"
            f" Danish Maritime Authority and of Marine Cadastre, and {','.join(plain)}: {remedy}"
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
                f"{path}, line {number}: {time[:40]!r} is no time of the layout {layout.name}, as"
                f" in {layout.time}; correct it, or delete the line"
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
            f"{path}: it has {len(counts)} vessels, {_most(counts)}; name one of them by its MMSI"
            " (vessel.mmsi)"
        )
    if not found:
        return None
    return mmsi if mmsi is not None else next(iter(counts)), found


def _no_row(path: Path, mmsi: int | None, rows: Iterable[tuple[int, AisRow]]) -> InputError:
    """Return what says that the file has no row of the vessel, and whose rows it has."""
    counts = Counter(identity for identity, _ in rows)
    if not counts:
        return InputError(
            f"{path}: no row has an MMSI in digits, as 219999001, in the column of its name; give a"
            " file of AIS reports"
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


_TAG_TIME = re.compile(r"[\\,]c:(\d+)")
"""Time of reception in a tag block of NMEA 4.10: seconds since 1970, or milliseconds."""

_POSITION_REPORTS = (1, 2, 3, 18, 19)
"""Message types with position, speed and course (ITU-R M.1371-5): class A, and class B."""

_MILLISECONDS_FROM, _DATE_FROM = 100_000_000_000, 10_000_000_000_000
"""Times since 1970 from which on they are milliseconds, of seconds from the year 5138 on; and from
which on they are no time, but a date without its marks, as 20260601100000, of milliseconds from the
year 2286 on."""


def nmea_rows(lines: Iterable[str], path: Path) -> Iterator[tuple[int, AisRow]]:
    """Yield the vessel's identity and the row of each position report; lines that cannot be decoded
    are passed over.

    Raises
    ------
    InputError : pyais is not installed, a report has no time, or there is no position report
    """
    try:
        import pyais
    except ImportError:
        raise InputError(
            f"{path}: NMEA sentences need pyais; install the extra: {install_words('ais')}"
        ) from None
    others: set[int] = set()
    read = False
    for number, line in enumerate(lines, start=1):
        head, mark, sentence = line.strip().partition("!")
        if not mark:
            continue
        try:
            said: dict[str, Any] = pyais.decode(mark + sentence).asdict()
        except Exception:  # noqa: BLE001 - whatever radio and decoder make of a line, it is one that says nothing
            continue
        if said.get("msg_type") not in _POSITION_REPORTS:
            others.add(int(said["msg_type"]))
        else:
            read = True
            speed, course = _value(said, "speed"), _value(said, "course")
            time = _time_of(head, path, number)
            yield (
                int(said["mmsi"]),
                AisRow(number, time, _value(said, "lat"), _value(said, "lon"), speed, course),
            )
    if not read:
        types = (
            f"messages of type {', '.join(map(str, sorted(others)))} alone"
            if others
            else "no sentence that can be decoded"
        )
        raise InputError(
            f"{path}: it has {types}; position reports of types"
            f" {', '.join(map(str, _POSITION_REPORTS))} are read, others have no"
            " speed and course, or none that is exact enough: give a file with these"
        )


def _value(said: dict[str, Any], name: str) -> float:
    value = said.get(name)
    return math.nan if value is None else float(value)


def _time_of(head: str, path: Path, number: int) -> float:
    """Return the time of reception: of the tag block, or a time in ISO 8601 or seconds since 1970
    before the sentence.
    """
    found = _TAG_TIME.search(head)
    text = found[1] if found else head.strip(" \t,;")
    try:
        time = float(text) if text.replace(".", "", 1).isdigit() else seconds_of(text)
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
    return time / 1000.0 if time >= _MILLISECONDS_FROM else time


_PAIRS_MIN = 10
"""Pairs of neighbouring reports from which on they are judged: of fewer, scattered places decide.
"""

_WAY_MIN, _TIME_MAX = 30.0, 60.0
"""Least way between the places of a pair [m], which scatter by some, and longest time [s]: in it
the vessel goes nearly straight.
"""

_TURN_MAX, _FASTER_MAX = math.radians(10.0), 1.2
"""Change of course [rad], and larger over smaller speed [-], up to which it went straight and
evenly in a longer time.
"""

_RATIO = (0.7, 1.4)
"""Speeds over those between places, in the median [-]: metres per second for knots are 0.51, km/h
are 1.85.
"""

_CLOSE = 0.3
"""Share of these that places which are swapped have to keep to: then they fit, and not by chance.
"""

_OFF_MAX = 30.0
"""Difference of courses from those between places, in the median [deg]."""


def check_units(
    path: Path, time: Array, latitude: Array, longitude: Array, speed: Array, course: Array
) -> None:
    """Raise an InputError where speeds [m/s] or courses [rad] are not those between places [rad],
    in the median of all pairs.
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
    """Return the median ratio of speeds to those between places [-], and of differences of course
    [deg]; none of too few pairs.
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
    """Return which pairs, shape (n - 1,), that a track bridges lie within a straight and even
    stretch, with both neighbours.
    """
    turned = np.abs(np.angle(np.exp(1j * np.diff(course))))
    slower, faster = np.minimum(speed[1:], speed[:-1]), np.maximum(speed[1:], speed[:-1])
    even = (passed <= GAP_MAX) & (turned <= _TURN_MAX) & (faster <= _FASTER_MAX * slower)
    around = np.concatenate([[True], even, [True]])
    straight: npt.NDArray[np.bool_] = even & around[:-2] & around[2:]
    return straight


def _agree(ratio: float, off: float, share: float = 1.0) -> bool:
    """Return whether speeds and courses are those between places, within a share of what is
    allowed.
    """
    return (
        1.0 + share * (_RATIO[0] - 1.0) <= ratio <= 1.0 + share * (_RATIO[1] - 1.0)
        and off <= share * _OFF_MAX
    )
