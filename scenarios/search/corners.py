"""Corner sampling: most quantities at an end of their range, every choice equally often, two events
at the same time.
"""

import numpy as np

from scenarios.search.found import Found
from scenarios.search.method import SearchSettings, search_method
from scenarios.search.space import Array, Space

_SHARES_AT_END = (1.0, 0.8, 0.6)
"""Shares of the quantities that are put at an end of their range [-]; one of them for each point.
"""

_AT_ONE_TIME = 0.5
"""Share of the points that have two events at the same time [-]."""


@search_method("corners")
class Corners:
    """Points at random corners of the cube; times and courses, whose ends mean nothing, anywhere in
    their range.

    Parameters
    ----------
    space, settings, generator : as of ``SEARCH_METHODS``
    """

    exhausted = False

    def __init__(
        self, space: Space, settings: SearchSettings, generator: np.random.Generator
    ) -> None:
        self._space, self._population, self._generator = space, settings.population, generator
        self._decks: dict[int, list[float]] = {i: [] for i in space.chosen}
        self._with_ends = np.array([of.has_ends for of in space.coordinates])

    def ask(self, _found: Found, room: int) -> Array:
        """Return as many corners as a turn has."""
        return np.array([self._corner() for _ in range(min(room, self._population))]).reshape(
            -1, self._space.dimension
        )

    def tell(self, _clearances: Array) -> None:
        """Learn nothing: no corner depends on another."""

    def _corner(self) -> Array:
        choices = {i: self._next_choice(i) for i in self._space.chosen}
        return self._space.tried(lambda: self._proposed(choices))

    def _proposed(self, choices: dict[int, float]) -> Array:
        generator, dimension = self._generator, self._space.dimension
        point = generator.random(dimension)
        at_end = self._with_ends & (generator.random(dimension) < generator.choice(_SHARES_AT_END))
        point[at_end] = generator.integers(2, size=int(at_end.sum()))
        for i, value in choices.items():
            point[i] = value
        return (
            self._space.at_one_time(point, generator)
            if generator.random() < _AT_ONE_TIME
            else point
        )

    def _next_choice(self, i: int) -> float:
        """Return the next choice of a coordinate: each comes once before any comes again."""
        deck = self._decks[i]
        if not deck:
            deck += self._generator.permutation(self._space.coordinates[i].values).tolist()
        return deck.pop()
