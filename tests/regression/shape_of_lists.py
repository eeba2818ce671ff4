"""A shape whose courses are answered in lists and in single precision."""

from dataclasses import dataclass

import numpy as np

from gnc.reference.shapes.sinusoid import Sinusoid


class Listed:
    """Courses of another swing, in lists of numbers of NumPy."""

    def __init__(self, swing):
        self._swing = swing

    def __getattr__(self, name):
        answer = getattr(self._swing, name)

        def listed(*values):
            found = answer(*values)
            return [np.float32(of) for of in found] if isinstance(found, tuple) else np.float32(found)

        return listed


@dataclass(frozen=True)
class ShapeOfLists(Sinusoid):
    """The paper's shape, with such courses."""

    def swing(self, **limits):
        """Return them."""
        return Listed(super().swing(**limits))
