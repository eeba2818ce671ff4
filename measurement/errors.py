"""Errors of input from which nothing can be measured."""

import contextlib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from common.text import did_you_mean


class MeasurementError(ValueError):
    """The input cannot be used; its one-line message names quantity, value, limit and remedy."""


@contextlib.contextmanager
def naming(path: Path) -> Iterator[None]:
    """Put the name of a file before an error of its content."""
    try:
        yield
    except MeasurementError as error:
        raise MeasurementError(f"'{path}': {error}") from None


def guess(name: str, known: Iterable[str]) -> str:
    """Return the question for the known name nearest to an unknown one, or ";" if none is similar.

    It stands between the unknown name and the list of the known ones.
    """
    return did_you_mean(name, known) or ";"


def number(value: Any, key: str, where: str) -> float:
    """Return the value of a table's key as a number; ``where`` names the table in the error.

    Raises
    ------
    MeasurementError : the value is not a number
    """
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise MeasurementError(f"{key} of {where} is {value!r}; it must be a number")
    return float(value)
