"""Plain numbers from a shape of a user's own: of NumPy's single precision all that follows would be
computed in it.
"""

from typing import Any

import numpy as np


class Plain:
    """A shape of a user's own, or what it has made: with the same attributes and methods.

    Each number that it answers with is a plain one, several of them are a tuple, and arrays are of
    double precision: compiled guidance takes nothing else.

    Parameters
    ----------
    part : the shape, an orbit of it, or its courses
    """

    def __init__(self, part: Any) -> None:
        self._part = part

    def __getattr__(self, name: str) -> Any:
        """Return what the part has by this name; it is asked once for each of its methods."""
        if name.startswith("_"):
            # A copy asks before it has its part.
            raise AttributeError(name)
        answer = getattr(self._part, name)
        if not callable(answer):
            return _plain(answer)

        def method(*given: Any, **named: Any) -> Any:
            return _plain(answer(*given, **named))

        setattr(self, name, method)
        return method


def made_plain(shape: Any) -> Any:
    """Return a shape, made plain if it is a user's own."""
    return shape if type(shape).__module__.startswith("gnc.") else Plain(shape)


def _plain(answer: Any) -> Any:
    match answer:
        case str() | bool() | np.bool_() | None:
            return answer
        case list() | tuple():
            return tuple(_plain(one) for one in answer)
        case np.ndarray() if answer.ndim:
            return answer.astype(np.float64)
        case int() | float() | np.number() | np.ndarray():
            return float(answer)
    return Plain(answer)
