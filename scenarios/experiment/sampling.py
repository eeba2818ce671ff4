"""Points that spread evenly over the unit cube of the random variables, one per flight."""

import functools
from collections.abc import Sequence

import numpy as np

_BLOCK = 256
"""Points that are made together: a Sobol sequence is balanced over powers of two."""


class Points:
    """The points of a study, by the numbers of its flights.

    Parameters
    ----------
    sampling : ``sobol``, scrambled; ``latin_hypercube`` of as many strata as there are flights;
        ``random`` for no points at all
    dimension : number of keys that are sampled
    flights, seed : of the study
    """

    def __init__(self, sampling: str, *, dimension: int, flights: int, seed: int) -> None:
        self._sampling, self._dimension, self._flights, self._seed = (
            sampling,
            dimension,
            flights,
            seed,
        )
        self._block = functools.lru_cache(maxsize=4)(self._made)

    def at(self, number: int) -> tuple[float, ...]:
        """Return the point of a flight, which depends on its number and the parameters alone; empty
        if it has none.
        """
        if self._sampling == "random" or not self._dimension:
            return ()
        if self._sampling == "latin_hypercube":
            return tuple(self._block(0)[number])
        block, i = divmod(number, _BLOCK)
        return tuple(self._block(block)[i])

    def _made(self, block: int) -> Sequence[Sequence[float]]:
        from scipy.stats import qmc

        if self._sampling == "latin_hypercube":
            design: np.ndarray = qmc.LatinHypercube(self._dimension, rng=self._seed).random(
                self._flights
            )
        else:
            sequence = qmc.Sobol(self._dimension, scramble=True, rng=self._seed)
            if block:
                sequence.fast_forward(block * _BLOCK)
            design = sequence.random(_BLOCK)
        points: list[list[float]] = design.tolist()
        return points
