"""Search methods: corners, a local climb, CMA-ES and differential evolution."""

import math
from typing import Any

import numpy as np

from scenarios.search.method import (
    WORTHWHILE,
    Array,
    Found,
    SearchSettings,
    Space,
    Starts,
    search_method,
)

_SHARES_AT_END = (1.0, 0.8, 0.6)
"""Fractions of the quantities at an end of their range, one fraction for each point [-]."""

_CORNERS_AT_ONE_TIME = 0.5
"""Fraction of the points with two events at the same time [-]."""


@search_method("corners")
class Corners:
    """Tries random corners of the cube.

    Most quantities are at an end of their range, every choice occurs equally often, and two events
    may be at the same time. Times and courses, whose ends are not extremes, are random.

    Parameters
    ----------
    space, settings, generator : as in ``SEARCH_METHODS``
    """

    exhausted = False

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._population, self._generator = space, settings.population, generator
        self._decks: dict[int, list[float]] = {i: [] for i in space.chosen}
        self._with_ends = np.array([of.has_ends for of in space.coordinates])

    def ask(self, _found: Found, room: int) -> Array:
        """Return the corners of one turn."""
        return np.array([self._corner() for _ in range(min(room, self._population))]).reshape(
            -1, self._space.dimension
        )

    def tell(self, _clearances: Array) -> None:
        """Do nothing, because no corner depends on another."""

    def _corner(self) -> Array:
        choices = {i: self._next_choice(i) for i in self._space.chosen}
        return self._space.first_allowed(lambda: self._proposed(choices))

    def _proposed(self, choices: dict[int, float]) -> Array:
        generator, dimension = self._generator, self._space.dimension
        point = generator.random(dimension)
        at_end = self._with_ends & (generator.random(dimension) < generator.choice(_SHARES_AT_END))
        point[at_end] = generator.integers(2, size=int(at_end.sum()))
        for i, value in choices.items():
            point[i] = value
        return (
            self._space.with_equal_times(point, generator)
            if generator.random() < _CORNERS_AT_ONE_TIME
            else point
        )

    def _next_choice(self, i: int) -> float:
        """Return the next choice of a coordinate; none is repeated before all have come."""
        deck = self._decks[i]
        if not deck:
            deck += self._generator.permutation(self._space.coordinates[i].values).tolist()
        return deck.pop()


_BATCH = 8
"""Number of points tried around the best one before the step is adapted."""

_CLIMB_FIRST_STEP, _CLIMB_LONGEST_STEP, _CLIMB_SHORTEST_STEP = 0.2, 0.4, 0.01
"""Step sizes, as sigma of each coordinate [-]; a climb ends below the shortest."""

_LONGER, _SHORTER = 1.3, 0.75
"""Factors of the step size after a batch with a worthwhile improvement, and without one [-]."""

_MOVED = 0.25
"""Fraction of the coordinates that a step changes [-].

With more coordinates, irrelevant changes would hide a relevant one.
"""

_CHOSEN_ANEW = 0.05
"""Probability that a step draws a new choice [-]."""

_STEPS_AT_ONE_TIME = 0.05
"""Probability that a step makes two times equal [-]."""


@search_method("local")
class LocalClimb:
    """Climbs to violations by random steps from the worst points, one climb after the other.

    Steps get longer after a success and shorter after a failure. A climb ends at a violation, or
    when its steps are short.

    Parameters
    ----------
    space, settings, generator : as in ``SEARCH_METHODS``
    """

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._generator = space, generator
        self._starts = Starts(space, settings.restarts, generator)
        self._best: Array | None = None
        self._least, self._step = math.inf, _CLIMB_FIRST_STEP
        self._proposed = np.empty((0, space.dimension))

    @property
    def exhausted(self) -> bool:
        """Return whether every climb has ended."""
        return self._best is None and self._starts.exhausted

    def ask(self, found: Found, room: int) -> Array:
        """Return points near the best point of this climb."""
        if self.exhausted or room < _BATCH:
            return np.empty((0, self._space.dimension))
        if self._best is None:
            self._best, self._least = self._starts.next(found)
            self._step = _CLIMB_FIRST_STEP
        best = self._best
        steps = [self._space.first_allowed(lambda: self._stepped(best)) for _ in range(_BATCH)]
        if math.isinf(self._least):
            steps[0] = best.copy()
        self._proposed = np.array(steps)
        return self._proposed

    def _stepped(self, best: Array) -> Array:
        generator, point = self._generator, best.copy()
        moved = generator.random(len(point)) < _MOVED
        moved[generator.integers(len(point))] = True
        for i in np.flatnonzero(moved):
            of = self._space.coordinates[i]
            if not of.choices:
                step = point[i] + self._step * generator.standard_normal()
                point[i] = step % 1.0 if of.circle else min(max(step, 0.0), 1.0)
            elif generator.random() < _CHOSEN_ANEW / _MOVED:
                point[i] = generator.choice(of.values)
        return (
            self._space.with_equal_times(point, generator)
            if generator.random() < _STEPS_AT_ONE_TIME
            else point
        )

    def tell(self, clearances: Array) -> None:
        """Move to the best point if it is better; end a climb that has succeeded or is stuck."""
        i = int(np.argmin(clearances))
        worthwhile = bool(clearances[i] < self._least - WORTHWHILE)
        if clearances[i] < self._least:
            self._best, self._least = self._proposed[i], float(clearances[i])
        self._step = min(self._step * (_LONGER if worthwhile else _SHORTER), _CLIMB_LONGEST_STEP)
        if self._best is not None and (self._least < 0.0 or self._step < _CLIMB_SHORTEST_STEP):
            self._starts.ended(self._best)
            self._best = None


