"""Where a method that searches around one point begins: at the worst that does not violate yet,
each time at another.
"""

import numpy as np

from scenarios.search.found import Found
from scenarios.search.space import Array, Space

_RANDOM_EVERY = 4
"""Every how manieth start is a random point: what no method has found yet is found from there
alone.
"""


WORTHWHILE = 0.1
"""Improvement below which a search around a point counts as stuck, and looks for another place [m].
"""


class Starts:
    """The starting points of a method, one after the other.

    Parameters
    ----------
    space : that is searched
    restarts : number of starts after the first
    generator : of the random points
    """

    def __init__(self, space: Space, restarts: int, generator: np.random.Generator) -> None:
        self._space, self._left, self._generator = space, restarts + 1, generator
        self._used: list[Array] = []
        self._number = 0

    @property
    def exhausted(self) -> bool:
        """Return whether there are no more."""
        return self._left <= 0

    def next(self, found: Found) -> tuple[Array, float]:
        """Return the next start and its clearance, infinite where it is not known yet [m]."""
        self._left -= 1
        self._number += 1
        worst = None if self._number % _RANDOM_EVERY == 0 else found.worst(apart_from=self._used)
        point, clearance = worst or (self._space.random(self._generator, 1)[0], np.inf)
        self._used.append(point)
        return point.copy(), clearance

    def ended(self, point: Array) -> None:
        """Take the point at which the search from the last start ended: none begins there again."""
        self._used.append(point)
