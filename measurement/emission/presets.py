"""Fuels and ships that are data: tables beside this file."""

import functools
import tomllib
from importlib.resources import files
from typing import Any

from measurement.errors import MeasurementError


def preset(file: str, kind: str, name: str) -> dict[str, Any]:
    """Return the fields of the thing ``name`` in ``file``, which holds things of a ``kind``.

    Raises
    ------
    MeasurementError : there is no such name; the message lists those that there are
    """
    tables = _tables(file)
    if name not in tables:
        raise MeasurementError(f"{kind} {name!r} is not known; there are {', '.join(tables)}")
    return dict(tables[name])


@functools.cache
def _tables(file: str) -> dict[str, dict[str, Any]]:
    return tomllib.loads(files("measurement.emission").joinpath(file).read_text(encoding="utf-8"))
