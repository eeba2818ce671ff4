"""A shape that answers in lists and in single precision."""

from dataclasses import dataclass

import numpy as np

from gnc.reference.shapes import Sinusoid


class Listed:
    """An orbit, or courses of every amplitude, whose answers are numbers of NumPy, several of them
    in a list.
    """

    def __init__(self, other):
        self._other = other

    def __getattr__(self, name):
        answer = getattr(self._other, name)
        if isinstance(answer, float):
            return np.float32(answer)

        def listed(*values):
            found = answer(*values)
            return (
                [np.float32(of) for of in found] if isinstance(found, tuple) else np.float32(found)
            )

        return listed if callable(answer) else answer


@dataclass(frozen=True)
class ShapeOfLists(Sinusoid):
    """The paper's shape, with such answers, and such numbers for its courses."""

    @property
    def turn_rate_fraction_until_tracked(self):
        """Return what of the heading rate is taken until the reference is tracked."""
        return np.float32(0.7)

    def design(self, **limits):
        """Return the orbit of a speed ratio."""
        return Listed(super().design(**limits))

    def swing(self, **limits):
        """Return the courses of every amplitude."""
        return Listed(super().swing(**{name: np.float32(limit) for name, limit in limits.items()}))
