"""What several subset simulations say together: probability and interval, the same over the
threshold, and the inputs' shares.

Estimates of a simulation are skewed, about log-normal. So the mean of the distribution is estimated
from their logarithms, with the interval of Cox for the mean of a log-normal distribution, which for
few values takes Student's t: U. Olsson, "Confidence intervals for the mean of a log-normal
distribution", Journal of Statistics Education 13 (2005). Its deviation is that between the repeats,
or that which Au and Beck's formula gives within them (for correlated chains, levels independent),
whichever is larger: neither a lucky agreement of few repeats nor chains that hide their correlation
makes it narrow. Tests measure how often it holds what is true.

Where a simulation has reached no event, its estimate is 0 and its logarithm does not exist. There
the upper end is what it leaves open: with 0 of n chains of its last level in the event, 1 - (1 -
confidence)^(1/n) of that level's probability, as Clopper and Pearson have it. States of one chain
are alike, and so are chains that began at copies of one state: n is the number of different states
that they began at. If no simulation has reached any, all are judged at the threshold that even the
least of them has reached: where some came much nearer than others, the probability of that
threshold scatters, and the bound is the larger.

What all simulations have in their first levels needs none of that: together these are a plain
sample (Clopper and Pearson).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd
from scipy.special import stdtrit

from common.intervals import clopper_pearson, upper_bound
from scenarios.statistics.subset_levels import Array, Indices, Simulation

CURVE_POINTS = 80
"""Thresholds at which the probability is given."""

BINS = 20
"""Classes of the histogram of an input."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RareProbability:
    """A probability, estimated by several simulations.

    Attributes
    ----------
    estimate : [-]; the mean of the estimates where some of them are 0
    low, high : two-sided interval [-]
    upper : one-sided bound [-]
    reached : number of simulations that have reached the event
    """

    estimate: float
    low: float
    high: float
    upper: float
    reached: int


@dataclass(frozen=True, slots=True, kw_only=True)
class InputShift:
    """How an input is distributed near the event, against how it is declared.

    Attributes
    ----------
    key : of the input
    distance : largest difference of the two cumulative distributions, of Kolmogorov [-]
    median, median_near : medians as declared and near the event; None for words
    edges : of the classes, one more than there are; empty for words
    names : of the classes, for words; otherwise empty
    declared, near : fraction in each class [-]
    """

    key: str
    distance: float
    median: float | None
    median_near: float | None
    edges: tuple[float, ...]
    names: tuple[str, ...]
    declared: tuple[float, ...]
    near: tuple[float, ...]


def rare_probability(
    simulations: Sequence[Simulation], confidence: float, *, value: float = 0.0
) -> RareProbability:
    """Return the probability of values below ``value``, by all simulations together.

    Parameters
    ----------
    simulations : repeats, three at least, with their own random numbers
    confidence : of the interval, and of the one-sided bound, between 0 and 1
    value : below 0 there is no level, and the last one gives what it has
    """
    found = np.array([simulation.below(value) for simulation in simulations])
    estimates, reached = found[:, 0], found[:, 0] > 0.0
    two_sided, one_sided = 0.5 + 0.5 * confidence, confidence
    first = [simulation.levels[0] for simulation in simulations]
    if reached.any() and all(
        value > level.threshold or len(of.levels) == 1
        for level, of in zip(first, simulations, strict=True)
    ):
        return _of_plain_samples(
            np.concatenate([level.values for level in first]) < value,
            int(reached.sum()),
            confidence,
        )
    if reached.all():
        centre, deviation = _log_mean(estimates, found[:, 1])
        t = _t_quantile(two_sided, len(estimates)) * deviation
        return RareProbability(
            estimate=_at_most_one(centre),
            low=_at_most_one(centre - t),
            high=_at_most_one(centre + t),
            upper=_at_most_one(centre + _t_quantile(one_sided, len(estimates)) * deviation),
            reached=len(estimates),
        )
    high, upper = (
        _left_open(simulations, estimates, found[:, 1], level) for level in (two_sided, one_sided)
    )
    return RareProbability(
        estimate=float(estimates.mean()),
        low=0.0,
        high=high,
        upper=upper,
        reached=int(np.count_nonzero(reached)),
    )


def _of_plain_samples(
    event: npt.NDArray[np.bool_], reached: int, confidence: float
) -> RareProbability:
    """Return a probability that is not rare: first levels are plain samples, of which there is an
    exact interval.
    """
    events, trials = int(np.count_nonzero(event)), len(event)
    interval = clopper_pearson(events, trials, confidence)
    return RareProbability(
        estimate=events / trials,
        low=interval.low,
        high=interval.high,
        upper=upper_bound(events, trials, confidence),
        reached=reached,
    )


def _left_open(
    simulations: Sequence[Simulation], estimates: Array, variations: Array, confidence: float
) -> float:
    """Return an upper bound where some simulations have not reached the event.

    What may go wrong is shared equally between the probability of the last levels and the fraction
    of these.
    """
    half = 0.5 + 0.5 * confidence
    chains = [simulation.levels[-1].beginnings for simulation in simulations]
    if not estimates.any():
        common = max(simulation.levels[-1].below for simulation in simulations)
        if math.isinf(common):
            # A simulation has a plain sample alone; all together have at least these.
            return upper_bound(
                0, sum(len(simulation.levels[0].values) for simulation in simulations), confidence
            )
        # The next number above it: states at the threshold belong to it.
        levels, within = np.array(
            [simulation.below(math.nextafter(common, math.inf)) for simulation in simulations]
        ).T
        factor = upper_bound(0, sum(chains), half)
    else:
        open_levels = [
            simulation.reached * upper_bound(0, n, half)
            for simulation, n in zip(simulations, chains, strict=True)
        ]
        levels = np.where(estimates > 0.0, estimates, open_levels)
        within = np.where(
            estimates > 0.0,
            variations,
            [simulation.reached_variation for simulation in simulations],
        )
        factor = 1.0
    centre, deviation = _log_mean(levels, within)
    return _at_most_one(math.log(factor) + centre + _t_quantile(half, len(levels)) * deviation)


