"""What one row of a file of AIS reports says."""

import math
from datetime import UTC, datetime
from typing import NamedTuple


class AisRow(NamedTuple):
    """A report as its file has it; not a number where it says nothing.

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
    """Return a number, with a point or a comma; not a number if there is none."""
    try:
        return float((text or "").strip().replace(",", "."))
    except ValueError:
        return math.nan
