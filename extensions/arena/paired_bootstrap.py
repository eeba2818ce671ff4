"""Means of several entrants over the same flights, and the entrants that may be the best: the
paired bootstrap.

Every entrant flies the same starts and the same air. The resampling draws these for all entrants
together, so that a common effect, such as a wind that is difficult for all of them, does not count
as a difference (B. Efron, R. J. Tibshirani, "An Introduction to the Bootstrap", 1993, chapters 8
and 13). Resamples of a few flights scatter too little: deviations from the mean of a stratum are
larger by sqrt(n/(n - 1)) here, and by Student's t over the normal quantile.

The best mean is selected from many, by the same flights. So an entrant counts as worse than the
best only if another is ahead of it by more than the largest lead that chance alone would give to
any entrant: multiple comparisons with the best (J. C. Hsu, "Multiple Comparisons", 1996, chapter
4), with each lead divided by its deviation. Among equal entrants, each is called worse in about one
arena of twenty, for any number of entrants; with only two flights in one of ten.

Where no stratum has two flights, every resample is the same: there is no interval, and no
difference is shown. An entrant without a figure that another has for the same flight is not
compared: its mean is over other flights, perhaps easier ones.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_STILL = 1e-9
"""Largest deviation of a lead, over the lead, that counts as rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """A mean of one entrant.

    Attributes
    ----------
    mean, low, high : mean over the flights, and its interval; NaN without one
    whole : whether it has the figure of every flight for which any entrant has it; otherwise it is
        not compared
    best : whether it is compared, and the mean of no other that is compared is better
    behind_low, behind_high : interval of the difference from the best entrant's mean; 0 for the
        best, not a number if not compared, or if there is no interval
    flights : number of flights with the figure
    as_good : whether it is compared, and the flights do not show that another is better
    """

    mean: float = math.nan
    low: float = math.nan
    high: float = math.nan
    whole: bool = False
    best: bool = False
    behind_low: float = math.nan
    behind_high: float = math.nan
    flights: int = 0
    as_good: bool = False


def paired_estimates(
    values: Array,
    strata: npt.ArrayLike,
    *,
    greater_is_better: bool,
    resamples: int,
    confidence: float,
    seed: int,
) -> list[Estimate]:
    """Return an estimate for each entrant.

    Parameters
    ----------
    values : shape (entrants, flights); the flights of a column share start and air; NaN where a
        flight has no figure
    strata : shape (flights,): which flights are resampled among themselves, such as those of a
        condition
    greater_is_better : whether a larger value is better
    resamples : number of resamples
    confidence : of the intervals
    seed : of the resampling
    """
    generator = np.random.default_rng(seed)
    strata = np.asarray(strata)
    columns = np.concatenate([
        members[generator.integers(len(members), size=(resamples, len(members)))]
        for stratum in dict.fromkeys(strata.tolist())
        for members in [np.flatnonzero(strata == stratum)]
    ], axis=1) if len(strata) else np.empty((resamples, 0), dtype=int)  # fmt: skip
    known = np.isfinite(values)
    whole = np.logical_and(known[:, known.any(axis=0)].all(axis=1), known.any())
    means = np.array([_mean(row) for row in values])
    sampled = np.array([_means(_scattered(row, strata, confidence), columns) for row in values])
    sampled[[not _freedom(strata[row]) for row in known]] = np.nan
    worth = np.where(whole, means if greater_is_better else -means, np.nan)
    best = int(np.nanargmax(worth)) if np.isfinite(worth).any() else -1
    tail = 50.0 * (1.0 - confidence)
    freedom = _freedom(strata[known.any(axis=0)])
    as_good = _may_be_best(worth, sampled if greater_is_better else -sampled, freedom, confidence)
    found = []
    for i, mean in enumerate(means):
        low, high = _interval(sampled[i], tail)
        if not np.any(values[i] < 0.0):
            # Increased deviations would make errors and counts negative.
            low = max(low, 0.0)
        behind = (
            (0.0, 0.0)
            if i == best
            else _interval(sampled[i] - sampled[best], tail)
            if whole[i]
            else (np.nan, np.nan)
        )
        found.append(
            Estimate(
                mean=float(mean),
                low=low,
                high=high,
                whole=bool(whole[i]),
                best=i == best,
                behind_low=float(behind[0]),
                behind_high=float(behind[1]),
                flights=int(known[i].sum()),
                as_good=bool(as_good[i]),
            )
        )
    return found


