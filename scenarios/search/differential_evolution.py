"""Differential evolution (Storn and Price, J. Glob. Optim. 11, 1997): a population that is
recombined with its best.
"""

import math

import numpy as np

from scenarios.search.found import Found
from scenarios.search.method import SearchSettings, search_method
from scenarios.search.space import Array, Space

_STUCK = 15
"""Generations in a row whose best is no better, after which a new population begins."""


@search_method("differential_evolution")
class DifferentialEvolution:
    """The strategy best/1/bin, with a differential weight that is sampled for each generation; it
    begins with a Sobol sequence.

    Parameters
    ----------
    space, settings, generator : as of ``SEARCH_METHODS``
    """

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._settings, self._generator = space, settings, generator
        self._points, self._clearances = self._first(), np.full(settings.population, math.inf)
        self._proposed, self._begun, self._stale, self._restarts = self._points, False, 0, 0
        self.exhausted = False

    def _first(self) -> Array:
        """Return a Sobol sequence, in which random points replace those beyond the declared ranges."""
        from scipy.stats import qmc

        population = self._settings.population
        sequence = qmc.Sobol(self._space.dimension, scramble=True, rng=self._generator)
        first: Array = sequence.random(1 << math.ceil(math.log2(population)))[:population]
        return np.array(
            [
                self._space.random(self._generator, 1)[0] if self._space.beyond(point) else point
                for point in first
            ]
        )

    def ask(self, _found: Found, room: int) -> Array:
        """Return the next generation."""
        if room < len(self._points):
            return np.empty((0, self._space.dimension))
        if self._begun:
            self._proposed = self._recombined()
        return self._proposed

    def _recombined(self) -> Array:
        generator, (population, dimension) = self._generator, self._points.shape
        weight = generator.uniform(*self._settings.mutation)
        best = self._points[int(np.argmin(self._clearances))]
        others = np.array([_two_others(generator, population, i) for i in range(population)])
        mutants = best + weight * (self._points[others[:, 0]] - self._points[others[:, 1]])
        taken = generator.random((population, dimension)) < self._settings.recombination
        taken[np.arange(population), generator.integers(dimension, size=population)] = True
        # What leaves the cube is put on its surface: the worst often lies at the end of a range.
        return np.clip(np.where(taken, mutants, self._points), 0.0, 1.0)

    def tell(self, clearances: Array) -> None:
        """Keep of each member and its offspring the one with the smaller clearance."""
        better, least = clearances < self._clearances, self._clearances.min()
        self._points = np.where(better[:, None], self._proposed, self._points)
        self._clearances = np.where(better, clearances, self._clearances)
        self._begun, self._stale = True, 0 if clearances.min() < least else self._stale + 1
        if self._stale >= _STUCK:
            self._restart()

    def _restart(self) -> None:
        self._restarts += 1
        self.exhausted = self._restarts > self._settings.restarts
        self._points = self._proposed = self._first()
        self._clearances = np.full(len(self._points), math.inf)
        self._begun, self._stale = False, 0


def _two_others(generator: np.random.Generator, population: int, i: int) -> Array:
    """Return two different members of a population, neither of them ``i``."""
    found = generator.choice(population - 1, size=2, replace=False)
    return np.where(found >= i, found + 1, found)
