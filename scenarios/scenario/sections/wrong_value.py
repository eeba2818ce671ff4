"""What the value of a key must be, in words: a number in its unit or within its limit, a truth
value, a time.
"""

import re
from collections.abc import Mapping
from typing import Any

from common.physics import (
    METRES_PER_FOOT,
    METRES_PER_NAUTICAL_MILE,
    METRES_PER_SECOND_PER_KNOT,
    SECONDS_PER_HOUR,
)

_LIMITS = {
    "less_than_equal": ("le", "at most"),
    "less_than": ("lt", "below"),
    "greater_than_equal": ("ge", "at least"),
    "greater_than": ("gt", "above"),
}
"""What pydantic calls a limit that is not kept, the limit's name, and what to say of it."""

_NO_NUMBER = re.compile(r"float_(parsing|type)|finite_number")
_NOT_WHOLE = re.compile(r"int_(parsing|type|from_float)")
_OTHERS = {
    "bool": "it must be true or false",
    "string": "it must be text, in quotes",
    "datetime": "it must be a time, as 2026-06-01T12:00:00Z",
}
"""What pydantic's names of errors begin with, up to the first underscore, and what to say."""

_NUMBER_AND_UNIT = re.compile(r"\s*([-+]?\d+(?:\.\d+)?)\s*(.*?)\s*")
_IN_UNITS = {
    "m/s": {
        **dict.fromkeys(("kn", "kt", "knots"), METRES_PER_SECOND_PER_KNOT),
        "km/h": 1000.0 / SECONDS_PER_HOUR,
    },
    "m": {"km": 1000.0, "ft": METRES_PER_FOOT, "nmi": METRES_PER_NAUTICAL_MILE},
    "s": {"min": 60.0, "h": SECONDS_PER_HOUR},
    "%": {"ppm": 1e-4},
}
"""Units of keys, and what other units are in them, of which an example is converted."""

_PATTERN = re.compile(r"\^\[(.*)\]\+\$")
"""Of texts that consist of some letters alone."""

_LETTERS = {"A-Z": "capitals", "a-z": "small letters", "0-9": "digits"}

_OF_KEY = "unit of the key"
"""Unit of what is sampled of any key."""

_PERCENT, _SURELY_PERCENT = 100.0, 2.0
"""Percent in a whole, and the least value in the place of a fraction that is taken for percent."""


def must_be(
    error: Mapping[str, Any], *, key: str, unit: str = "", default: object = None
) -> str | None:
    """Return what a value must be, as "it must be at most 40 m/s"; None for an error of another
    kind.

    Parameters
    ----------
    error : of pydantic
    key : as it is written in a file or on the command line
    unit : of the key, empty or ``-`` without one
    default : of the key, an example where the value has no number in it
    """
    unit = "" if unit in ("-", _OF_KEY) else unit
    kind, value = error["type"], error["input"]
    if _NO_NUMBER.fullmatch(kind):
        given = _example(value, unit) if isinstance(value, str) else None
        if given is None:
            given = f"{default:g}" if isinstance(default, float) else ""
        finite = "finite " if kind == "finite_number" else ""
        return f"it must be a {finite}number{f' in {unit}' if unit else ''}{f', e.g. {key}={given}' if given else ''}"
    if _NOT_WHOLE.fullmatch(kind):
        return "it must be a whole number"
    if kind == "string_pattern_mismatch":
        letters = _PATTERN.fullmatch(error["ctx"]["pattern"])
        return (
            f"it must be made of {_letters(letters[1])} alone"
            if letters
            else f"it must match {error['ctx']['pattern']}"
        )
    if kind == "too_long":
        return f"it must have {error['ctx']['max_length']} values at most, and has {error['ctx']['actual_length'] or 'more'}"
    if kind not in _LIMITS:
        return _OTHERS.get(kind.partition("_")[0])
    name, words = _LIMITS[kind]
    limit = error["ctx"][name]
    percent = isinstance(value, int | float) and _SURELY_PERCENT <= value <= _PERCENT
    fraction = percent and not unit and limit == 1 and name in ("le", "lt")
    number = f"{limit:,}" if isinstance(limit, int) else f"{limit:g}"
    return f"it must be {words} {number}{f' {unit}' if unit else ''}{f': a fraction, e.g. {value / _PERCENT:g}' if fraction else ''}"


def _letters(pattern: str) -> str:
    """Return the letters of a pattern in words, as "small letters, digits and _"."""
    words = [word for letters, word in _LETTERS.items() if letters in pattern]
    signs = re.sub("|".join(_LETTERS), "", pattern).replace("\\", "")
    *others, last = [*words, *signs]
    return f"{', '.join(others)} and {last}"


def _example(value: str, unit: str) -> str | None:
    """Return the number of a text with a unit in that of the key, empty if the unit is another one;
    None without a number.
    """
    found = _NUMBER_AND_UNIT.fullmatch(value)
    if found is None:
        return None
    number, given = found[1], found[2]
    of_key = unit.partition(" ")[0]
    if not given or not unit or given in (unit, of_key):
        return number
    factor = _IN_UNITS.get(of_key, {}).get(given)
    return "" if factor is None else f"{float(number) * factor:.4g}"