def _scattered(row: Array, strata: npt.NDArray[Any], confidence: float) -> Array:
    """Return the figures of one entrant, with the deviations from the mean of each stratum
    increased by the factors for few flights.
    """
    scattered, known = row.copy(), np.isfinite(row)
    if not (freedom := _freedom(strata[known])):
        return scattered
    wider = _wider(freedom, 0.5 + 0.5 * confidence)
    for stratum in np.unique(strata):
        within = (strata == stratum) & known
        count = int(np.count_nonzero(within))
        if count > 1:
            mean = row[within].mean()
            scattered[within] = (
                mean + (row[within] - mean) * math.sqrt(count / (count - 1.0)) * wider
            )
    return scattered


def _wider(freedom: int, level: float) -> float:
    """Return Student's quantile over that of the normal distribution."""
    from scipy.special import ndtri, stdtrit

    return float(stdtrit(freedom, level) / ndtri(level))


def _may_be_best(
    worth: Array, sampled: Array, freedom: int, confidence: float
) -> npt.NDArray[np.bool_]:
    """Return which entrants may be the best, given their worth, shape (n,), and its resamples,
    shape (n, resamples).

    Entrants that are not compared, with a worth of NaN, may not; ``freedom`` is the number of
    degrees of freedom of all strata.
    """
    found = np.isfinite(worth)
    for i in np.flatnonzero(found):
        others = np.flatnonzero(np.isfinite(worth) & (np.arange(len(worth)) != i))
        leads = worth[others] - worth[i]
        scatter = (sampled[others] - sampled[i]) - leads[:, np.newaxis]
        # A resample may contain no flight that has the figure.
        scatter = scatter[:, np.isfinite(scatter).all(axis=0)]
        if not scatter.size:
            continue
        deviations = scatter.std(axis=1)
        still = deviations <= _STILL * np.abs(leads)
        if np.any(still & (leads > 0.0)):
            # The lead is the same in every resample.
            found[i] = False
        elif not still.all():
            ahead = leads[~still] / deviations[~still]
            largest = (scatter[~still] / deviations[~still, np.newaxis]).max(axis=0)
            # With few flights, the largest of many leads has heavier tails than a single one.
            wider = _wider(freedom, confidence ** (1.0 / int(np.count_nonzero(~still)))) / _wider(
                freedom, 0.5 + 0.5 * confidence
            )
            found[i] = bool(ahead.max() <= wider * np.quantile(largest, confidence))
    return found


def _freedom(strata: npt.NDArray[Any]) -> int:
    """Return the degrees of freedom of flights about the means of their strata; 0 where no two are
    of one stratum.
    """
    return len(strata) - len(np.unique(strata))


def _mean(row: Array) -> float:
    known = row[np.isfinite(row)]
    return float(known.mean()) if len(known) else np.nan


def _means(row: Array, columns: npt.NDArray[np.intp]) -> Array:
    """Return the mean of each resample over the flights with the figure."""
    taken = row[columns]
    known = np.isfinite(taken)
    counts = known.sum(axis=1)
    totals = np.where(known, taken, 0.0).sum(axis=1)
    found: Array = np.divide(totals, counts, out=np.full(len(columns), np.nan), where=counts > 0)
    return found


def _interval(samples: Array, tail: float) -> tuple[float, float]:
    known = samples[np.isfinite(samples)]
    if not len(known):
        return np.nan, np.nan
    low, high = np.percentile(known, [tail, 100.0 - tail])
    return float(low), float(high)
