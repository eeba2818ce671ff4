"""Estimates of a Monte Carlo study with confidence intervals, and its stopping rule.

The intervals assume independent flights. Noise, turbulence and sensors are independent, because
every flight has its own seeds. The random variables are independent in plain sampling only.

In a Latin hypercube, the mean of a figure over n flights has at most n/(n - 1) times the variance
of the mean over n independent flights, and usually less: A. B. Owen, "Monte Carlo variance of
scrambled net quadrature", SIAM Journal on Numerical Analysis 34 (1997). This holds for
probabilities, and for quantiles, which are found from probabilities of lying below a value. The
same intervals are therefore used for Latin hypercubes, where they tend to be too wide. This is an
argument and not a proof, because a bound on a variance is not a bound on the tails of an interval.
For a scrambled Sobol' sequence the same paper bounds the ratio of the variances by e = 2.72 for any
figure.

A study that evaluates its intervals repeatedly and stops as soon as they are narrow is wrong more
often than their confidence says. Here intervals are evaluated only after fixed numbers of flights
(looks), and the intervals of look k may be wrong with probability alpha/(k (k + 1)), where alpha is
one minus the confidence. The sum over any number of looks is at most alpha, so with the stated
confidence no look is wrong, including the one at which the study stops. Sources: the union bound
over looks at geometrically growing numbers of flights, V. Mnih, C. Szepesvari and J.-Y. Audibert,
"Empirical Bernstein stopping", ICML 2008; spending alpha over looks, K. K. G. Lan and D. L. DeMets,
"Discrete sequential boundaries for clinical trials", Biometrika 70 (1983).
"""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.columns import Column, described
from common.intervals import Interval, clopper_pearson, quantile_interval, upper_bound
from common.physics import SECONDS_PER_HOUR
from common.premises import TERMS, ratio_column
from scenarios.flight.outcome import Outcome
from scenarios.statistics.sensitivity import sensitivity_indices


@dataclass(frozen=True, slots=True, kw_only=True)
class Violations:
    """Counts of flights by keep-out violation.

    Attributes
    ----------
    flights : number of all flights
    measured : number of flights with a measured distance
    events : number of measured flights with a keep-out violation
    unknown : names, by outcome, of flights without a recorded violation that were not measured to
        their end, such as flights that went out of control
    """

    flights: int
    measured: int
    events: int
    unknown: dict[str, list[str]]

    @property
    def events_at_most(self) -> int:
        """Number of flights with a violation if every unknown flight counts as one."""
        return self.events + sum(len(flights) for flights in self.unknown.values())


def count_violations(rows: pd.DataFrame) -> Violations:
    """Count the flights of a summary that violated the keep-out area at any time.

    Parameters
    ----------
    rows : a row per flight with ``flight_id``, ``outcome``, ``min_distance_m`` and
        ``keepout_violations``
    """
    measured = np.isfinite(_numbers(rows, "min_distance_m"))
    entered = measured & (_numbers(rows, "keepout_violations") > 0.0)
    lost = rows[~entered & (~measured | (rows["outcome"] == Outcome.DIVERGED.value).to_numpy())]
    return Violations(
        flights=len(rows),
        measured=int(np.count_nonzero(measured)),
        events=int(np.count_nonzero(entered)),
        unknown={
            str(outcome): [str(i) for i in members["flight_id"]]
            for outcome, members in lost.groupby("outcome")
        },
    )


FIRST_LOOK = 256
"""Number of flights before the first look; a Sobol' sequence is balanced at powers of two."""


def looks(planned: int) -> list[int]:
    """Return the numbers of flights at which a study is evaluated: 256, 512, ..., and all planned.

    A look evaluates the first flights of the plan, not the first finished ones, so the result does
    not depend on the number of processes.

    Parameters
    ----------
    planned : number of flights, above 0
    """
    numbers = []
    flights = FIRST_LOOK
    while flights < planned:
        numbers.append(flights)
        flights *= 2
    return [*numbers, planned]


