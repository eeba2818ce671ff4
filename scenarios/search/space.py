"""The unit cube that is searched, and what is known of each coordinate."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from scenarios.search.coordinate import Coordinate

Array = npt.NDArray[np.float64]

ALIKE = 0.15
"""Root mean square difference of coordinates below which two points count as alike [-]."""

_TRIES = 100


def _anywhere(_: Array) -> float:
    return 0.0


@dataclass(frozen=True, kw_only=True)
class Space:
    """The unit cube of the quantities that are searched.

    Attributes
    ----------
    coordinates : one for each quantity
    beyond : how far beyond the declared ranges a point gets; 0 for one that can be tried [-]
    """

    coordinates: tuple[Coordinate, ...]
    beyond: Callable[[Array], float] = _anywhere

    @property
    def dimension(self) -> int:
        """Return the number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def continuous(self) -> tuple[int, ...]:
        """Return which coordinates take any value."""
        return tuple(i for i, of in enumerate(self.coordinates) if not of.choices)

    @cached_property
    def chosen(self) -> tuple[int, ...]:
        """Return which coordinates are choices."""
        return tuple(i for i, of in enumerate(self.coordinates) if of.choices)

    @cached_property
    def time_pairs(self) -> tuple[tuple[int, int], ...]:
        """Return the pairs of coordinates that are times whose ranges overlap."""
        times = [
            (i, of.time_range) for i, of in enumerate(self.coordinates) if of.time_range is not None
        ]
        return tuple(
            (i, j)
            for k, (i, one) in enumerate(times)
            for j, other in times[k + 1 :]
            if max(one[0], other[0]) < min(one[1], other[1])
        )

    def random(self, generator: np.random.Generator, number: int) -> Array:
        """Return random points within the declared ranges, shape (number, dimension)."""
        return np.array(
            [self.tried(lambda: generator.random(self.dimension)) for _ in range(number)]
        )

    def tried(self, propose: Callable[[], Array]) -> Array:
        """Return the first of some proposals that lies within the declared ranges; after many, the
        last.
        """
        point = propose()
        for _ in range(_TRIES):
            if not self.beyond(point):
                break
            point = propose()
        return point

    def at_one_time(self, point: Array, generator: np.random.Generator) -> Array:
        """Return the point with two of its times made equal, at a random time; unchanged where none
        overlap.
        """
        if not self.time_pairs:
            return point
        pair = self.time_pairs[int(generator.integers(len(self.time_pairs)))]
        (low, high), (other_low, other_high) = (
            self.coordinates[i].time_range or (0.0, 1.0) for i in pair
        )
        time = generator.uniform(max(low, other_low), min(high, other_high))
        moved = point.copy()
        for i, (begins, ends) in zip(pair, ((low, high), (other_low, other_high)), strict=True):
            moved[i] = (time - begins) / (ends - begins)
        return moved

    def alike(self, one: Array, other: Array) -> bool:
        """Return whether two points are so close that they show the same; a realisation of noise
        does not count.
        """
        pairs = zip(self.coordinates, one.tolist(), other.tolist(), strict=True)
        return sum(of.difference(a, b) ** 2 for of, a, b in pairs) < ALIKE**2 * self.dimension
