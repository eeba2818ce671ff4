"""Bounds and confidence intervals of probabilities and quantiles, for any distribution."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

CONFIDENCE = 0.95
"""Default confidence of a bound [-]."""

TELLING = 0.5
"""Largest bound on a probability that is stated [-]; a single flight gives a bound of 0.95."""

TINY = 1e-5
"""Probability below which text has a power of ten [-]."""

_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def upper_bound(events: int, trials: int, confidence: float = CONFIDENCE) -> float:
    """Return the exact one-sided upper bound of a probability [-].

    Source: C. J. Clopper and E. S. Pearson, "The use of confidence or fiducial limits illustrated
    in the case of the binomial", Biometrika 26 (1934). If trials differ in their probability, as
    the flights of a sweep do, the bound holds for the mean probability: W. Hoeffding, "On the
    distribution of the number of successes in independent trials", Annals of Mathematical
    Statistics 27 (1956), theorem 4.

    Parameters
    ----------
    events, trials : number of events and of independent trials; without any trial the bound is 1
    confidence : confidence level, between 0 and 1

    Raises
    ------
    ValueError : ``events`` is not within 0 to ``trials``, or ``confidence`` not between 0 and 1
    """
    # Quantile of the beta distribution. scipy.stats calls the same function, but its import takes a
    # third of a second.
    from scipy.special import betaincinv

    _check(confidence)
    if not 0 <= events <= trials:
        raise ValueError(f"events are {events} of {trials} trials; there can be 0 to {trials}")
    return 1.0 if events == trials else float(betaincinv(events + 1, trials - events, confidence))


@dataclass(frozen=True, slots=True)
class Interval:
    """An interval in the unit of its quantity; a limit is NaN if the sample is too small."""

    low: float
    high: float

    @property
    def width(self) -> float:
        """Width of the interval; NaN if a limit is NaN."""
        return self.high - self.low


def clopper_pearson(events: int, trials: int, confidence: float) -> Interval:
    """Return the exact two-sided interval of a probability, from two one-sided bounds.

    Each limit is wrong with a probability of at most (1 - confidence)/2.

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


def shared_interval(
    events: npt.NDArray[np.bool_], samples: npt.ArrayLike, confidence: float
) -> Interval:
    """Return the interval of a probability if trials with the same random sample count as one.

    A sample counts with the fraction of its trials that had an event. If the sum of events is not a
    whole number, each limit is computed for the next whole number outwards.

    Parameters
    ----------
    events : whether each trial had an event, shape (n,)
    samples : label of each trial's random sample, shape (n,)
    confidence : of the two-sided interval, between 0 and 1
    """
    _, of, counts = np.unique(np.asarray(samples), return_inverse=True, return_counts=True)
    # Rounding makes three thirds a whole number.
    total = round(float(np.sum(np.bincount(of, weights=events) / counts)), 6)
    low, high = (
        clopper_pearson(whole(total), len(counts), confidence) for whole in (math.floor, math.ceil)
    )
    return Interval(low.low, high.high)


def quantile_interval(values: Array, probability: float, confidence: float) -> Interval:
    """Return the confidence interval of a quantile from order statistics, for any distribution.

    The number of values below the quantile has a binomial distribution. The l-th and the u-th
    smallest value enclose the quantile if "at most l - 1 values below it" and "at least u values
    below it" each have a probability of at most (1 - confidence)/2. Source: H. A. David and H. N.
    Nagaraja, "Order Statistics", 3rd ed. (2003), section 7.1.

    Parameters
    ----------
    values : shape (n,), in any order, all finite
    probability : probability of a value below the quantile, between 0 and 1
    confidence : between 0 and 1

    Returns
    -------
    interval : in the unit of ``values``; a limit is NaN if even the smallest or largest value does
        not reach the confidence, as for quantiles near 0 or 1 of few values

    Raises
    ------
    ValueError : ``probability`` or ``confidence`` is not between 0 and 1
    """
    from scipy.stats import binom

    _check(confidence)
    if not 0.0 < probability < 1.0:
        raise ValueError(
            f"probability is {probability:g}; quantiles are of probabilities between 0 and 1"
        )
    if not len(values):
        return Interval(math.nan, math.nan)
    tail, count = 0.5 * (1.0 - confidence), len(values)
    # ppf(p) is the smallest number with a cumulative probability of at least p, which gives the
    # largest l and the smallest u.
    low = int(binom.ppf(tail, count, probability))
    high = int(binom.ppf(1.0 - tail, count, probability)) + 1
    ordered = np.sort(values)
    return Interval(
        float(ordered[low - 1]) if low >= 1 else math.nan,
        float(ordered[high - 1]) if high <= count else math.nan,
    )


def _check(confidence: float) -> None:
    if not 0.0 < confidence < 1.0:
        raise ValueError(
            f"confidence is {confidence:g}; it must be between 0 and 1, such as {CONFIDENCE:g}"
        )


def percent(fraction: float) -> str:
    """Return a fraction as text in per cent with three digits, or as a power of ten below ``TINY``.

    From 0.99 on the text has four digits. The space before the sign is non-breaking.
    """
    if 0.0 < fraction < TINY:
        mantissa, exponent = f"{fraction:.1e}".split("e")
        return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPTS)}"
    digits = 3 if fraction < 0.99 else 4
    return f"{100.0 * fraction:.{digits}g}\N{NO-BREAK SPACE}%"
