"""The levels of a subset simulation, and what they say of the probability of low values."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]
Indices = npt.NDArray[np.int64]


@dataclass(slots=True, kw_only=True)
class Counts:
    """What was tried for the sample of a level.

    Attributes
    ----------
    evaluated : number of points whose values were asked for
    moved, accepted : moves of the inputs, and those that were accepted
    blended, blended_accepted : moves of the blended noise, and those that were accepted
    renewed, renewed_accepted : renewals of a seed on which the value depends, and those that were
        accepted
    outside : moves to points that are not allowed, which were not evaluated
    """

    evaluated: int = 0
    moved: int = 0
    accepted: int = 0
    blended: int = 0
    blended_accepted: int = 0
    renewed: int = 0
    renewed_accepted: int = 0
    outside: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """The sample of one level.

    Attributes
    ----------
    below : values of the sample are at or below this; infinite for the first level
    threshold : that of the next level; 0 for the last one
    probability : fraction of the sample that passes ``threshold``: at or below it, and for the last
        level below 0 [-]
    variation : coefficient of variation of ``probability``, with the correlation within chains [-]
    points : shape (n, inputs), in the unit cube: positions of the inputs in their distributions
    dummies : shape (n, ``DUMMIES``), likewise
    values : shape (n,); infinite where there is none
    chains : number of the chain of each, shape (n,)
    counts : of what was tried
    scale, noise_scale : of the steps of inputs and of the blend at the end of the level [-]
    """

    below: float
    threshold: float
    probability: float
    variation: float
    points: Array
    dummies: Array
    values: Array
    chains: Indices
    counts: Counts
    scale: float
    noise_scale: float

    @property
    def beginnings(self) -> int:
        """Return from how many different states its chains began: of states that passed, some are
        copies of one that stayed.
        """
        _, first = np.unique(self.chains, return_index=True)
        return len(np.unique(np.column_stack([self.points[first], self.values[first]]), axis=0))


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulation:
    """One subset simulation.

    Attributes
    ----------
    levels : the first of them plain
    stalled : whether no threshold below the last one could be found, because all of a level has one
        value
    """

    levels: tuple[Level, ...]
    stalled: bool

    @property
    def reached(self) -> float:
        """Return the estimate of the probability of the last level [-]."""
        return math.prod(level.probability for level in self.levels[:-1])

    @property
    def reached_variation(self) -> float:
        """Return the coefficient of variation of ``reached`` [-]; see ``below``."""
        return math.sqrt(sum(level.variation**2 for level in self.levels[:-1]))

    def below(self, value: float) -> tuple[float, float]:
        """Return the estimate of the probability of values below ``value``, and its coefficient of
        variation [-].

        The coefficient is that of Au and Beck (2001), as if levels were independent; infinite where
        none is below.
        """
        reached, squares = 1.0, 0.0
        for level in self.levels:
            if value > level.threshold or level is self.levels[-1]:
                event = level.values < value
                return reached * float(np.mean(event)), math.hypot(
                    math.sqrt(squares), variation(event, level.chains)
                )
            reached *= level.probability
            squares += level.variation**2
        raise ValueError("a simulation has one level at least")


def variation(event: Mask, chains: Indices) -> float:
    """Return the coefficient of variation of the fraction of a level that has an event [-], by Au
    and Beck (2001).

    Parameters
    ----------
    event : which states have it, shape (n,), those of each chain in their order
    chains : number of the chain of each state, shape (n,)

    Returns
    -------
    variation : infinite if no state has the event
    """
    share, count = float(np.mean(event)), len(event)
    if share == 0.0:
        return math.inf
    order = np.argsort(chains, kind="stable")
    chain, centred = chains[order], event[order].astype(np.float64) - share
    factor, every = 1.0, share * (1.0 - share)
    for lag in range(1, int(np.bincount(chains).max())):
        together = chain[lag:] == chain[:-lag]
        if every and together.any():
            # Twice the covariance at this lag, by the number of pairs that have it.
            factor += (
                2.0
                * float(np.sum(centred[lag:][together] * centred[:-lag][together]))
                / (count * every)
            )
    return math.sqrt((1.0 - share) / (share * count) * max(factor, 1.0))
