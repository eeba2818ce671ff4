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
        """Return the point from which another violation may be near, and its clearance; None
        without one.

        That is the one of least clearance that neither violates nor is like a point that does: what
        is found there is known.

        Parameters
        ----------
        apart_from : points that it must not be like either
        """
        violating = [
            point
            for point, clearance in zip(self._points, self._clearances, strict=True)
            if clearance < 0.0
        ]
        for i in self._order():
            if self._clearances[i] >= 0.0 and not any(
                self._space.alike(self._points[i], other) for other in (*apart_from, *violating)
            ):
                return self._points[i], self._clearances[i]
        return None

    def _order(self) -> Iterator[int]:
        return iter(np.argsort(self._clearances, kind="stable").tolist())
