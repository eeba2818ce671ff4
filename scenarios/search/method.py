"""The search for the point of the unit cube with the least clearance: the space, the interface of a
search method and how to add one, and how several of them take turns.
"""

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


@dataclass(frozen=True, slots=True, kw_only=True)
class SearchSettings:
    """What a scenario says of its search, as far as methods need it.

    Attributes
    ----------
    population : points of a turn
    mutation : range of the differential weight of differential evolution
    recombination : probability with which it takes a coordinate from the mutant
    restarts : how often a method that is stuck may begin anew
    """

    population: int
    mutation: tuple[float, float] = (0.5, 1.0)
    recombination: float = 0.7
    restarts: int = 100


class SearchMethod(Protocol):
    """Proposes points of the unit cube, in batches, and learns from their clearances.

    Attributes
    ----------
    exhausted : whether it has nothing more to propose, ever
    """

    exhausted: bool

    def ask(self, found: Found, room: int) -> Array:
        """Return the points of its next batch, shape (n, dimension), at most ``room``.

        None, shape (0, dimension), where its next batch needs more room, or where it is exhausted.

        Parameters
        ----------
        found : what all methods together have tried
        room : number of points that there is room for in this turn
        """

    def tell(self, clearances: Array) -> None:
        """Take the clearances of the points of the last batch, shape (n,), in their order [m]."""


SEARCH_METHODS: Registry[Callable[..., Any]] = Registry(
    "search_method", folder="scenarios.search", methods=("ask", "tell")
)
"""Search methods by name. Each is called with the space, the settings and a random generator, and
returns a ``SearchMethod``.
"""

search_method = SEARCH_METHODS.register
"""Decorator that registers a search method by a name."""


_RANDOM_EVERY = 4
"""One start of so many is a random point: what no method has found yet is found from there alone."""


WORTHWHILE = 0.1
"""Improvement below which a search around a point counts as stuck, and looks for another place [m].
"""


class Starts:
    """The starting points of a method, one after the other.

    Parameters
    ----------
    space : that is searched
    restarts : number of starts after the first
    generator : of the random points
    """

    def __init__(self, space: Space, restarts: int, generator: np.random.Generator) -> None:
        self._space, self._left, self._generator = space, restarts + 1, generator
        self._used: list[Array] = []
        self._number = 0

    @property
    def exhausted(self) -> bool:
        """Return whether there are no more."""
        return self._left <= 0

    def next(self, found: Found) -> tuple[Array, float]:
        """Return the next start and its clearance, infinite where it is not known yet [m]."""
        self._left -= 1
        self._number += 1
        worst = None if self._number % _RANDOM_EVERY == 0 else found.worst(apart_from=self._used)
        point, clearance = worst or (self._space.random(self._generator, 1)[0], np.inf)
        self._used.append(point)
        return point.copy(), clearance

    def ended(self, point: Array) -> None:
        """Take the point at which the search from the last start ended: none begins there again."""
        self._used.append(point)


Try = Callable[[str, Array], Array]
"""Called with the name of a method and its points, shape (n, dimension); returns their clearances,
shape (n,).
"""

_ROUNDING = 1e-9
"""By how much a coordinate may lie outside of the unit cube [-]."""


def methods_named(
    names: tuple[str, ...], space: Space, settings: SearchSettings, seed: int
) -> dict[str, SearchMethod]:
    """Return search methods by name, each with a random generator of its own.

    Raises
    ------
    PluginError : there is no such method, or it cannot be made
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
    """Search until the budget is spent or every method is exhausted.

    Each turn adds ``population`` points to the budget of the method whose turn it is; what a batch
    of fixed size leaves of that stays for the method's next turn.

    Parameters
    ----------
    methods, space : by name, and the space that they were made for
    attempt : tries points
    population : points of a turn
    turns : number of turns; None for no limit
    within_time : whether there is time for another batch

    Raises
    ------
    PluginError : a method raised an error, or proposed what are no points of the unit cube, or more
        than it was asked for
    """
    found, budgets, turn = Found(space), dict.fromkeys(methods, 0), 0
    left = list(methods)
    while left and (turns is None or turn < turns) and within_time():
        name = left.pop(0)
        budgets[name] += population
        turn += 1
        while (
            len(points := _asked(name, methods[name], found, budgets[name], space.dimension))
            and within_time()
        ):
            clearances = attempt(name, points)
            budgets[name] -= len(points)
            found.add(points, clearances)
            call_plugin(_named(name), methods[name].tell, clearances)
        if not call_plugin(_named(name), exhausted, methods[name]):
            left.append(name)
    return found


def _asked(name: str, method: SearchMethod, found: Found, room: int, dimension: int) -> Array:
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
        # NaN is outside, too.
        if not ((of >= -_ROUNDING) & (of <= 1.0 + _ROUNDING)).all():
            raise ValueError(
                "points whose coordinates lie from 0 to 1, over the range of a variable"
            )
        return of

    return call_plugin(_named(name), method.ask, found, room, result=points)


def exhausted(method: SearchMethod) -> bool:
    """Return whether a method has nothing left to propose."""
    return method.exhausted


def _named(name: str) -> str:
    return f"search method '{name}'"
