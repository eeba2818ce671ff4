"""Times as text."""

from datetime import UTC, datetime


def utc_text(seconds: float, *, milliseconds: bool = False) -> str:
    """Return a time since 1970 [s] in ISO 8601, to a millisecond; of a whole second only where
    ``milliseconds`` are asked for.
    """
    time = datetime.fromtimestamp(round(seconds, 3), UTC)
    return time.isoformat(
        timespec="milliseconds" if milliseconds or time.microsecond else "seconds"
    ).replace("+00:00", "Z")


def span_words(first: datetime, last: datetime) -> str:
    """Return times in UTC, the date once where it is the same: 2026-06-01 10:00:00 to 10:05:00 UTC."""
    begin, end = (time.astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S") for time in (first, last))
    if begin == end:
        return f"{begin} UTC"
    return f"{begin} to {end.split()[1] if begin.split()[0] == end.split()[0] else end} UTC"


def moment(recorded: object) -> datetime | None:
    """Return a time that was recorded in ISO 8601, or None if it is not one."""
    try:
        return datetime.fromisoformat(str(recorded))
    except ValueError:
        return None
