"""Times as text."""

from datetime import UTC, datetime


def utc_text(seconds: float, *, milliseconds: bool = False) -> str:
    """Return a time since 1970 [s] in ISO 8601, to a millisecond; of a whole second only where ``milliseconds`` are asked for."""
    time = datetime.fromtimestamp(round(seconds, 3), UTC)
    return time.isoformat(timespec="milliseconds" if milliseconds or time.microsecond else "seconds").replace("+00:00", "Z")
