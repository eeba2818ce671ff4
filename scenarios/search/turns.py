"""A search by several methods that take turns."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from common.plugins import call_plugin
from scenarios.search.found import Found
from scenarios.search.method import SEARCH_METHODS, SearchMethod, SearchSettings
from scenarios.search.space import Array, Space

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
