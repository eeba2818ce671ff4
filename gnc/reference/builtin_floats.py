"""Convert results of a user's shape to Python's numbers, which compiled guidance needs.

A single-precision number of NumPy would make all later results single precision.
"""

import functools
from typing import Any

import numpy as np


class BuiltinFloats:
    """Wraps a user's shape, orbit or courses, and converts its results to Python's numbers.

    The wrapper has the part's attributes and methods. A number becomes a float, a sequence a tuple
    of floats, an array becomes double precision; any other object is wrapped in the same way.

    Parameters
    ----------
    part : a shape, an orbit or courses
    """

    def __init__(self, part: Any) -> None:
        self._part = part

    def __getattr__(self, name: str) -> Any:
        """Return an attribute of the part; methods are cached."""
        if name.startswith("_"):
            # Copying looks up special methods before the copy has its part.
            raise AttributeError(name)
        found = getattr(self._part, name)
        if not callable(found):
            return _converted(found)

        @functools.wraps(found)
        def method(*args: Any, **keywords: Any) -> Any:
            return _converted(found(*args, **keywords))

        setattr(self, name, method)
        return method


def with_builtin_floats(shape: Any) -> Any:
    """Return a shape; a user's shape is wrapped in ``BuiltinFloats``."""
    return shape if type(shape).__module__.startswith("gnc.") else BuiltinFloats(shape)


def _converted(result: Any) -> Any:
    match result:
        case str() | bool() | np.bool_() | None:
            return result
        case list() | tuple():
            return tuple(_converted(one) for one in result)
        case np.ndarray() if result.ndim:
            return result.astype(np.float64)
        case int() | float() | np.number() | np.ndarray():
            return float(result)
    return BuiltinFloats(result)
