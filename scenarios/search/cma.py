"""CMA-ES (Hansen, arXiv:1604.00772), by the package ``cma``: steps whose covariance follows from
those that succeeded.
"""

import math
from typing import Any

import numpy as np

from scenarios.search.found import Found
from scenarios.search.method import SearchSettings, search_method
from scenarios.search.space import Array, Space
from scenarios.search.starts import WORTHWHILE, Starts

_FIRST_STEP, _SHORTEST_STEP = 0.15, 0.005
"""Steps, one sigma of each coordinate [-]; a search ends below the shortest."""

_STUCK = 12
"""Generations in a row without a point that is better by a worthwhile amount, after which it begins
anew.
"""

_LEAST_COORDINATES = 2
"""Of a space that CMA-ES can search."""


@search_method("cma")
class CovarianceMatrixAdaptation:
    """CMA-ES over the coordinates that take any value; choices stay those of the point from which
    it began.

    Parameters
    ----------
    space, settings, generator : as of ``SEARCH_METHODS``
    """

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._generator = space, generator
        self._free = list(space.continuous)
        self._size = 4 + int(3.0 * math.log(max(len(self._free), 1)))
        self._starts = Starts(space, settings.restarts, generator)
        self._strategy: Any = None
        self._start = self._best = np.empty(0)
        self._asked: list[Array] = []
        self._least, self._stale = math.inf, 0

    @property
    def exhausted(self) -> bool:
        """Return whether every search has ended, or there is nothing that it could search."""
        return len(self._free) < _LEAST_COORDINATES or (
            self._strategy is None and self._starts.exhausted
        )

    def ask(self, found: Found, room: int) -> Array:
        """Return a sample of its distribution."""
        if self.exhausted or room < self._size:
            return np.empty((0, self._space.dimension))
        if self._strategy is None:
            self._begin(found)
        self._asked = self._strategy.ask()
        points = np.tile(self._start, (len(self._asked), 1))
        points[:, self._free] = np.clip(self._asked, 0.0, 1.0)
        return points

    def _begin(self, found: Found) -> None:
        import cma

        self._start, self._least = self._starts.next(found)
        self._best, self._stale = self._start, 0
        options = {
            "bounds": [0.0, 1.0],
            "popsize": self._size,
            "randn": lambda *shape: self._generator.standard_normal(shape),
            # The package's own generator is global; this one is the search's.
            "seed": math.nan,
            "verbose": -9,
        }
        self._strategy = cma.CMAEvolutionStrategy(
            self._start[self._free].tolist(), _FIRST_STEP, options
        )

    def tell(self, clearances: Array) -> None:
        """Move and shape the distribution; begin anew after a violation, or where it is narrow or
        nothing gets better.
        """
        self._strategy.tell(self._asked, clearances.tolist())
        i = int(np.argmin(clearances))
        self._stale = 0 if clearances[i] < self._least - WORTHWHILE else self._stale + 1
        if clearances[i] < self._least:
            self._least = float(clearances[i])
            self._best = self._start.copy()
            self._best[self._free] = self._asked[i]
        stuck = self._stale >= _STUCK or self._strategy.sigma < _SHORTEST_STEP
        if self._least < 0.0 or stuck or self._strategy.stop():
            self._starts.ended(self._best)
            self._strategy = None
