"""What a search has tried so far, by all of its methods together."""

from collections.abc import Iterator, Sequence

import numpy as np
import numpy.typing as npt

from scenarios.search.space import Array, Space


class Found:
    """The points that were tried, and their clearances.

    Parameters
    ----------
    space : that is searched
    """

    def __init__(self, space: Space) -> None:
        self._space = space
        self._points: list[Array] = []
        self._clearances: list[float] = []

    def __len__(self) -> int:
        """Return the number of points."""
        return len(self._points)

    def add(self, points: Array, clearances: npt.ArrayLike) -> None:
        """Add points, shape (n, dimension), and their clearances, shape (n,)."""
        self._points += list(points)
        self._clearances += np.asarray(clearances, dtype=np.float64).tolist()

    def worst(self, apart_from: Sequence[Array] = ()) -> tuple[Array, float] | None:
        """Return the point of least clearance that is not like any of some others, and its clearance; None without one."""
        for i in self._order():
            if not any(self._space.alike(self._points[i], other) for other in apart_from):
                return self._points[i], self._clearances[i]
        return None

    def _order(self) -> Iterator[int]:
        return iter(np.argsort(self._clearances, kind="stable").tolist())
