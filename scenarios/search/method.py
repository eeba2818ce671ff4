"""The interface of a search method, and how to add one."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from common.registry import Registry
from scenarios.search.found import Found
from scenarios.search.space import Array


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
