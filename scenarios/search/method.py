"""The search space, the Protocol of a search method, and a search by several methods in turns."""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from common.plugins import call_plugin
from common.registry import Registry


@dataclass(frozen=True, slots=True, kw_only=True)
class Coordinate:
    """A coordinate of the unit cube.

    Attributes
    ----------
    choices : lower limit of each value of a choice, followed by 1; empty for a continuous
        coordinate
    time_range : first and last moment of a time [s]; None for anything else
    circle : whether 0 and 1 are the same, as for a course
    noise : whether the coordinate selects a realisation of noise
    """

    choices: tuple[float, ...] = ()
    time_range: tuple[float, float] | None = None
    circle: bool = False
    noise: bool = False

    @property
    def has_ends(self) -> bool:
        """Return whether 0 and 1 are extremes, unlike those of a time, a circle or a choice."""
        return not (self.choices or self.circle or self.time_range)

    @property
    def values(self) -> tuple[float, ...]:
        """Return the middle of each choice's interval; choices without weight are left out."""
        return tuple(
            0.5 * (low + high)
            for low, high in zip(self.choices, self.choices[1:], strict=False)
            if high > low
        )

    def difference(self, one: float, other: float) -> float:
        """Return the difference of two values: 0 or 1 for a choice, 0 for noise, else 0 to 1."""
        if self.noise:
            return 0.0
        if self.choices:
            return float(self._choice(one) != self._choice(other))
        apart = abs(one - other)
        return min(apart, 1.0 - apart) if self.circle else apart

    def _choice(self, value: float) -> int:
        return min(bisect_right(self.choices, value), len(self.choices) - 1)


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
    beyond : function that returns how far a point is beyond the declared ranges; 0 if it is allowed
        [-]
    """

    coordinates: tuple[Coordinate, ...]
    beyond: Callable[[Array], float] = _anywhere

    @property
    def dimension(self) -> int:
        """Return the number of coordinates."""
        return len(self.coordinates)

    @cached_property
    def continuous(self) -> tuple[int, ...]:
        """Return the indices of continuous coordinates."""
        return tuple(i for i, of in enumerate(self.coordinates) if not of.choices)

    @cached_property
    def chosen(self) -> tuple[int, ...]:
        """Return the indices of choices."""
        return tuple(i for i, of in enumerate(self.coordinates) if of.choices)

    @cached_property
    def time_pairs(self) -> tuple[tuple[int, int], ...]:
        """Return the pairs of times whose ranges overlap, as indices of coordinates."""
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
            [self.first_allowed(lambda: generator.random(self.dimension)) for _ in range(number)]
        )

    def first_allowed(self, propose: Callable[[], Array]) -> Array:
        """Return the first proposal within the declared ranges; after many tries, the last one."""
        point = propose()
        for _ in range(_TRIES):
            if not self.beyond(point):
                break
            point = propose()
        return point

    def with_equal_times(self, point: Array, generator: np.random.Generator) -> Array:
        """Return a point with two of its times equal, at a random time, if any of them overlap."""
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
        """Return whether two points are close to each other; noise does not count."""
        pairs = zip(self.coordinates, one.tolist(), other.tolist(), strict=True)
        return sum(of.difference(a, b) ** 2 for of, a, b in pairs) < ALIKE**2 * self.dimension


class Found:
    """The points that have been tried, and their clearances.

    Parameters
    ----------
    space : search space
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
        """Return the most promising start point and its clearance, or None.

        It is the point of least clearance that is neither a violation nor close to one, because
        known violations need no further search.

        Parameters
        ----------
        apart_from : further points to which it must not be close
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


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """Settings of a scenario's search for search methods.

    Attributes
    ----------
    population : number of points per turn
    mutation : range of the weight of differential evolution
    recombination : probability of taking a coordinate from the mutant in differential evolution
    restarts : number of restarts of a method that is stuck
    """

    population: int
    mutation: tuple[float, float] = (0.5, 1.0)
    recombination: float = 0.7
    restarts: int = 100


class SearchMethod(Protocol):
    """Proposes points of the unit cube in batches, and receives their clearances.

    Attributes
    ----------
    exhausted : whether the method has no further points to propose
    """

    exhausted: bool

    def ask(self, found: Found, room: int) -> Array:
        """Return the points of the next batch, shape (n, dimension), with n up to ``room``.

        n is 0 if the next batch needs more room, or if the method is exhausted.

        Parameters
        ----------
        found : points that all methods have tried
        room : largest number of points in this turn
        """

    def tell(self, clearances: Array) -> None:
        """Receive the clearances of the last batch's points in their order, shape (n,) [m]."""


