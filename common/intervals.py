"""Confidence intervals of probabilities and quantiles, for independent flights and any distribution."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from common.binomial import upper_bound

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Interval:
    """An interval in the unit of its quantity; a limit for which the sample is too small is not a number."""

    low: float
    high: float

    @property
    def width(self) -> float:
        """Width of the interval; not a number if a limit is missing."""
        return self.high - self.low


def clopper_pearson(events: int, trials: int, confidence: float) -> Interval:
    """Return the exact two-sided interval of a probability; each limit errs with (1 - confidence)/2 at most.

    It is made of two one-sided bounds (``common.binomial``).

    Parameters
    ----------
    events, trials : number of events and of trials; without any trial the interval is 0 to 1
    confidence : confidence level, between 0 and 1

    Raises
    ------
    ValueError : ``events`` is not within 0 to ``trials``, or ``confidence`` not between 0 and 1
    """
    tail = 0.5 * (1.0 - confidence)
    high = upper_bound(events, trials, 1.0 - tail)
    return Interval(1.0 - upper_bound(trials - events, trials, 1.0 - tail), high)


def quantile_interval(values: Array, probability: float, confidence: float) -> Interval:
    """Return the confidence interval of a quantile from order statistics, for any distribution.

    The number of values below the quantile is binomial. The l-th and the u-th smallest value enclose the quantile if
    the probabilities of at most l - 1 values below it, and of at least u, are each (1 - confidence)/2 at most. H. A.
    David and H. N. Nagaraja, "Order Statistics", 3rd ed. (2003), section 7.1.

    Parameters
    ----------
    values : shape (n,), in any order, all finite
    probability : probability of a value below the quantile, between 0 and 1
    confidence : between 0 and 1

    Returns
    -------
    interval : in the unit of ``values``; a limit is not a number if even the smallest or largest value does not reach
        the confidence, as for quantiles near 0 or 1 of few values

    Raises
    ------
    ValueError : ``probability`` or ``confidence`` is not between 0 and 1
    """
    from scipy.stats import binom

    _check(confidence)
    if not 0.0 < probability < 1.0:
        raise ValueError(f"probability is {probability:g}; quantiles are of probabilities between 0 and 1")
    if not len(values):
        return Interval(math.nan, math.nan)
    tail, count = 0.5 * (1.0 - confidence), len(values)
    # ppf(p) is the smallest number with a cumulative probability of p or more: the largest l and the smallest u follow.
    low = int(binom.ppf(tail, count, probability))
    high = int(binom.ppf(1.0 - tail, count, probability)) + 1
    ordered = np.sort(values)
    return Interval(
        float(ordered[low - 1]) if low >= 1 else math.nan,
        float(ordered[high - 1]) if high <= count else math.nan,
    )


def _check(confidence: float) -> None:
    if not 0.0 < confidence < 1.0:
        raise ValueError(f"confidence is {confidence:g}; it must be between 0 and 1, such as 0.95")
