"""Which flight a log is of: what the log itself says of date and place, and what its configuration
adds.
"""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, date, datetime, timedelta
from pathlib import Path
from typing import Any

from measurement.errors import MeasurementError, guess

FLIGHT_KEYS = {
    "vessel": "name of the ship that was measured",
    "imo": "her IMO number, of seven digits",
    "mmsi": "her MMSI, of nine digits",
    "date": "date of the flight in UTC, or date and time of the log's first reading",
    "place": "where it was, in words",
    "operator": "who flew and measured",
}
"""Keys of the table ``[flight]`` of a configuration, and their meanings. Each may be left out."""

FROM_LOG, FROM_CONFIGURATION = "log", "configuration"
"""Where the times of a flight are from."""

Position = tuple[float, float]
"""Latitude and longitude [deg]."""


@dataclass(frozen=True, kw_only=True)
class FlightDetails:
    """What a configuration says of the flight; what it does not say is empty or None.

    Attributes
    ----------
    vessel, imo, mmsi : of the ship that was measured
    day : date of the flight in UTC
    start : of the log's first reading in UTC, or None where the date alone is given
    place : in words
    operator : who flew and measured
    """

    vessel: str = ""
    imo: int | None = None
    mmsi: int | None = None
    day: date | None = None
    start: datetime | None = None
    place: str = ""
    operator: str = ""


@dataclass(frozen=True, kw_only=True)
class FlightRecord:
    """Which flight a log is of, for its record.

    Attributes
    ----------
    readings : rows of the log
    details : of the configuration
    first_utc, last_utc : of the first and the last reading, or None where neither log nor
        configuration has a time
    utc_from : ``FROM_LOG``, ``FROM_CONFIGURATION`` or empty
    offset : whether the log's times have an offset from UTC; those without are taken as UTC
    first_position, last_position : first and last known place of the log, or None where it has none
    place_remark : which of its places are taken as missing, or empty
    columns, scale, missing : as the log was read
    stated : keys of the instrument's channels that the configuration has, as in ``LogConfig``
    """

    readings: int
    details: FlightDetails
    first_utc: datetime | None
    last_utc: datetime | None
    utc_from: str
    offset: bool
    first_position: Position | None
    last_position: Position | None
    place_remark: str
    columns: Mapping[str, str]
    scale: Mapping[str, float]
    missing: tuple[float, ...]
    stated: Mapping[str, tuple[str, ...]] | None

    def record(self) -> dict[str, Any]:
        """Return it for JSON, with times in ISO 8601."""
        found = asdict(self)
        return {name: value for name, value in found.items() if name != "details"} | {
            "first_utc": _text(self.first_utc),
            "last_utc": _text(self.last_utc),
            "details": found["details"]
            | {"day": _text(self.details.day), "start": _text(self.details.start)},
        }


def read_details(table: Mapping[str, Any], path: Path) -> FlightDetails:
    """Return the table ``[flight]`` of a configuration.

    Raises
    ------
    MeasurementError : a key is not known, or a value is not of its kind
    """
    if not isinstance(table, Mapping):
        raise MeasurementError(f"'{path}': flight is {table!r}; give a table [flight]")
    for key in table:
        if key not in FLIGHT_KEYS:
            raise MeasurementError(
                f"'{path}': [flight] has the key '{key}'{guess(key, FLIGHT_KEYS)} it may have {', '.join(FLIGHT_KEYS)}"
            )
    day, start = _date(table.get("date"), path)
    words = {key: _words(table.get(key, ""), key, path) for key in ("vessel", "place", "operator")}
    return FlightDetails(
        **words,
        imo=_imo(table.get("imo"), path),
        mmsi=_mmsi(table.get("mmsi"), path),
        day=day,
        start=start,
    )


def times_of(
    details: FlightDetails, logged: tuple[datetime, datetime] | None, duration_s: float, path: Path
) -> tuple[datetime | None, datetime | None, str]:
    """Return the times of the first and the last reading, and where they are from.

    Parameters
    ----------
    details : of the configuration
    logged : times of the first and the last reading by the log, or None where it counts seconds
    duration_s : from the first to the last reading [s]
    path : of the log

    Raises
    ------
    MeasurementError : log and configuration have different dates, or times that are a second or
        more apart
    """
    if logged is None:
        if (start := details.start) is None:
            return None, None, ""
        try:
            return start, start + timedelta(seconds=duration_s), FROM_CONFIGURATION
        except OverflowError:
            raise MeasurementError(
                f"'{path}' lasts {duration_s:g} s from flight.date on, beyond the year 9999; give its times in seconds"
            ) from None
    first = logged[0]
    apart = details.start is not None and abs((first - details.start).total_seconds()) >= 1.0
    if apart or (details.day is not None and first.date() != details.day):
        given = _text(details.start or details.day)
        raise MeasurementError(
            f"flight.date is {given}, but '{path}' begins at {_text(first)}; correct it, or leave it out"
        )
    return (*logged, FROM_LOG)


def _date(value: Any, path: Path) -> tuple[date | None, datetime | None]:
    """Return the date in UTC, and the moment where a time is given, too."""
    if value is None:
        return None, None
    if isinstance(value, str):
        value = _parsed(value)
    if isinstance(value, datetime) and value.tzinfo is not None:
        moment = value.astimezone(UTC)
        return moment.date(), moment
    if isinstance(value, date) and not isinstance(value, datetime):
        return value, None
    raise MeasurementError(
        f"'{path}': flight.date is {value!s}; give a date, as 2026-06-01, or a time with its offset, as 2026-06-01T10:00:00Z"
    )


def _parsed(text: str) -> date | str:
    for kind in (date, datetime):
        try:
            return kind.fromisoformat(text)
        except ValueError:
            continue
    return text


def _words(value: Any, key: str, path: Path) -> str:
    if not isinstance(value, str) or not value.isprintable():
        raise MeasurementError(f"'{path}': flight.{key} is {value!r}; give a text of one line")
    return value.strip()


def _imo(value: Any, path: Path) -> int | None:
    """Return an IMO number: the last digit is that of the sum of the others times 7 to 2 (IMO
    resolution A.1117(30)).
    """
    if value is None:
        return None
    digits = [int(digit) for digit in str(value)] if _is_number(value, 7) else []
    if (
        not digits
        or sum(digit * weight for digit, weight in zip(digits, range(7, 1, -1), strict=False)) % 10
        != digits[-1]
    ):
        raise MeasurementError(
            f"'{path}': flight.imo is {value!r}; give seven digits whose last is their check digit, as 9074729{_bare(value)}"
        )
    return int(value)


def _mmsi(value: Any, path: Path) -> int | None:
    if value is None:
        return None
    if not _is_number(value, 9):
        raise MeasurementError(
            f"'{path}': flight.mmsi is {value!r}; give nine digits, as 219000000{_bare(value)}"
        )
    return int(value)


def _bare(value: Any) -> str:
    """Return the remedy for a number that is given as a text, and nothing for others."""
    return ", without quotation marks" if isinstance(value, str) else ""


def _is_number(value: Any, digits: int) -> bool:
    return (
        isinstance(value, int)
        and not isinstance(value, bool)
        and 10 ** (digits - 1) <= value < 10**digits
    )


def _text(value: date | datetime | None) -> str | None:
    """Return a date, or a time of UTC to a millisecond where it has a fraction, in ISO 8601."""
    if isinstance(value, datetime):
        return value.isoformat(timespec="milliseconds" if value.microsecond else "seconds").replace(
            "+00:00", "Z"
        )
    return None if value is None else value.isoformat()
