"""Estimates of a Monte Carlo study and their confidence intervals: ``statistics.json``.

Intervals assume independent flights. Noise, turbulence and sensors are independent, because every
flight has its own seeds; the random variables are independent in plain sampling only. In a Latin
hypercube they are not, but the mean of a figure over n of its flights has at most n/(n - 1) times
the variance of the mean over n independent flights, and usually less: A. B. Owen, "Monte Carlo
variance of scrambled net quadrature", SIAM Journal on Numerical Analysis 34 (1997). That covers
probabilities, and quantiles, which are probabilities of lying below a value. So the same intervals
are used for Latin hypercubes and tend to be too wide. A bound on a variance is not a bound on the
tails of an interval: this is an argument, not a proof. For a scrambled Sobol' sequence the same
paper bounds the ratio of the variances by e = 2.72, whatever the figure.
"""

import math
from collections import Counter
from dataclasses import asdict
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.intervals import Interval, clopper_pearson, quantile_interval, upper_bound
from scenarios.statistics.sensitivity import sensitivity_indices
from scenarios.statistics.stopping import confidence_at
from scenarios.statistics.violations import Violations, count_violations

PROBABILITIES = (0.01, 0.05, 0.5, 0.95, 0.99)
"""Probabilities of the quantiles that are given for every figure."""

EXTREMES = (0.001, 0.999)
"""Probabilities of quantiles that are given if their interval exists: from 3,688 flights at a
confidence of 0.95.
"""

NAMED_MAX = 10
"""Largest number of flights that are named for each outcome; ``summary.csv`` has all."""

COLUMNS = (
    "flight_id", "outcome", "mode_at_end", "min_distance_m", "keepout_radius_m", "keepout_violations", "crossing_interval_mean_s",
    "crossing_interval_predicted_s", "crossing_distance_min_m", "crossing_clearance_min_m", "tracking_error_rms_m",
    "settling_time_s",
)  # fmt: skip
"""Columns of the summary that the estimates use."""

DRIVEN = ("clearance_m", "tracking_error_rms_m", "crossing_interval_error", "settling_time_s")
"""Figures for which sensitivity indices are estimated."""

Array = npt.NDArray[np.float64]
Json = dict[str, Any]


