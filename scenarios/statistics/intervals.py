"""Intervals that hold a probability or a quantile with a stated confidence, whatever the distribution. For independent flights."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Interval:
    """From ``low`` to ``high``, in the unit of what it holds; a side that the sample is too small for is not a number."""

    low: float
    high: float

    @property
    def width(self) -> float:
        """How wide it is; not a number if a side is missing."""
        return self.high - self.low


def clopper_pearson(events: int, trials: int, confidence: float) -> Interval:
    """Return the exact two-sided interval of a probability: each side is missed with half of what confidence leaves, at most.

    C. J. Clopper and E. S. Pearson, "The use of confidence or fiducial limits illustrated in the case of the binomial",
    Biometrika 26 (1934).

    Parameters
    ----------
    events, trials : how often it happened, of how many times; without any trial the interval is 0 to 1
    confidence : between 0 and 1

    Raises
    ------
    ValueError : ``events`` is not within 0 to ``trials``, or ``confidence`` not between 0 and 1
    """
    tail = 0.5 * (1.0 - confidence)
    high = upper_bound(events, trials, 1.0 - tail)
    return Interval(1.0 - upper_bound(trials - events, trials, 1.0 - tail), high)


def upper_bound(events: int, trials: int, confidence: float) -> float:
    """Return what a probability is at most: the exact one-sided bound of Clopper and Pearson [-].

    Parameters and errors are those of ``clopper_pearson``.
    """
    from scipy.stats import beta

    _check(confidence)
    if not 0 <= events <= trials:
        raise ValueError(f"events are {events} of {trials} trials; there can be 0 to {trials}")
    return 1.0 if events == trials else float(beta.ppf(confidence, events + 1, trials - events))


def quantile_interval(values: Array, probability: float, confidence: float) -> Interval:
    """Return the interval from order statistics that holds a quantile, for any distribution.

    Of n values the number that lie below the quantile is binomial; the l-th and the u-th smallest enclose it, where l - 1 such
    values or fewer, and u or more, each have half the probability that confidence leaves, at most. H. A. David and
    H. N. Nagaraja, "Order Statistics", 3rd ed. (2003), section 7.1.

    Parameters
    ----------
    values : shape (n,), in any order, without what is not a number
    probability : of a value below the quantile, between 0 and 1
    confidence : between 0 and 1

    Returns
    -------
    interval : in the unit of ``values``; a side is not a number where even the smallest or largest value does not reach the
        confidence, as for quantiles near 0 or 1 of few values

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
    # A ppf is the smallest number with at least that probability: one less has less than a tail, one more leaves a tail at most.
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
