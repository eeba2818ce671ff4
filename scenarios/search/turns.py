"""A search by several methods that take turns."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

import numpy as np

from common.registry import PluginError
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
        with _explained(name, "when it was made"):
            methods[name] = kind(space, settings, np.random.default_rng(of))
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
            with _explained(name, "in tell()"):
                methods[name].tell(clearances)
        with _explained(name, "when it was asked for 'exhausted'"):
            exhausted = methods[name].exhausted
        if not exhausted:
            left.append(name)
    return found


def _asked(name: str, method: SearchMethod, found: Found, room: int, dimension: int) -> Array:
    """Return the points that a method proposes, shape (n, dimension), at most ``room``."""
    with _explained(name, "in ask()"):
        points = np.asarray(method.ask(found, room), dtype=np.float64)
    if points.size == 0:
        return np.empty((0, dimension))
    if points.ndim != 2 or points.shape[1] != dimension or len(points) > room:
        raise PluginError(
            f"search method '{name}' proposed points of shape {points.shape}; it was asked for at most {room} of {dimension}"
            f" coordinates each: let ask(found, room) return an array of shape (n, {dimension}), n up to room"
        )
    # Not a number is outside, too.
    if (outside := points[~((points >= -_ROUNDING) & (points <= 1.0 + _ROUNDING))]).size:
        raise PluginError(
            f"search method '{name}' proposed a coordinate of {outside[0]:g}; each lies from 0 to 1, over the range of its random"
            " variable: let ask(found, room) return such points alone"
        )
    return points


@contextmanager
def _explained(name: str, where: str) -> Iterator[None]:
    """Turn what a method raises into a PluginError of one line that names it, and where it did."""
    try:
        yield
    except Exception as error:
        what = " ".join(f"{type(error).__name__}: {error}".split())
        raise PluginError(f"search method '{name}' failed {where}: {what}") from error
