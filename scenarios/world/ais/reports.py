"""Reports of one vessel from a file, without those that are of no use, which are counted."""

import bisect
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from numbers import Integral
from pathlib import Path

import numpy as np
import numpy.typing as npt

from common.geodesy import cartesian
from common.physics import METRES_PER_SECOND_PER_KNOT
from scenarios.errors import InputError
from scenarios.world.ais.layouts import rows_of
from scenarios.world.ais.rows import AisRow
from scenarios.world.ais.units import check_units

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
    "without a time", "without a possible position", "without speed or course", "with the time of another", "out of order",
    "out of reach of others",
)  # fmt: skip
"""Why rows are of no use."""


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
    dropped : number of rows of no use, by why they are
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
            f"{path}: {len(kept)} of {len(rows)} rows of MMSI {identity} used, two are needed;{f' dropped: {why};' if why else ''}"
            f" {remedy}"
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
    """Return why each row is of no use by its own values, empty where it is: ITU-R M.1371-5 has 91,
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
    """Return why each row is of no use by its time: the longest run of rows whose times rise is
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
    """Return why each row is of no use by its place: a vessel could not have come from the row
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
