"""A search by several methods that take turns."""

from collections.abc import Callable, Mapping

import numpy as np

from scenarios.search.found import Found
from scenarios.search.method import SEARCH_METHODS, SearchMethod, SearchSettings
from scenarios.search.space import Array, Space

Try = Callable[[str, Array], Array]
"""Called with the name of a method and its points, shape (n, dimension); returns their clearances, shape (n,)."""


def methods_named(names: tuple[str, ...], space: Space, settings: SearchSettings, seed: int) -> dict[str, SearchMethod]:
    """Return search methods by name, each with a random generator of its own.

    Raises
    ------
    PluginError : there is no such method
    """
    generators = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(len(names)))
    return {name: SEARCH_METHODS.get(name)(space, settings, of) for name, of in zip(names, generators, strict=True)}


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

    Each turn adds ``population`` points to the budget of the method whose turn it is; what a batch of fixed size leaves of that
    stays for the method's next turn.

    Parameters
    ----------
    methods, space : by name, and the space that they were made for
    attempt : tries points
    population : points of a turn
    turns : number of turns; None for no limit
    within_time : whether there is time for another batch
    """
    found, budgets, turn = Found(space), dict.fromkeys(methods, 0), 0
    left = list(methods)
    while left and (turns is None or turn < turns) and within_time():
        name = left.pop(0)
        budgets[name] += population
        turn += 1
        while len(points := methods[name].ask(found, budgets[name])) and within_time():
            clearances = attempt(name, points)
            budgets[name] -= len(points)
            found.add(points, clearances)
            methods[name].tell(clearances)
        if not methods[name].exhausted:
            left.append(name)
    return found
