"""Results of a user's shape as Python's own numbers, which compiled guidance needs.

From a number of NumPy's single precision, all that follows would be computed in it.
"""

import functools
from typing import Any

import numpy as np


class BuiltinFloats:
    """A user's shape, orbit or courses, whose results are converted to Python's own numbers.

    It has the same attributes and methods. A number becomes a float, a sequence a tuple of floats,
    an array one of double precision; any other object is wrapped like this one.

    Parameters
    ----------
    part : shape, orbit, or courses
    """

    def __init__(self, part: Any) -> None:
        self._part = part

    def __getattr__(self, name: str) -> Any:
        """Return the part's attribute of this name; a method is looked up once."""
        if name.startswith("_"):
            # A copy is asked for its special methods before it has its part.
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
    """Return a shape, wrapped in ``BuiltinFloats`` if it is a user's."""
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
