"""AIS sentences as received, ``!AIVDM,...``, each with its time of reception before it; decoded by
pyais.
"""

import math
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from common.text import install_words
from scenarios.errors import InputError
from scenarios.world.ais.rows import AisRow, seconds_of

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
            f"{path}: it has {types}; position reports of types {', '.join(map(str, _POSITION_REPORTS))} are read, others have no"
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
            f"{path}, line {number}: the sentence has no time; give each its time of reception, as in"
            " \\c:1780315200*5A\\!AIVDM,... or 2026-06-01T12:00:00Z !AIVDM,..."
        ) from None
    if time >= _DATE_FROM:
        raise InputError(
            f"{path}, line {number}: the time {text} is beyond milliseconds since 1970, and no date without its marks is read; give"
            " seconds since 1970, as 1780315200, or 2026-06-01T12:00:00Z"
        )
    return time / 1000.0 if time >= _MILLISECONDS_FROM else time
