"""Text for messages and tables: similar names, lines, times, cells of CSV tables."""

import difflib
import json
import math
import re
from collections.abc import Iterable
from datetime import UTC, datetime

_SHORT = 3
"""Largest length of a short name, in which one wrong letter counts more."""

_FORMULA = ("=", "+", "-", "@", "\t", "\r")
"""First characters of a text that a spreadsheet takes for a formula."""

_HOST_AND_PORT = re.compile(r"([A-Za-z0-9.\-]+):(\d{1,5})")

_PORT_MAX = 65535
"""Largest port of UDP and TCP."""

MARK = "'"
"""Put before such a text in a cell, so that a spreadsheet shows it (OWASP, CSV injection)."""


def at_or_below(key: str, above: str) -> bool:
    """Return whether a dotted key equals another or lies below it, like wind.speed_mps in wind."""
    return key == above or key.startswith(f"{above}.")


def host_and_port(text: str) -> tuple[str, int] | None:
    """Return host and port from HOST:PORT, or None if the text has another form."""
    found = _HOST_AND_PORT.fullmatch(text)
    if found is None:
        return None
    host, port = found[1], int(found[2])
    return (host, port) if 0 < port <= _PORT_MAX else None


def one_line(words: str) -> str:
    """Return a text in one line, with control characters escaped."""
    joined = " ".join(part for line in words.splitlines() if (part := line.strip()))
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in joined
    )


def install_words(extra: str) -> str:
    """Return the command that installs an optional extra of the project, for messages."""
    return f"in the clone, pip install -c constraints.txt -e '.[{extra}]'"


def nearest(name: str, known: Iterable[str]) -> str | None:
    """Return the known name with the most similar spelling, ignoring case, or None.

    A known name with one additional letter at its end comes first.
    """
    by_lower_case = {each.lower(): each for each in known}
    lower = name.lower()
    longer = [
        each for each in by_lower_case if each.startswith(lower) and len(each) == len(lower) + 1
    ]
    if longer and lower not in by_lower_case:
        return by_lower_case[min(longer)]
    cutoff = 0.5 if len(name) <= _SHORT else 0.6
    close = difflib.get_close_matches(lower, by_lower_case, n=1, cutoff=cutoff)
    return by_lower_case[close[0]] if close else None


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return ``; did you mean 'x'?`` for the nearest known name, or "" if none is similar."""
    found = nearest(name, known)
    return f"; did you mean '{found}'?" if found else ""


def other_units(heads: Iterable[str], columns: Iterable[str]) -> str:
    """Return a remedy for headings that differ from missing columns only by their unit.

    Parameters
    ----------
    heads : headings of the table
    columns : missing columns, such as ``speed_mps``
    """
    heads = list(heads)
    missing = {
        column.rpartition("_")[0]: column
        for column in columns
        if "_" in column and column not in heads
    }
    remedies = []
    for head in heads:
        column = missing.get(head.rpartition("_")[0])
        if column is not None:
            remedies.append(
                f"'{head}' is in another unit than '{column}': "
                "convert its values before you rename it"
            )
    return "; ".join(remedies)


def utc_text(seconds: float, *, milliseconds: bool = False) -> str:
    """Return a time in ISO 8601, rounded to a millisecond.

    Parameters
    ----------
    seconds : time since 1970-01-01 in UTC [s]
    milliseconds : whether whole seconds are printed with milliseconds as well
    """
    time = datetime.fromtimestamp(round(seconds, 3), UTC)
    timespec = "milliseconds" if milliseconds or time.microsecond else "seconds"
    return time.isoformat(timespec=timespec).replace("+00:00", "Z")


def span_words(first: datetime, last: datetime) -> str:
    """Return a span of time as text, as in ``2026-06-01 10:00:00 to 10:05:00 UTC``."""
    begin, end = (time.astimezone(UTC).strftime("%Y-%m-%d %H:%M:%S") for time in (first, last))
    if begin == end:
        return f"{begin} UTC"
    begin_date, _ = begin.split()
    end_date, end_time = end.split()
    return f"{begin} to {end_time if begin_date == end_date else end} UTC"


def moment(recorded: object) -> datetime | None:
    """Return the time in an ISO 8601 text, or None for anything else."""
    try:
        return datetime.fromisoformat(str(recorded))
    except ValueError:
        return None


def cell(value: object) -> object:
    """Return a value for a cell of a CSV table: "" if missing, and no text that is a formula."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return f"{MARK}{value}" if _looks_like_formula(value) else value


def from_cell(value: object) -> object:
    """Return the value that ``cell`` wrote."""
    marked = isinstance(value, str) and value.startswith(MARK) and _looks_like_formula(value)
    return str(value)[1:] if marked else value


def as_json_cell(value: object) -> object:
    """Return a JSON value for a CSV cell that ``from_json_cell`` can read back.

    Numbers and plain words stay unchanged; anything else becomes JSON text.
    """
    if isinstance(value, int | float) and not isinstance(value, bool):
        return value
    if not isinstance(value, str):
        return json.dumps(value)
    return value if from_json_cell(value) is value and value else json.dumps(value)


def from_json_cell(text: str) -> object:
    """Return the value that ``as_json_cell`` and ``cell`` wrote."""
    word = from_cell(text)
    try:
        return json.loads(str(word))
    except ValueError:
        return word


def _looks_like_formula(value: object) -> bool:
    return isinstance(value, str) and value.lstrip(MARK).startswith(_FORMULA)