def _at_most_one(logarithm: float) -> float:
    """Return the probability with this logarithm; estimates that scatter by decades have means and
    bounds beyond any number.
    """
    return math.exp(min(0.0, logarithm))


def _log_mean(estimates: Array, variations: Array) -> tuple[float, float]:
    """Return the logarithm of the mean of a log-normal distribution, and its standard deviation."""
    count, logarithms = len(estimates), np.log(estimates)
    between = float(np.var(logarithms, ddof=1))
    variance = max(between, math.log1p(float(np.mean(variations**2))))
    return float(np.mean(logarithms)) + 0.5 * between, math.sqrt(
        variance / count + variance**2 / (2.0 * (count - 1))
    )


def _t_quantile(probability: float, count: int) -> float:
    return float(stdtrit(count - 1, probability))


def curve(
    simulations: Sequence[Simulation], confidence: float
) -> list[tuple[float, RareProbability]]:
    """Return the probability of values below each of some thresholds, from the lowest that all
    simulations have reached.
    """
    lowest = max(float(simulation.levels[-1].values.min()) for simulation in simulations)
    first = np.concatenate([simulation.levels[0].values for simulation in simulations])
    known = first[np.isfinite(first)]
    if not len(known) or not math.isfinite(lowest):
        return []
    highest = float(np.quantile(known, 0.9))
    values = np.unique(
        np.append(
            np.linspace(lowest, highest, CURVE_POINTS), 0.0 if lowest < 0.0 < highest else lowest
        )
    )
    found = [
        (float(value), rare_probability(simulations, confidence, value=float(value)))
        for value in values
    ]
    return [
        (value, probability)
        for value, probability in found
        if probability.reached == len(simulations)
    ]


def near_event(simulations: Sequence[Simulation]) -> list[tuple[Simulation, Indices]]:
    """Return of each simulation the indices of what its last level has below 0, or of all of it, if
    no simulation has any.
    """
    inside = [np.flatnonzero(simulation.levels[-1].values < 0.0) for simulation in simulations]
    every = [np.arange(len(simulation.levels[-1].values)) for simulation in simulations]
    return list(
        zip(simulations, inside if any(len(chosen) for chosen in inside) else every, strict=True)
    )


def input_shifts(
    declared: pd.DataFrame, near: pd.DataFrame, at: tuple[Array, Array]
) -> list[InputShift]:
    """Return how the inputs near the event differ from those that are declared, the largest
    distance first.

    Parameters
    ----------
    declared, near : values of the inputs of the first levels and of those near the event, a column
        per input
    at : the same in the unit cube, shapes (n, inputs)
    """
    shifts = [
        _shift(str(key), declared[key], near[key], distance(at[0][:, i], at[1][:, i]))
        for i, key in enumerate(declared.columns)
    ]
    return sorted(shifts, key=lambda shift: -shift.distance)


def noise_floor(simulations: Sequence[Simulation]) -> float:
    """Return the largest distance of what has no effect at all: that of the dummies, which move
    with the same chains.
    """
    first = np.concatenate([simulation.levels[0].dummies for simulation in simulations])
    last = np.concatenate(
        [simulation.levels[-1].dummies[chosen] for simulation, chosen in near_event(simulations)]
    )
    return max(distance(first[:, i], last[:, i]) for i in range(first.shape[1]))


def distance(one: Array, other: Array) -> float:
    """Return the largest difference of two cumulative distributions, of Kolmogorov and Smirnov [-]."""
    every = np.sort(np.concatenate([one, other]))
    shares = [
        np.searchsorted(np.sort(values), every, side="right") / len(values)
        for values in (one, other)
    ]
    return float(np.max(np.abs(shares[0] - shares[1])))


def _shift(
    key: str, declared: "pd.Series[float]", near: "pd.Series[float]", found: float
) -> InputShift:
    if pd.api.types.is_numeric_dtype(declared):
        both = np.concatenate(
            [declared.to_numpy(dtype=np.float64), near.to_numpy(dtype=np.float64)]
        )
        edges = np.histogram_bin_edges(both, bins=BINS)
        shares = [
            tuple((np.histogram(values, edges)[0] / len(values)).tolist())
            for values in (declared, near)
        ]
        medians = (float(declared.median()), float(near.median()))
        return InputShift(
            key=key, distance=found, median=medians[0], median_near=medians[1], edges=tuple(edges.tolist()), names=(),
            declared=shares[0], near=shares[1],
        )  # fmt: skip
    words = [declared.astype(str), near.astype(str)]
    names = tuple(dict.fromkeys([*sorted(words[0].unique()), *words[1].unique()]))
    counted = [tuple(float((values == name).mean()) for name in names) for values in words]
    return InputShift(
        key=key,
        distance=found,
        median=None,
        median_near=None,
        edges=(),
        names=names,
        declared=counted[0],
        near=counted[1],
    )
