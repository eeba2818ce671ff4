"""When and where a flight was, in words."""

import math
from datetime import UTC, datetime


def position_words(latitude: float, longitude: float) -> str:
    """Return a place [deg] to a metre: 57.20000° N, 11.30000° E."""
    longitude = (longitude + 180.0) % 360.0 - 180.0
    return f"{abs(latitude):.5f}° {'N' if latitude >= 0.0 else 'S'}, {abs(longitude):.5f}° {'E' if longitude >= 0.0 else 'W'}"


def span_words(first: datetime, last: datetime) -> str:
    """Return times in UTC, the date once where it is the same: 2026-06-01 10:00:00 to 10:05:00 UTC."""
    begin, end = (moment.astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S") for moment in (first, last))
    if begin == end:
        return f"{begin} UTC"
    return f"{begin} to {end.split()[1] if begin.split()[0] == end.split()[0] else end} UTC"


def moment(recorded: object) -> datetime | None:
    """Return a time that was recorded in ISO 8601, or None of what is none."""
    if recorded is None or (isinstance(recorded, float) and math.isnan(recorded)):
        return None
    try:
        return datetime.fromisoformat(str(recorded))
    except ValueError:
        return None
