"""One quantity that is searched, as a coordinate from 0 to 1."""

from bisect import bisect_right
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Coordinate:
    """A coordinate of the unit cube.

    Attributes
    ----------
    choices : of a choice, where each of its values begins and, last, 1; empty for a coordinate that
        takes any value
    time_range : of a time, its first and its last moment [s]; None for anything else
    circle : whether 0 and 1 are the same, as in a course
    noise : whether it is the choice of a realisation of noise
    """

    choices: tuple[float, ...] = ()
    time_range: tuple[float, float] | None = None
    circle: bool = False
    noise: bool = False

    @property
    def has_ends(self) -> bool:
        """Return whether 0 and 1 are extremes of the quantity: not those of a time, a circle or a
        choice.
        """
        return not (self.choices or self.circle or self.time_range)

    @property
    def values(self) -> tuple[float, ...]:
        """Return a coordinate of each choice that has any weight, in the middle of its interval."""
        return tuple(
            0.5 * (low + high)
            for low, high in zip(self.choices, self.choices[1:], strict=False)
            if high > low
        )

    def difference(self, one: float, other: float) -> float:
        """Return how much two values differ, from 0 to 1: of a choice, wholly or not at all; of
        noise, not at all.
        """
        if self.noise:
            return 0.0
        if self.choices:
            return float(self._choice(one) != self._choice(other))
        apart = abs(one - other)
        return min(apart, 1.0 - apart) if self.circle else apart

    def _choice(self, value: float) -> int:
        return min(bisect_right(self.choices, value), len(self.choices) - 1)
