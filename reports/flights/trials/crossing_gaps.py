"""Flights that settled and then did not cross the plume for long, beside a vessel that still
manoeuvred.

What is counted is crossings of the straight axis along the apparent wind at the vessel. Smoke
trails behind where she was, so of flights with smoke nothing is told.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

from reports.flights.names import told_name
from reports.run.columns import Array, column
from reports.run.trials import Trial

_INTERVALS = 5.0
"""Time without a crossing, over the predicted crossing interval, from which on it is told [-]."""

_LEFT = ("departing", "retreating", "gliding", "terminating")
"""Modes at the end of a flight that had left the plume for good."""


def gap_lines(trial: Trial, *, only: bool = True) -> list[str]:
    """Return in a line how many flights had such a gap, and the longest; ``only`` is whether it is
    the run's only trial.
    """
    flown = trial.flown
    crossings = trial.run.crossings
    times = (
        {str(name): of.to_numpy() for name, of in crossings.groupby("flight_id")["time_s"]}
        if len(crossings)
        else {}
    )
    gaps = [
        (gap, row)
        for _, row in flown.iterrows()
        if (gap := _gap(row, times.get(str(row["flight_id"]), np.empty(0))))
    ]
    if not gaps:
        return []
    longest, row = max(gaps, key=lambda found: found[0][1] - found[0][0])
    which = "The flight" if len(flown) == 1 else f"{len(gaps):,} of {len(flown):,} flights"
    name = "" if len(flown) == 1 else f" {told_name(trial, row)},"
    line = (
        f"{which}, once settled, did not cross the plume for more than {_INTERVALS:g} crossing intervals before the vessel's"
        f" last manoeuvre had ended; longest:{name} {gap_words(longest)}."
    )
    return [line if only else f"{trial.title}: {line[0].lower()}{line[1:]}"]


def crossing_gap(trial: Trial, row: "pd.Series[Any]") -> tuple[float, float] | None:
    """Return the longest gap of a flight, from and to [s], or None where there is none to be told
    of.
    """
    return _gap(row, column(trial.run.crossings_of(str(row["flight_id"])), "time_s"))


def gap_words(gap: tuple[float, float]) -> str:
    """Return how long a gap is, and from when on."""
    start, end = gap
    return f"{end - start:.0f} s from {start:.0f} s on"


def _gap(row: "pd.Series[Any]", crossings: Array) -> tuple[float, float] | None:
    settled, manoeuvred = (
        float(row.get(key, math.nan)) for key in ("settling_time_s", "manoeuvre_end_s")
    )
    if not settled < manoeuvred or math.isfinite(float(row.get("plume_axis_crossings", math.nan))):
        return None
    ends = np.array(
        [settled, *crossings, *([] if row["mode_at_end"] in _LEFT else [float(row["duration_s"])])]
    )
    lengths = np.where(ends[:-1] < manoeuvred, np.diff(ends), 0.0)
    longest = int(np.argmax(lengths)) if len(lengths) else 0
    if not len(lengths) or not lengths[longest] > _INTERVALS * float(
        row["crossing_interval_predicted_s"]
    ):
        return None
    return float(ends[longest]), float(ends[longest + 1])