def confidence_at(look_number: int, confidence: float) -> float:
    """Return the confidence of one look, such that all looks together have ``confidence``.

    A study without a stopping rule is evaluated only at its end, with ``confidence`` itself.

    Parameters
    ----------
    look_number : number of the look, from 1
    confidence : confidence of all looks together, between 0 and 1
    """
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
    """Return whether a study may stop at a look, because every demanded interval is narrow enough.

    Parameters
    ----------
    rows : rows of the summary of the first flights of the plan
    look_number, confidence : as in ``confidence_at``
    violation_upper : demanded one-sided upper bound of the probability of a keep-out violation;
        unknown flights count as violations [-]
    distance_quantile_width_m : demanded width of the two-sided interval of a quantile of the
        closest approach [m]
    distance_quantile : probability of that quantile
    """
    level = confidence_at(look_number, confidence)
    if violation_upper is not None:
        found = count_violations(rows)
        if upper_bound(found.events_at_most, found.flights, level) > violation_upper:
            return False
    if distance_quantile_width_m is not None:
        distances = _numbers(rows, "min_distance_m")
        interval = quantile_interval(distances[np.isfinite(distances)], distance_quantile, level)
        # If a limit is missing, the width is NaN and the comparison is false.
        return interval.width <= distance_quantile_width_m
    return True


PROBABILITIES = (0.01, 0.05, 0.5, 0.95, 0.99)
"""Probabilities of the quantiles that are estimated for every figure."""

EXTREMES = (0.001, 0.999)
"""Probabilities of quantiles that are estimated if their interval exists.

At a confidence of 0.95 this takes 3,688 flights.
"""

NAMED_MAX = 10
"""Largest number of listed flights per outcome; ``summary.csv`` has all flights."""

