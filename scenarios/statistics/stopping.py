"""Stopping rule of a Monte Carlo study: it may stop when the demanded confidence intervals are
narrow enough.

A study that evaluates its intervals repeatedly, and stops as soon as they look good, is wrong more
often than their confidence says. Here intervals are evaluated only after fixed numbers of flights
(looks), and the intervals of look k may be wrong with probability alpha/(k (k + 1)), where alpha is
one minus the confidence. The sum over all looks is alpha, however many there are: with the stated
confidence no look is wrong, and so neither is the one at which the study stops. The union bound
over looks at geometrically growing numbers of flights is that of V. Mnih, C. Szepesvari and J.-Y.
Audibert, "Empirical Bernstein stopping", ICML 2008; spending alpha over looks is that of K. K. G.
Lan and D. L. DeMets, "Discrete sequential boundaries for clinical trials", Biometrika 70 (1983).
"""

import numpy as np
import pandas as pd

from common.intervals import quantile_interval, upper_bound
from scenarios.statistics.violations import count_violations

FIRST_LOOK = 256
"""Number of flights before the first look; a Sobol' sequence is balanced at powers of two."""


def looks(planned: int) -> list[int]:
    """Return the numbers of flights at which a study is evaluated: 256, doubled each time, and all
    that are planned.

    A look evaluates the first flights of the plan, not those that happened to be done first: the
    result does not depend on the number of processes.

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
    """Return the confidence of the intervals of one look, such that all looks together hold with
    ``confidence``.

    A study without a stopping rule is evaluated once, at its end, with all of ``confidence``.

    Parameters
    ----------
    look_number : number of the look, from 1
    confidence : confidence of all looks together, between 0 and 1
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
    """Return whether a study may stop at a look: every demanded interval is narrow enough.

    Parameters
    ----------
    rows : rows of the summary of the first flights of the plan
    look_number, confidence : as in ``confidence_at``
    violation_upper : demanded one-sided upper bound of the probability of a keep-out violation;
        flights for which that is unknown count as violations [-]
    distance_quantile_width_m : demanded width of the two-sided interval of a quantile of the
        closest approach [m]
    distance_quantile : probability of that quantile

    Raises
    ------
    ValueError : neither interval is demanded
    """
    if violation_upper is None and distance_quantile_width_m is None:
        raise ValueError(
            "no interval is demanded; give violation_upper or distance_quantile_width_m"
        )
    level = confidence_at(look_number, confidence)
    if violation_upper is not None:
        found = count_violations(rows)
        if upper_bound(found.events_at_most, found.flights, level) > violation_upper:
            return False
    if distance_quantile_width_m is not None:
        distances = pd.to_numeric(rows["min_distance_m"], errors="coerce").to_numpy(
            dtype=np.float64
        )
        interval = quantile_interval(distances[np.isfinite(distances)], distance_quantile, level)
        # If a limit is missing the width is not a number, and this comparison is false.
        return interval.width <= distance_quantile_width_m
    return True
