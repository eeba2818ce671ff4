"""Which flights of a trial failed a criterion, and which were not flown, in lines for page 1."""

from collections.abc import Iterator
from typing import Any

import pandas as pd

from reports.document.tables import ending, in_symbols, number
from reports.flights.criteria import criteria_of
from reports.flights.names import told_name
from reports.run.columns import column, count, largest, met, violated, was_flown
from reports.run.trials import Trial

_NAMED_MAX = 3
"""Flights of a trial that the verdict names one by one."""

_SEVERAL = {False: ", ", True: "; "}
"""Between the names of flights, whether or not these have commas of their own."""


def failure_lines(trial: Trial) -> list[str]:
    """Return which flights of a trial failed a criterion, each of a few, else by criterion; and which were not flown."""
    rows = trial.rows
    failed = rows[~met(rows)]
    begun = was_flown(failed)
    flown, unflown = failed[begun], failed[~begun]
    lines = [*_named(trial, flown)] if len(flown) <= _NAMED_MAX else [_by_criterion(trial, len(flown))]
    lines += [*_named(trial, unflown)] if len(unflown) <= _NAMED_MAX else [_not_flown(trial, unflown)]
    missing = trial.planned - len(rows)
    return [*lines, *([f"{trial.title}: {missing} of {trial.planned} not flown yet"] if missing else [])]


def _named(trial: Trial, flights: pd.DataFrame) -> Iterator[str]:
    """Yield the flights by name, those of one reason together."""
    reasons: dict[str, list[str]] = {}
    for _, row in flights.iterrows():
        reasons.setdefault(_reason(row), []).append(told_name(trial, row))
    for reason, names in reasons.items():
        yield f"{_SEVERAL[bool(trial.swept)].join(names)}: {reason}"


def _by_criterion(trial: Trial, failed: int) -> str:
    """Return how many of the flights that were flown failed which criterion."""
    flown = trial.flown
    inside, depth = count(violated(flown)), largest(column(flown, "keepout_depth_m"))
    parts = [f"{inside} violated the keep-out area, by up to {number(depth, '{:.1f} m')}"] if inside else []
    parts += [
        f"{c.flown_failed} did not complete the mission" if c.key == "mission" else f"{c.flown_failed}: {c.what}, {c.limit}"
        for c in criteria_of(trial)
        if c.flown_failed
    ]
    why = f" ({'; '.join(parts)})" if parts else ""
    return f"{trial.title}: {failed} of {len(flown)} flights{' flown' * (len(flown) < len(trial.rows))} failed a criterion{why}"


def _not_flown(trial: Trial, flights: pd.DataFrame) -> str:
    """Return how many flights were not flown, and why the first of them was not."""
    first = flights.iloc[0]
    return f"{trial.title}: {len(flights)} of {trial.planned} not flown; the first, {told_name(trial, first)}: {ending(first)}"


def _reason(row: "pd.Series[Any]") -> str:
    """Return why a flight failed a criterion; that it did not settle its message says already."""
    ended = "" if row["outcome"] == "not_settled" else str(row["outcome"]).replace("_", " ")
    return "; ".join(words for words in (ended, in_symbols(str(row["message"]))) if words)
