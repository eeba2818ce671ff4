"""A local climb to a violation: random steps from one of the worst points, longer after a success,
shorter after a failure.
"""

import math

import numpy as np

from scenarios.search.found import Found
from scenarios.search.method import SearchSettings, search_method
from scenarios.search.space import Array, Space
from scenarios.search.starts import WORTHWHILE, Starts

_BATCH = 8
"""Points that are tried from one place, before the step follows from what came of them."""

_FIRST_STEP, _LONGEST_STEP, _SHORTEST_STEP = 0.2, 0.4, 0.01
"""Steps, one sigma of each coordinate [-]; a climb ends below the shortest."""

_LONGER, _SHORTER = 1.3, 0.75
"""Factors of the step after a batch with a point that is better by a worthwhile amount, and after
one without.
"""

_MOVED = 0.25
"""Share of the coordinates that a step changes [-]: a few at a time, or one that matters is lost
among those that do not.
"""

_CHOSEN_ANEW = 0.05
"""Probability that a step takes a choice anew [-]."""

_AT_ONE_TIME = 0.05
"""Probability that a step makes two times equal [-]."""


@search_method("local")
class LocalClimb:
    """Climbs, one after the other, each until it finds a violation or its steps become short.

    Parameters
    ----------
    space, settings, generator : as of ``SEARCH_METHODS``
    """

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._generator = space, generator
        self._starts = Starts(space, settings.restarts, generator)
        self._best: Array | None = None
        self._least, self._step = math.inf, _FIRST_STEP
        self._proposed = np.empty((0, space.dimension))

    @property
    def exhausted(self) -> bool:
        """Return whether every climb has ended."""
        return self._best is None and self._starts.exhausted

    def ask(self, found: Found, room: int) -> Array:
        """Return points about the best one of this climb."""
        if self.exhausted or room < _BATCH:
            return np.empty((0, self._space.dimension))
        if self._best is None:
            self._best, self._least = self._starts.next(found)
            self._step = _FIRST_STEP
        best = self._best
        steps = [self._space.tried(lambda: self._stepped(best)) for _ in range(_BATCH)]
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
            self._space.at_one_time(point, generator)
            if generator.random() < _AT_ONE_TIME
            else point
        )

    def tell(self, clearances: Array) -> None:
        """Go to the best of them if it is better; end the climb at a violation, or where steps have
        become short.
        """
        i = int(np.argmin(clearances))
        worthwhile = bool(clearances[i] < self._least - WORTHWHILE)
        if clearances[i] < self._least:
            self._best, self._least = self._proposed[i], float(clearances[i])
        self._step = min(self._step * (_LONGER if worthwhile else _SHORTER), _LONGEST_STEP)
        if self._best is not None and (self._least < 0.0 or self._step < _SHORTEST_STEP):
            self._starts.ended(self._best)
            self._best = None