SEARCH_METHODS: Registry[Callable[..., Any]] = Registry(
    "search_method", folder="scenarios.search", methods=("ask", "tell")
)
"""Search methods by name.

Each is called with the space, the settings and a random generator, and returns a ``SearchMethod``.
"""

search_method = SEARCH_METHODS.register
"""Decorator that registers a search method under a name."""


_RANDOM_EVERY = 4
"""Interval of random start points: only they lead to regions that no method has found yet."""


WORTHWHILE = 0.1
"""Least improvement with which a local search does not count as stuck [m]."""


class Starts:
    """The start points of a method, one after the other.

    Parameters
    ----------
    space : search space
    restarts : number of starts after the first
    generator : random generator of random start points
    """

    def __init__(self, space: Space, restarts: int, generator: np.random.Generator) -> None:
        self._space, self._left, self._generator = space, restarts + 1, generator
        self._used: list[Array] = []
        self._number = 0

    @property
    def exhausted(self) -> bool:
        """Return whether no start is left."""
        return self._left <= 0

    def next(self, found: Found) -> tuple[Array, float]:
        """Return the next start point and its clearance, infinite if it is unknown [m]."""
        self._left -= 1
        self._number += 1
        worst = None if self._number % _RANDOM_EVERY == 0 else found.worst(apart_from=self._used)
        point, clearance = worst or (self._space.random(self._generator, 1)[0], np.inf)
        self._used.append(point)
        return point.copy(), clearance

    def ended(self, point: Array) -> None:
        """Store the point at which a search ended, so that no other search starts there."""
        self._used.append(point)


Try = Callable[[str, Array], Array]
"""Function from a method's name and points, shape (n, dimension), to clearances, shape (n,)."""

_ROUNDING = 1e-9
"""Tolerance of coordinates outside of the unit cube [-]."""


def methods_named(
    names: tuple[str, ...], space: Space, settings: SearchSettings, seed: int
) -> dict[str, SearchMethod]:
    """Return search methods by name, each with its own random generator.

    Raises
    ------
    PluginError : a method does not exist or cannot be created
    """
    methods: dict[str, SearchMethod] = {}
    for name, of in zip(names, np.random.SeedSequence(seed).spawn(len(names)), strict=True):
        kind = SEARCH_METHODS.get(name)
        given = space, settings, np.random.default_rng(of)
        methods[name] = call_plugin(_named(name), kind, *given)
    return methods


def search_in_turns(
    methods: Mapping[str, SearchMethod],
    space: Space,
    attempt: Try,
    *,
    population: int,
    turns: int | None,
    within_time: Callable[[], bool] = lambda: True,
) -> Found:
    """Search until the turns or the time are used up, or every method is exhausted.

    In each turn the budget of one method grows by ``population`` points. A remainder that is too
    small for a batch stays for the method's next turn.

    Parameters
    ----------
    methods, space : methods by name, and their search space
    attempt : function that flies points and returns clearances
    population : number of points per turn
    turns : number of turns; None for no limit
    within_time : function that returns whether there is time for another batch

    Raises
    ------
    PluginError : a method raised an error, or proposed invalid or too many points
    """
    found, budgets, turn = Found(space), dict.fromkeys(methods, 0), 0
    left = list(methods)
    while left and (turns is None or turn < turns) and within_time():
        name = left.pop(0)
        budgets[name] += population
        turn += 1
        while (
            len(
                points := _proposed_points(
                    name, methods[name], found, budgets[name], space.dimension
                )
            )
            and within_time()
        ):
            clearances = attempt(name, points)
            budgets[name] -= len(points)
            found.add(points, clearances)
            call_plugin(_named(name), methods[name].tell, clearances)
        if not call_plugin(_named(name), exhausted, methods[name]):
            left.append(name)
    return found


def _proposed_points(
    name: str, method: SearchMethod, found: Found, room: int, dimension: int
) -> Array:
    """Return the points that a method proposes, shape (n, dimension), at most ``room``."""

    def points(proposed: Any) -> Array:
        try:
            of = np.asarray(proposed, dtype=np.float64)
        except (TypeError, ValueError):
            raise TypeError("points, an array of numbers") from None
        if of.size == 0:
            return np.empty((0, dimension))
        if of.ndim != 2 or of.shape[1] != dimension or len(of) > room:
            raise ValueError(f"up to {room} points, an array of shape (n, {dimension})")
        # NaN counts as outside as well.
        if not ((of >= -_ROUNDING) & (of <= 1.0 + _ROUNDING)).all():
            raise ValueError(
                "points whose coordinates lie from 0 to 1, over the range of a variable"
            )
        return of

    return call_plugin(_named(name), method.ask, found, room, result=points)


def exhausted(method: SearchMethod) -> bool:
    """Return whether a method has no further points to propose."""
    return method.exhausted


def _named(name: str) -> str:
    return f"search method '{name}'"