COLUMNS = (
    "flight_id",
    "outcome",
    "mode_at_end",
    "min_distance_m",
    "keepout_radius_m",
    "keepout_violations",
    "crossing_interval_mean_s",
    "crossing_interval_predicted_s",
    "crossing_distance_min_m",
    "crossing_clearance_min_m",
    "tracking_error_rms_m",
    "settling_time_s",
)
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
    """Return the content of ``statistics.json``; NaN becomes None.

    Parameters
    ----------
    rows : columns ``COLUMNS`` of the summary, a row per done flight, failed flights included, in
        the order of points
    inputs : ``flight_id`` and a column per random variable or swept key, from ``draws.csv``
    confidence : confidence of each single interval, between 0 and 1
    seed : seed of the random numbers for the sensitivity indices
    look_number : number of the look at which the study stopped, from 1, because earlier looks widen
        the intervals; None for a study that is evaluated only at its end
    per_sample : number of flights with the same random sample, as at the points of a sweep [-]
    """
    level = interval_confidence(confidence, look_number)
    found = count_violations(rows)
    figures = study_figures(rows)
    drawn = inputs.set_index("flight_id").reindex(rows["flight_id"])
    # With a single sample nothing is random, and each point of the sweep counts.
    samples = np.arange(len(rows)) % count if (count := len(rows) // per_sample) > 1 else None
    statistics = {
        "confidence": confidence,
        "look_number": look_number,
        "interval_confidence": level,
        "flights": {
            "done": found.flights,
            "measured": found.measured,
            "unknown": unknown_flights(found),
        },
        "outcomes": word_counts(rows["outcome"]),
        "modes_at_end": word_counts(rows["mode_at_end"]),
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
    """Return the confidence of each interval; parameters are as in ``study_statistics``."""
    return confidence if look_number is None else confidence_at(look_number, confidence)


def pessimistic_share(found: Violations, level: float, *, per_sample: int) -> Json:
    """Return ``share`` of keep-out violations if every unknown flight counts as a violation."""
    return share(found.events_at_most, found.flights, level, per_sample=per_sample)


def study_figures(rows: pd.DataFrame) -> dict[str, Array]:
    """Return the figures of each flight by name, shape (n,); NaN if a flight has no such figure.

    Distances are in metres, and clearances are measured from r_min. The error of the mean crossing
    interval is relative to the predicted interval [-]. A flight that never settled has no settling
    time [s].
    """
    distance = _numbers(rows, "min_distance_m")
    interval = _numbers(rows, "crossing_interval_mean_s")
    predicted = _numbers(rows, "crossing_interval_predicted_s")
    return {
        "min_distance_m": distance,
        "clearance_m": distance - _numbers(rows, "keepout_radius_m"),
        "crossing_interval_error": interval / predicted - 1.0,
        "crossing_distance_min_m": _numbers(rows, "crossing_distance_min_m"),
        "crossing_clearance_m": _numbers(rows, "crossing_clearance_min_m"),
        "tracking_error_rms_m": _numbers(rows, "tracking_error_rms_m"),
        "settling_time_s": _numbers(rows, "settling_time_s"),
    }


def _numbers(rows: pd.DataFrame, name: str) -> Array:
    """Return a column as numbers; NaN for a missing value."""
    return pd.to_numeric(rows[name], errors="coerce").to_numpy(dtype=np.float64)


def unknown_flights(found: Violations) -> Json:
    """Return number and names of the unknown flights by outcome."""
    return {
        outcome: {"flights": len(flights), "flight_ids": flights[:NAMED_MAX]}
        for outcome, flights in sorted(found.unknown.items())
    }


def word_counts(words: "pd.Series[str]") -> dict[str, int]:
    """Return the number of occurrences of each word, the most frequent first."""
    return dict(Counter(str(word) for word in words.dropna()).most_common())


def share(events: int, flights: int, level: float, *, per_sample: int = 1) -> Json:
    """Return the share of flights with an event, and the intervals of its probability.

    If ``per_sample`` flights share a random sample, the upper limits assume that every event is in
    a different sample, and the lower limit that events fill whole samples.
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
    """Return the quantiles of a figure, with intervals if flights do not share samples."""
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
    """Return a nested value with None in place of NaN and infinity, for JSON."""
    if isinstance(value, dict):
        return {key: without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_nan(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


TABLE_COLUMNS = described(
    {
        "case": Column("case of the flights", kind="text"),
        "term": Column("term of the error budget", kind="text"),
        "flights": Column("flights in which the term has a ratio", digits=0),
        "ratio_median": "median over flights of the largest ratio of a flight",
        "ratio_max": "largest ratio of all flights",
        "flight_id": Column("flight of the largest ratio", title="Flight", kind="text"),
        "flights_above": Column("flights with a ratio above 1", digits=0),
        "flights_above_expected": "largest expected number of flights above 1, from the"
        " budget's"
        " rate, for processes in turbulence; none for a term that is a bound",
    }
)
"""Columns of ``premises.csv``, which has a row per case and term."""

_PROCESSES = ("wind", "turning", "drift")
"""Terms that are processes in turbulence, which may exceed their budget at a known rate."""


def premise_table(rows: pd.DataFrame, cases: Sequence[str], per_hour: float) -> pd.DataFrame:
    """Return median and largest ratio of each term and case, and the number of flights above 1.

    Parameters
    ----------
    rows : a row per flight, with the columns of the summary
    cases : case of each flight
    per_hour : rate at which a process may exceed its budget [1/h]
    """
    found = []
    for case, of_case in rows.groupby(np.asarray(cases), sort=False):
        for term in TERMS:
            ratios = pd.to_numeric(of_case[ratio_column(term)], errors="coerce").dropna()
            if ratios.empty:
                continue
            known = of_case.loc[ratios.index]
            gusty = (known["turbulence"] != "none") & (term in _PROCESSES)
            hours = float(known["duration_s"][gusty].sum()) / SECONDS_PER_HOUR
            largest = int(np.argmax(ratios))
            found.append(
                {
                    "case": case,
                    "term": term,
                    "flights": len(ratios),
                    "ratio_median": float(ratios.median()),
                    "ratio_max": float(ratios.max()),
                    "flight_id": known["flight_id"].iloc[largest],
                    "flights_above": int((ratios > 1.0).sum()),
                    "flights_above_expected": per_hour * hours,
                }
            )
    return pd.DataFrame(found, columns=list(TABLE_COLUMNS))


def premise_lines(table: pd.DataFrame) -> list[str]:
    """Return lines of text for the console, with a line per case and a column per term."""
    terms = [term for term in TERMS if term in set(table["term"])]
    width = max([len("case"), *map(len, table["case"])]) if len(table) else 0
    lines = [f"  {'case':{width}}" + "".join(f"  {term:>14}" for term in terms)]
    for case, of_case in table.groupby("case", sort=False):
        cells = {row.term: _cell(row) for row in of_case.itertuples()}
        lines.append(
            f"  {case:{width}}" + "".join(f"  {cells.get(term, ''):>14}" for term in terms)
        )
    return [
        "largest ratio of error to budget in a flight: median / largest (flights above 1)",
        *lines,
    ]


def _cell(row: object) -> str:
    median, largest = row.ratio_median, row.ratio_max  # type: ignore[attr-defined]
    above = row.flights_above  # type: ignore[attr-defined]
    return f"{median:.2f} / {largest:.2f}{f' ({above})' if above else ''}"
