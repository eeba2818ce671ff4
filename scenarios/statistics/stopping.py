"""When a Monte Carlo study has flown enough: the interval that was asked for is as tight as wanted.

Who looks again and again, and stops when he likes what he sees, is wrong more often than his interval says. Here intervals are
looked at after fixed numbers of flights alone, and look k may be wrong with probability alpha/(k (k + 1)), alpha being one minus
the confidence. That adds up to alpha over all looks, however many there are: with the confidence none of them is wrong, and so
neither is the one that the study stops at, whatever it stops for. The union bound over looks at geometrically growing numbers is
that of V. Mnih, C. Szepesvari and J.-Y. Audibert, "Empirical Bernstein stopping", ICML 2008; spending alpha over looks that is
of K. K. G. Lan and D. L. DeMets, "Discrete sequential boundaries for clinical trials", Biometrika 70 (1983).
"""

import numpy as np
import pandas as pd

from scenarios.statistics.intervals import quantile_interval, upper_bound
from scenarios.statistics.violations import count_violations

FIRST_LOOK = 256
"""Flights before the first look. Powers of two are where a Sobol' sequence is balanced."""


def looks(planned: int) -> list[int]:
    """Return after how many flights a study is looked at: 256, twice as many each time, and all that are planned.

    The first so many flights of the plan count, not those that happened to be done first: what is seen does not depend on how
    many processes fly.

    Parameters
    ----------
    planned : number of flights, above 0
    """
    if planned < 1:
        raise ValueError(f"planned flights are {planned}; plan one at least")
    numbers = []
    flights = FIRST_LOOK
    while flights < planned:
        numbers.append(flights)
        flights *= 2
    return [*numbers, planned]


def confidence_at(look_number: int, confidence: float) -> float:
    """Return the confidence that the intervals of one look are made with, for all looks together to hold with ``confidence``.

    A study without an interval that it stops for is looked at once, at its end, and has all of ``confidence`` then.

    Parameters
    ----------
    look_number : from 1
    confidence : between 0 and 1
    """
    if look_number < 1:
        raise ValueError(f"look number is {look_number}; looks are counted from 1")
    return 1.0 - (1.0 - confidence) / (look_number * (look_number + 1))


def tight_enough(
    rows: pd.DataFrame,
    *,
    look_number: int,
    confidence: float,
    violation_upper: float | None = None,
    distance_quantile_width_m: float | None = None,
    distance_quantile: float = 0.01,
) -> bool:
    """Return whether a study may stop at a look: everything that is asked for is as tight as wanted.

    Parameters
    ----------
    rows : of the summary, of the first so many flights of the plan
    look_number, confidence : as in ``confidence_at``
    violation_upper : what the probability of entering the keep-out area is shown to be at most, by the one-sided bound; flights
        of which it is not known whether they entered count as if they did [-]
    distance_quantile_width_m : largest width of the two-sided interval of a quantile of the closest approach [m]
    distance_quantile : of which probability

    Raises
    ------
    ValueError : nothing is asked for
    """
    if violation_upper is None and distance_quantile_width_m is None:
        raise ValueError("nothing to stop for: give violation_upper or distance_quantile_width_m, or look at the end alone")
    level = confidence_at(look_number, confidence)
    if violation_upper is not None:
        found = count_violations(rows)
        if upper_bound(found.events_at_most, found.flights, level) > violation_upper:
            return False
    if distance_quantile_width_m is not None:
        distances = pd.to_numeric(rows["min_distance_m"], errors="coerce").to_numpy(dtype=np.float64)
        interval = quantile_interval(distances[np.isfinite(distances)], distance_quantile, level)
        # A side that is missing makes the width not a number, which is at most nothing.
        return interval.width <= distance_quantile_width_m
    return True
