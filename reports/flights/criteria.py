"""The criteria of a trial beside the keep-out area, and the worst that was measured."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, TypedDict

import numpy as np
import pandas as pd

from common.columns import Column
from reports.document.tables import beside_limit, limit
from reports.run.columns import (
    Array,
    Mask,
    column,
    completed,
    count,
    judged,
    largest,
    was_flown,
)
from reports.run.trials import Trial


@dataclass(frozen=True, slots=True, kw_only=True)
class Criterion:
    """One criterion of one trial.

    Attributes
    ----------
    key : of the configuration, without its section
    what : it is about
    limit : in words
    worst : what was measured at worst, in words
    failed : flights that failed it, or have no such figure
    fraction : the worst over the limit, where both are figures; else not a number [-]
    missing : flights that have no such figure and why, in words; none where all of them have it
    flown_failed : flights that failed it and were flown
    """

    key: str
    what: str
    limit: str
    worst: str
    failed: int
    fraction: float = float("nan")
    missing: str = ""
    flown_failed: int = 0


class _Failed(TypedDict):
    """Flights that failed a criterion, or have no such figure; and those of them that were flown."""

    failed: int
    flown_failed: int


_TRACKING = "tracking_error_rms_m"

_AFTER_SETTLING = (_TRACKING, "airspeed_error_rms_mps", "altitude_error_max_m")
"""Criteria on what is measured after settling: they are judged where ``criteria.settles`` is true,
and nowhere else.
"""

MEASURED = (
    "crossing_interval_error",
    *_AFTER_SETTLING,
    "tracking_error_end_m",
    "resumes_within_periods",
    "time_to_find_s",
)
"""Criteria that are limits of a figure, in the order of the verdict's tiles."""

_FIGURES = {
    "resumes_within_periods": "resume_periods",
    "crossing_interval_s": "crossing_interval_mean_s",
    "crossing_distance_m": "crossing_distance_mean_m",
    "within_altitudes": "altitude_outside_s",
}
"""Figures that criteria are about, where they have another name."""

_BETWEEN = ("crossing_interval_s", "crossing_distance_m")
"""Criteria that a figure lies between two limits."""

_DEMAND = {"law_within_heading_rate_max": "≤ ω_max", "law_beyond_heading_rate_max": "> ω_max"}
"""Criteria on the largest heading rate that the law demands, before commands are cut."""

_ROUNDING = 1e-12
"""By what a demand may exceed ω_max where it has to lie within: rounding alone [-]."""

_BESIDE_VESSEL = (
    "crossing_interval_error", *_BETWEEN, "resumes_within_periods", "time_to_find_s", "within_altitudes", "modes_at_end",
)  # fmt: skip
"""Criteria that a flight about a circle is not judged by: it has no vessel."""

_SCALED = ", scaled to the aircraft"
"""What is said of a limit that is not the default, and that the scenario does not set."""


def criteria_of(trial: Trial) -> list[Criterion]:
    """Return the criteria of a trial beside the keep-out area: to complete its mission, and those
    of its configuration.
    """
    listed = {key: value for key, value in trial.criteria.items() if value not in (None, False, [])}
    others = {
        "required",
        "settles",
        *(() if trial.criteria.get("settles", True) else _AFTER_SETTLING),
    }
    others |= set(_BESIDE_VESSEL if _circles(trial) else ())
    return [
        _mission(trial),
        *(_criterion(trial, key, value) for key, value in listed.items() if key not in others),
    ]


def switched_off(trials: Sequence[Trial]) -> list[tuple[str, str]]:
    """Return name and worst value of figures that criteria limit by default, and no criterion of
    these trials.

    Without the tracking error, which is a figure of its own whether or not it is limited.
    """
    told = {
        _TRACKING,
        *(criterion.key for trial in trials for criterion in criteria_of(trial)),
    }
    by_default = {
        str(of["key"]) for trial in trials for of in trial.parameters() if of.get("default")
    }
    figures = []
    for key in MEASURED:
        of = _column(trials[0], key) if trials else Column()
        worst = largest(np.concatenate([_values(trial, trial.rows, key) for trial in trials]))
        if key not in told and f"criteria.{key}" in by_default and worst is not None:
            figures.append((f"{of.title}, worst", f"{limit(of.scale * worst)}{of.after}"))
    return figures


def _criterion(trial: Trial, key: str, value: Any) -> Criterion:
    if key in MEASURED:
        found = _figure(trial, _judged(trial.rows, key), key, float(value))
        return (
            replace(found, limit=f"{found.limit}{_SCALED}")
            if trial.is_scaled(f"criteria.{key}")
            else found
        )
    if key in _BETWEEN:
        return _between(trial, key, value)
    if key == "modes_at_end":
        return _modes(trial, [str(mode) for mode in value])
    if key == "within_altitudes":
        return _figure(trial, trial.rows, key, 0.0)
    return _demand(trial, key)


def _column(trial: Trial, key: str) -> Column:
    """Return the figure that a criterion is about."""
    return trial.run.column(_FIGURES.get(key, key))


def _values(trial: Trial, rows: pd.DataFrame, key: str) -> Array:
    """Return it of some flights, as it is judged."""
    return judged(rows, _FIGURES.get(key, key), _column(trial, key))


def _judged(rows: pd.DataFrame, key: str) -> pd.DataFrame:
    """Return the flights that a criterion is about: a vessel that ends no manoeuvre gives nothing
    to resume after.
    """
    return (
        rows[rows["manoeuvre_end_s"].notna()]
        if key == "resumes_within_periods" and "manoeuvre_end_s" in rows
        else rows
    )