_CMA_FIRST_STEP, _CMA_SHORTEST_STEP = 0.15, 0.005
"""Step sizes, as sigma of each coordinate [-]; a search ends below the shortest."""

_CMA_GENERATIONS_STUCK = 12
"""Number of generations without a worthwhile improvement after which a search restarts."""

_LEAST_COORDINATES = 2
"""Least number of continuous coordinates that CMA-ES can search."""


@search_method("cma")
class CovarianceMatrixAdaptation:
    """CMA-ES (Hansen, arXiv:1604.00772) by the package ``cma``.

    The covariance of the steps follows from successful steps. Only continuous coordinates are
    searched; choices keep their values at the start point.

    Parameters
    ----------
    space, settings, generator : as in ``SEARCH_METHODS``
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
        self._sample: list[Array] = []
        self._least, self._stale = math.inf, 0

    @property
    def exhausted(self) -> bool:
        """Return whether every search has ended, or there are too few continuous coordinates."""
        return len(self._free) < _LEAST_COORDINATES or (
            self._strategy is None and self._starts.exhausted
        )

    def ask(self, found: Found, room: int) -> Array:
        """Return a sample of the search distribution."""
        if self.exhausted or room < self._size:
            return np.empty((0, self._space.dimension))
        if self._strategy is None:
            self._begin(found)
        self._sample = self._strategy.ask()
        points = np.tile(self._start, (len(self._sample), 1))
        points[:, self._free] = np.clip(self._sample, 0.0, 1.0)
        return points

    def _begin(self, found: Found) -> None:
        import cma

        self._start, self._least = self._starts.next(found)
        self._best, self._stale = self._start, 0
        options = {
            "bounds": [0.0, 1.0],
            "popsize": self._size,
            "randn": lambda *shape: self._generator.standard_normal(shape),
            # NaN keeps the package from seeding NumPy's global generator.
            "seed": math.nan,
            "verbose": -9,
        }
        self._strategy = cma.CMAEvolutionStrategy(
            self._start[self._free].tolist(), _CMA_FIRST_STEP, options
        )

    def tell(self, clearances: Array) -> None:
        """Update the distribution; restart after a violation, or if it is narrow or stuck."""
        self._strategy.tell(self._sample, clearances.tolist())
        i = int(np.argmin(clearances))
        self._stale = 0 if clearances[i] < self._least - WORTHWHILE else self._stale + 1
        if clearances[i] < self._least:
            self._least = float(clearances[i])
            self._best = self._start.copy()
            self._best[self._free] = self._sample[i]
        stuck = self._stale >= _CMA_GENERATIONS_STUCK or self._strategy.sigma < _CMA_SHORTEST_STEP
        if self._least < 0.0 or stuck or self._strategy.stop():
            self._starts.ended(self._best)
            self._strategy = None


_DE_GENERATIONS_STUCK = 15
"""Number of generations without improvement after which a new population begins."""


@search_method("differential_evolution")
class DifferentialEvolution:
    """Differential evolution (Storn and Price, J. Glob. Optim. 11, 1997), strategy best/1/bin.

    The differential weight is sampled for each generation. A population begins with a Sobol
    sequence.

    Parameters
    ----------
    space, settings, generator : as in ``SEARCH_METHODS``
    """

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._settings, self._generator = space, settings, generator
        self._points, self._clearances = self._first(), np.full(settings.population, math.inf)
        self._proposed, self._begun, self._stale, self._restarts = self._points, False, 0, 0
        self.exhausted = False

    def _first(self) -> Array:
        """Return a Sobol sequence; random points replace points beyond the declared ranges."""
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
        # Points outside are moved to the cube's surface: the worst often is at the end of a range.
        return np.clip(np.where(taken, mutants, self._points), 0.0, 1.0)

    def tell(self, clearances: Array) -> None:
        """Keep the one with the smaller clearance of each member and its offspring."""
        better, least = clearances < self._clearances, self._clearances.min()
        self._points = np.where(better[:, None], self._proposed, self._points)
        self._clearances = np.where(better, clearances, self._clearances)
        self._begun, self._stale = True, 0 if clearances.min() < least else self._stale + 1
        if self._stale >= _DE_GENERATIONS_STUCK:
            self._restart()

    def _restart(self) -> None:
        self._restarts += 1
        self.exhausted = self._restarts > self._settings.restarts
        self._points = self._proposed = self._first()
        self._clearances = np.full(len(self._points), math.inf)
        self._begun, self._stale = False, 0


def _two_others(generator: np.random.Generator, population: int, i: int) -> Array:
    """Return two different members of a population other than ``i``."""
    found = generator.choice(population - 1, size=2, replace=False)
    return np.where(found >= i, found + 1, found)
