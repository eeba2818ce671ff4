"""Errors of input from which nothing can be measured."""

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from common.errors import RefusedError
from common.text import did_you_mean


class MeasurementError(RefusedError):
    """The input cannot be used; its one-line message names quantity, value, limit and remedy."""


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the name of a file before an error of its content."""
    try:
        yield
    except MeasurementError as error:
        raise MeasurementError(f"'{path}': {error}") from None


def check_range(what: str, value: float, low: float, high: float, unit: str = "") -> None:
    """Check that a value is within its range; the error says what it is, with its unit.

    Raises
    ------
    MeasurementError : the value is below ``low``, above ``high``, or NaN
    """
    if not low <= value <= high:
        raise MeasurementError(f"{what} is {value:g}{unit}; it must be {low:g} to {high:g}{unit}")


def check_keys(table: Mapping[str, Any], known: Sequence[str], where: str) -> None:
    """Check the keys of a table against the known ones; ``where`` names the table in the error.

    Raises
    ------
    MeasurementError : a key is not known
    """
    for key in table:
        if key not in known:
            raise MeasurementError(
                f"{where} has the key '{key}'{did_you_mean(key, known) or ';'} it may have"
                f" {', '.join(known)}"
            )


def number(value: Any, key: str, where: str) -> float:
    """Return the value of a table's key as a number; ``where`` names the table in the error.

    Raises
    ------
    MeasurementError : the value is not a number
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise MeasurementError(f"{key} of {where} is {value!r}; it must be a number")
    return float(value)