def _between(trial: Trial, key: str, limits: Sequence[float]) -> Criterion:
    low, high = (float(bound) for bound in limits)
    of, measured = _column(trial, key), _values(trial, trial.rows, key)
    return Criterion(
        key=key,
        what=of.title,
        limit=f"{low:g} to {high:g}{of.after}",
        worst=f"{_ends(measured, low, high)}{of.after}"
        if np.isfinite(measured).any()
        else "none measured",
        **_failed(~((low <= measured) & (measured <= high)), trial.rows),
    )


def _ends(measured: Array, low: float, high: float) -> str:
    """Return the least and the largest figure, each on the side of its limit on which it lies."""
    ends = [
        beside_limit(float(end), bound, 4)
        for end, bound in ((np.nanmin(measured), low), (np.nanmax(measured), high))
    ]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)


def _demand(trial: Trial, key: str) -> Criterion:
    demand, most = (
        column(trial.rows, f"heading_rate_{name}_rad_s") for name in ("demand_max", "limit")
    )
    within = key == "law_within_heading_rate_max"
    met = demand <= most * (1.0 + _ROUNDING) if within else demand > most
    known = (demand / most)[np.isfinite(demand / most)]
    worst = (float(known.max()) if within else float(known.min())) if len(known) else math.nan
    words = f"{worst:.3f}"
    return Criterion(
        key=key,
        what="Heading rate that the law demands, largest of a flight",
        limit=_DEMAND[key],
        worst=f"{words if (float(words) > 1.0) == (worst > 1.0) else beside_limit(worst, 1.0)} ω_max"
        if len(known)
        else "none measured",
        **_failed(~met, trial.rows),
    )


def _figure(trial: Trial, rows: pd.DataFrame, key: str, value: float) -> Criterion:
    of, measured = _column(trial, key), _values(trial, rows, key)
    known = measured[np.isfinite(measured)]
    worst = float(known.max()) if len(known) else float("nan")
    bound = of.scale * value
    shown = _rounded(of.scale * worst, bound) if len(known) else worst
    # What is met may be written as the limit; what is not may not.
    words = (
        f"{beside_limit(shown, bound) if shown > bound else limit(shown)}{of.after}"
        if len(known)
        else "none measured"
    )
    return Criterion(
        key=key,
        what=of.title,
        limit=f"≤ {limit(of.scale * value)}{of.after}",
        worst=words,
        **_failed(~(measured <= value), rows),
        fraction=worst / value if value else float("nan"),
        # To take rows of a table of a hundred columns costs more than all else here.
        missing=_without(rows[~np.isfinite(measured)]) if len(known) < len(measured) else "",
    )


def _failed(failed: Mask, rows: pd.DataFrame) -> _Failed:
    """Return how many flights failed a criterion, and how many of those that were flown."""
    return {"failed": count(failed), "flown_failed": count(failed & was_flown(rows))}


def _without(rows: pd.DataFrame) -> str:
    """Return how many flights have no figure, and how they ended; an empty text if every flight has
    one.
    """
    if not len(rows):
        return ""
    ended = zip(rows["outcome"], was_flown(rows), strict=True)
    ends = [str(outcome).replace("_", " ") if flown else "not flown" for outcome, flown in ended]
    why = ends[0] if len(set(ends)) == 1 else counted(pd.Series(ends))
    return f"{len(rows):,} {'flight has' if len(rows) == 1 else 'flights have'} no figure: {why}"


def _rounded(value: float, most: float) -> float:
    """Return a figure without what is less than a thousandth of its limit."""
    return round(value, 3 - math.floor(math.log10(most))) if most > 0.0 else value


def _mission(trial: Trial) -> Criterion:
    settled, done = column(trial.rows, "settling_time_s"), completed(trial.rows)
    crossings = int(trial.setting("flight.crossings", 0))
    ends = [str(outcome).replace("_", " ") for outcome in trial.rows["outcome"][~done]]
    slowest = np.max(settled[done & np.isfinite(settled)], initial=-np.inf)
    words = [f"settled after {slowest:.0f} s at the latest"] if np.isfinite(slowest) else []
    words += [counted(pd.Series(ends))] if ends else []
    return Criterion(
        key="mission",
        what="Keeps its aircraft"
        if _circles(trial)
        else f"Completes its mission: settles, and flies {f'{crossings} crossings' if crossings else 'a crossing at least'}",
        limit="each flight",
        worst="; ".join(words) or ("every flight did" if len(trial.rows) else "none flown"),
        **_failed(~done, trial.rows),
    )


def _circles(trial: Trial) -> bool:
    """Return whether its flights are about a circle, without a vessel."""
    return bool(trial.setting("reference.path") == "circle")


def _modes(trial: Trial, modes: list[str]) -> Criterion:
    ends = trial.rows["mode_at_end"].fillna("not flown")
    others = ends[~ends.isin(modes)]
    return Criterion(
        key="modes_at_end",
        what="Mode at the end",
        limit=" or ".join(modes),
        worst=counted(others) if len(others) else "no other",
        **_failed(~ends.isin(modes).to_numpy(), trial.rows),
    )


def counted(values: "pd.Series[Any]") -> str:
    """Return how often each value occurs, in words, the most frequent first."""
    counts = values.dropna().value_counts()
    return ", ".join(f"{count} {value}" for value, count in counts.items())