def study_statistics(
    rows: pd.DataFrame,
    inputs: pd.DataFrame,
    *,
    confidence: float,
    seed: int,
    look_number: int | None = None,
    per_sample: int = 1,
) -> Json:
    """Return the content of ``statistics.json``; values that are not a number become None.

    Parameters
    ----------
    rows : columns ``COLUMNS`` of the summary, a row per flight that is done, failed flights
        included, one point after the other
    inputs : of ``draws.csv`` ``flight_id`` and a column per random variable or swept key
    confidence : confidence of each interval, between 0 and 1; not of all of them together
    seed : seed of the random numbers for the sensitivity indices
    look_number : number of the look at which the study stopped, from 1; intervals are widened for
        the looks before it (``scenarios.statistics.stopping``). None for a study that is evaluated
        only at its end
    per_sample : flights that share what is random, as those of the points of a sweep do [-]
    """
    level = interval_confidence(confidence, look_number)
    found = count_violations(rows)
    figures = study_figures(rows)
    drawn = inputs.set_index("flight_id").reindex(rows["flight_id"])
    # In a single sample nothing random differs, and what is swept is all that there is to judge.
    samples = np.arange(len(rows)) % count if (count := len(rows) // per_sample) > 1 else None
    statistics = {
        "confidence": confidence,
        "look_number": look_number,
        "interval_confidence": level,
        "flights": {"done": found.flights, "measured": found.measured, "unknown": named(found)},
        "outcomes": counted(rows["outcome"]),
        "modes_at_end": counted(rows["mode_at_end"]),
        "violation": {
            "measured": share(found.events, found.measured, level, per_sample=per_sample),
            "pessimistic": pessimistic_share(found, level, per_sample=per_sample),
        },
        "figures": {
            name: _figure(values, level, apart=per_sample == 1) for name, values in figures.items()
        },
        "sensitivity": {
            name: asdict(
                sensitivity_indices(
                    drawn, figures[name], confidence=confidence, seed=seed, samples=samples
                )
            )
            for name in DRIVEN
        },
    }
    plain: Json = without_nan(statistics)
    return plain


def interval_confidence(confidence: float, look_number: int | None) -> float:
    """Return the confidence of each interval, by that of the study and its look, as of
    ``study_statistics``.
    """
    return confidence if look_number is None else confidence_at(look_number, confidence)


def pessimistic_share(found: Violations, level: float, *, per_sample: int) -> Json:
    """Return the share of flights with a keep-out violation as ``share`` does, if every unknown
    flight had one.
    """
    return share(found.events_at_most, found.flights, level, per_sample=per_sample)


def study_figures(rows: pd.DataFrame) -> dict[str, Array]:
    """Return the figures of each flight, shape (n,); not a number where a flight has no such
    figure.

    Distances are in metres, and clearances are measured from r_min; the error of the mean crossing
    interval is relative to the predicted interval [-]; the settling time is in seconds, and a
    flight that never settled has none.
    """

    def column(name: str) -> Array:
        return pd.to_numeric(rows[name], errors="coerce").to_numpy(dtype=np.float64)

    return {
        "min_distance_m": column("min_distance_m"),
        "clearance_m": column("min_distance_m") - column("keepout_radius_m"),
        "crossing_interval_error": column("crossing_interval_mean_s")
        / column("crossing_interval_predicted_s")
        - 1.0,
        "crossing_distance_min_m": column("crossing_distance_min_m"),
        "crossing_clearance_m": column("crossing_clearance_min_m"),
        "tracking_error_rms_m": column("tracking_error_rms_m"),
        "settling_time_s": column("settling_time_s"),
    }


def named(found: Violations) -> Json:
    """Return the flights of unknown end by their outcome."""
    return {
        outcome: {"flights": len(flights), "flight_ids": flights[:NAMED_MAX]}
        for outcome, flights in sorted(found.unknown.items())
    }


def counted(words: "pd.Series[str]") -> dict[str, int]:
    """Return how often each word occurs, the most frequent first; flights without a word are left
    out.
    """
    return dict(Counter(str(word) for word in words.dropna()).most_common())


def share(events: int, flights: int, level: float, *, per_sample: int = 1) -> Json:
    """Return the share of flights with an event, and the intervals of its probability.

    Of flights that share what is random, so many ``per_sample``, each event may be of another
    sample, or all events of samples that have nothing else: what does not make up a whole one says
    nothing of the lower limit.
    """
    samples = flights // per_sample
    most, least = min(events, samples), events // per_sample
    return {
        "events": events,
        "flights": flights,
        "share": events / flights if flights else math.nan,
        "low": clopper_pearson(least, samples, level).low,
        "high": clopper_pearson(most, samples, level).high,
        "upper": upper_bound(most, samples, level),
    }


def _figure(values: Array, level: float, *, apart: bool) -> Json:
    """Return the quantiles of a figure, with their intervals if every flight is a sample of its
    own.
    """
    known = values[np.isfinite(values)]
    quantiles = []
    for probability in sorted((*PROBABILITIES, *EXTREMES)):
        interval = (
            quantile_interval(known, probability, level) if apart else Interval(math.nan, math.nan)
        )
        if probability in PROBABILITIES or math.isfinite(interval.width):
            value = float(np.quantile(known, probability)) if len(known) else math.nan
            quantiles.append(
                {
                    "probability": probability,
                    "value": value,
                    "low": interval.low,
                    "high": interval.high,
                }
            )
    return {"known": len(known), "missing": len(values) - len(known), "quantiles": quantiles}


def without_nan(value: Any) -> Any:
    """Return a nested value with None in place of every number that is not finite, which JSON
    cannot express.
    """
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
