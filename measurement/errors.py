"""Refusals of input from which nothing can be measured."""

import difflib
from collections.abc import Iterable
from typing import Any


class MeasurementError(ValueError):
    """The input cannot be used. The message is one line that names the quantity, its value, the
    limit and the remedy.
    """


def guess(name: str, known: Iterable[str]) -> str:
    """Return what stands between an unknown name and the known ones: the nearest of these, if any
    is similar.
    """
    close = difflib.get_close_matches(name.lower(), known, n=1)
    return f"; did you mean '{close[0]}'?" if close else ";"


def number(value: Any, key: str, where: str) -> float:
    """Return the value of a key of a table as a number.

    Raises
    ------
    MeasurementError : it is none; ``where`` is what the table is of
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise MeasurementError(f"{key} of {where} is {value!r}; it must be a number")
    return float(value)
