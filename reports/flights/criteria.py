"""The criteria of the verdict in words: what each is about, its limit, the worst of its figure, and
the bound on the rate of keep-out violations.
"""

import math
from collections.abc import Iterable, Sequence
from typing import Any

import pandas as pd

from common.columns import Column
from common.intervals import TELLING, percent
from common.verdict import Criterion, Worst
from reports.document.tables import approach, beside_limit, limit
from reports.run.run_data import RunData
from reports.run.trials import Trial

TRACKING = "tracking_error_rms_m"

_WORST = {
    "crossing_interval_error": "interval {} off",
    TRACKING: "tracking {}",
    "airspeed_error_rms_mps": "airspeed {}",
    "altitude_error_max_m": "altitude {}",
    "tracking_error_end_m": "tracking at the end {}",
    "resumes_within_periods": "resumed after {}",
    "time_to_find_s": "found after {}",
}
"""What a headline says of the worst of a figure."""

MEASURED = tuple(_WORST)
"""Criteria that are upper limits of a figure, in the order of the verdict's tiles."""

_AT_LEAST = ("keep_out", "crossing_clearance")
"""Criteria that are lower limits of a distance."""

_TITLES = {
    "mission": "Completes its mission",
    "settles": "Settles",
    "modes_at_end": "Mode at the end",
    "heading_rate": "Heading rate commanded, largest of a flight",
    **dict.fromkeys(
        ("law_within_heading_rate_max", "law_beyond_heading_rate_max"),
        "Heading rate that the law demands, largest of a flight",
    ),
}
"""What criteria are about that are no limits of a column."""

_OF_HEADING_RATE = {
    "heading_rate": "≤ ω_max",
    "law_within_heading_rate_max": "≤ ω_max",
    "law_beyond_heading_rate_max": "> ω_max",
}
"""Limits of ratios to the largest heading rate."""

SCALED = ", scaled to the aircraft"
"""What is said of a limit that is not the default, and that the scenario does not set."""


def criterion_title(run: RunData, criterion: Criterion) -> str:
    """Return what a criterion is about."""
    return _TITLES.get(criterion.key) or run.column(criterion.column).title


def limit_words(run: RunData, key: str, column: str, value: Any) -> str:
    """Return a limit in words.

    Parameters
    ----------
    run : as read from disk
    key, column : of the criterion
    value : of the limit, as the verdict has it
    """
    of = run.column(column)
    if value is True or key == "mission":
        return "each flight"
    if key in _OF_HEADING_RATE:
        return _OF_HEADING_RATE[key]
    if isinstance(value, list) and key == "modes_at_end":
        return " or ".join(value)
    if isinstance(value, list):
        return f"{value[0]:g} to {value[1]:g}{of.after}"
    sign = "≥" if key in _AT_LEAST else "≤"
    return f"{sign} {limit(of.scale * value)}{of.after}"


def limits_words(trial: Trial, criterion: Criterion) -> str:
    """Return the limits of a criterion in the flights of a trial."""
    words = " or ".join(
        limit_words(trial.run, criterion.key, criterion.column, value) for value in criterion.limits
    )
    return f"{words}{SCALED}" if trial.is_scaled(f"criteria.{criterion.key}") else words


def worst_words(run: RunData, criterion: Criterion, worst: Worst | None) -> str:
    """Return the worst of a figure, written on the side of its limit on which it lies."""
    if worst is None:
        return "none measured"
    if isinstance(worst.value, str):
        return worst.value.replace("_", " ")
    key, of = criterion.key, run.column(criterion.column)
    if key in _OF_HEADING_RATE:
        return f"{beside_limit(worst.value, 1.0, 4)} ω_max"
    value = of.scale * worst.value
    if key in _AT_LEAST:
        return f"{approach(value, 0.0, '+')}{of.after}"
    return f"{_on_its_side(value, of, worst.limit)}{of.after}"


def worst_in_words(run: RunData, criterion: Criterion) -> str:
    """Return the worst of a figure over all flights, in words of a headline."""
    return _WORST[criterion.key].format(worst_words(run, criterion, criterion.worst_of_all))


def _on_its_side(value: float, of: Column, bound: Any) -> str:
    if isinstance(bound, list):
        low, high = (of.scale * end for end in bound)
        return beside_limit(value, high if value > high else low, 4)
    if isinstance(bound, int | float) and not isinstance(bound, bool):
        most = of.scale * bound
        # Without what is less than a thousandth of the limit.
        shown = round(value, 3 - math.floor(math.log10(most))) if most > 0.0 else value
        # What is met may be written as the limit; what is not may not.
        return beside_limit(shown, most) if shown > most else limit(shown)
    return limit(value)


def limited_by_default(trials: Sequence[Trial], key: str) -> bool:
    """Return whether a criterion limits its figure by default, in any trial."""
    by_default = {
        str(of["key"]) for trial in trials for of in trial.parameters() if of.get("default")
    }
    return f"criteria.{key}" in by_default


def counted(values: "Iterable[Any] | pd.Series[Any]") -> str:
    """Return how often each value occurs, in words, the most frequent first."""
    counts = pd.Series(values).dropna().value_counts()
    return ", ".join(f"{count} {value}" for value, count in counts.items())


def violation_bound(run: RunData) -> tuple[float, float] | None:
    """Return the bound on the probability of a keep-out violation and its confidence; none where
    flights are no random sample, or too few.

    That of a subset simulation is in its statistics; any other is in the verdict.
    """
    statistics = run.statistics
    if statistics is not None and statistics.get("method") == "subset":
        upper, confidence = (
            statistics["violation"]["pessimistic"]["upper"],
            statistics["confidence"],
        )
        return (upper, confidence) if upper <= TELLING else None
    bound = run.verdict.whole.bound
    return (bound.upper, bound.confidence) if bound and bound.upper <= TELLING else None


def bound_note(run: RunData, trials: Sequence[Trial]) -> list[str]:
    """Return what bound on the rate of keep-out violations follows from the flights, as small print
    of how many kept out; nothing where the headline has it.
    """
    if run.statistics is not None:
        return []
    if not all(trial.sampled_at_random for trial in trials):
        return ["no random sample, so no bound on the rate"]
    if (found := violation_bound(run)) is None:
        return ["too few for a bound on the rate"]
    upper, confidence = found
    words = f"rate of violations below {percent(upper)} at {percent(confidence)}"
    bound = run.verdict.whole.bound
    if bound and bound.unknown:
        words += f", with {bound.unknown:,} unknown as violated"
    return [words]


def trial_bound(trial: Trial) -> float | None:
    """Return the bound that follows from the flights of one trial."""
    bound = trial.verdict.bound
    return bound.upper if bound and bound.upper <= TELLING else None
