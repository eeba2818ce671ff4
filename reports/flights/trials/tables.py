"""Tables of trials and of their flights."""

import re
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pandas as pd

from common.columns import Column
from common.intervals import CONFIDENCE, percent
from common.run_layout import SUMMARY
from common.verdict import Criterion
from reports.document.blocks import Block, Table, Text
from reports.document.tables import approach, ending, number, outcome, span
from reports.flights.bounds import trial_bound
from reports.flights.criteria import (
    MEASURED,
    counted,
    criterion_title,
    limits_words,
    worst_words,
)
from reports.flights.names import told_name
from reports.run.columns import (
    by_severity,
    clearance,
    column,
    completed,
    count,
    kept_out,
    lost,
    met,
    radii_differ,
    total,
    was_flown,
)
from reports.run.faults import names_of_faults
from reports.run.run_data import RunData
from reports.run.time_history import keepout_distance
from reports.run.trials import Trial

_FAILED = (
    "Flights that did not meet every criterion: {failed:,}, of which {listed:,} are listed, lost ones,"
    " diverged ones and keep-out violations first. {summary} has all, with what to do about each."
)

FAILED_MAX = 8
"""Flights that failed a criterion and are listed."""

_NOTHING = "–"

_BEYOND = "beyond r_min [m]"
"""Head of the column beside that of the closest approach where flights have different r_min."""

_FLIGHT_COLUMNS = (
    "keepout_violations",
    "min_distance_m",
    "crossing_count",
    "crossing_interval_mean_s",
    "crossing_interval_predicted_s",
    "crossing_distance_min_m",
    "settling_time_s",
    "tracking_error_rms_m",
)


_APART = 1.25
"""Relative width of the column of distances beyond r_min, whose head would touch that of the one
before it.
"""

_WORDS_MAX, _NUMBER, _LETTER, _NAME_LETTER = 3.2, 0.9, 0.15, 0.13
"""Relative widths of a table's columns: of words at most, of numbers at least, and of a letter of a
heading and of a name [-].
"""


def flight_table(
    run: RunData,
    rows: pd.DataFrame,
    head: str,
    name: Callable[["pd.Series[Any]"], str],
    caption: str = "The flights, a row each, with their outcome.",
    *,
    flown_ratio: bool = False,
) -> Table:
    """Return a row per flight, and its outcome in words.

    Parameters
    ----------
    run, rows : the run, and the rows of some of its flights
    head, name : of the first column, and what it says of a flight
    caption : what the table shows
    flown_ratio : whether a column says the speed ratio that was flown, where that is not the one
        that was swept
    """
    shown = {column: (run.column(column).head, run.column(column)) for column in _FLIGHT_COLUMNS}
    if radii_differ(rows):
        rows = rows.assign(clearance_m=clearance(rows))
        beyond = {"clearance_m": (_BEYOND, run.column("clearance_m"))}
        first = list(shown.items())
        shown = dict(first[:2]) | beyond | dict(first[2:])
    if flown_ratio:
        rows = rows.assign(flown_ratio=rows["nu"].where(was_flown(rows)))
        shown = {"flown_ratio": ("ν flown [-]", run.column("nu"))} | shown
        caption += " ν is swept as the ratio of the speeds over the ground; as flown, in wind, it is that through the air."
    cells = [
        [name(row), outcome(row), *(_cell(row, key, of) for key, (_, of) in shown.items())]
        for _, row in rows.iterrows()
    ]
    words = [
        min(_WORDS_MAX, max(1.0, 0.1 * max((len(row[i]) for row in cells), default=0)))
        for i in (0, 1)
    ]
    # A name goes on over the next line where a word of it ends.
    parts = (part for row in cells for part in re.split(r" |(?<=_)(?=[a-z])", row[0]))
    words[0] = max(words[0], _NAME_LETTER * max(map(len, parts), default=0))
    # The longest word of a heading has to fit.
    widths = [
        *words,
        *(
            max(_APART if title == _BEYOND else _NUMBER, _LETTER * max(map(len, title.split())))
            for title, _ in shown.values()
        ),
    ]
    return Table(
        caption=caption,
        head=[head, "Outcome", *(title for title, _ in shown.values())],
        rows=cells,
        widths=widths,
        left_columns=2,
        breakable=True,
    )


def _cell(row: "pd.Series[Any]", key: str, of: Column) -> str:
    """Return a figure of a flight; a distance on the side of r_min on which it lies."""
    value = row.get(key)
    if key == "min_distance_m" and not pd.isna(value):
        return approach(float(value), float(row["keepout_radius_m"]))
    return (
        approach(float(value), 0.0, "+")
        if key == "clearance_m" and not pd.isna(value)
        else of.text(None if pd.isna(value) else float(value))
    )


def nearest_cells(rows: pd.DataFrame) -> tuple[str, str]:
    """Return the closest approach of some flights, and the closest one beyond the flight's own
    r_min; dashes without any.
    """
    distances, beyond = column(rows, "min_distance_m"), clearance(rows)
    if not np.isfinite(distances).any():
        return "–", "–"
    radius = float(column(rows, "keepout_radius_m")[np.nanargmin(distances)])
    return approach(float(np.nanmin(distances)), radius), approach(
        float(np.nanmin(beyond)), 0.0, "+"
    )


def trial_table(trials: list[Trial]) -> Table:
    """Return a row per trial: flights as planned, flown, completed and met, how they kept out, and
    how they ended.
    """
    rows = []
    for trial in trials:
        flown, counts = trial.flown, trial.verdict.counts
        rows.append([
            trial.title,
            f"{counts.planned}",
            f"{counts.flown}",
            f"{counts.completed}",
            f"{counts.met}",
            f"{counts.lost}",
            f"{counts.kept_out}",
            _NOTHING if (bound := trial_bound(trial)) is None else percent(bound),
            f"{counts.keepout_violations}",
            *nearest_cells(flown),
            f"{count(column(flown, 'guard_interventions') > 0.0)}",
            counted(flown["mode_at_end"]) if "mode_at_end" in flown else _NOTHING,
        ])  # fmt: skip
    closest = trials[0].run.column("min_distance_m").head
    head = [
        "Trial", "Planned", "Flown", "Completed", "Met", "Aircraft lost", "Kept out", f"Violate, at most ({percent(CONFIDENCE)})",
        "Keep-out violations", closest, _BEYOND, "With guard", "Mode at the end",
    ]  # fmt: skip
    return Table(
        caption="The trials: flights as planned, flown, completed and met, and how they ended.",
        head=head,
        rows=rows,
        widths=[2.0, 0.8, 0.7, 1.0, 0.6, 0.8, 0.7, 0.9, 1.0, 0.8, 0.8, 0.7, 1.4],
        print_size_pt=6.0,
    )


def criteria_table(trials: list[Trial]) -> Table:
    """Return a row per criterion of each trial: its limit, the worst among the flights that it
    judges and among all of them, how many it judges, and how many failed it.

    What every flight has to meet, as keeping out, has a row where one of several trials failed it:
    of a trial that is alone the tiles of page 1 say it.
    """
    rows = [
        [
            trial.title,
            criterion_title(trial.run, of),
            limits_words(trial, of),
            worst_words(trial.run, of, of.worst),
            _whose(trial, of),
            f"{of.judged} of {trial.verdict.counts.done}",
            f"{of.failed}",
        ]
        for trial in trials
        for of in trial.verdict.criteria
        if of.judged and (of.key in MEASURED or (of.failed and len(trials) > 1))
    ]
    head = ["Trial", "Criterion", "Limit", "Worst judged", "Worst of all", "Judged", "Not met"]
    widths = [1.6, 2.2, 1.0, 1.0, 1.8, 0.8, 0.6]
    first = len(trials) == 1
    return Table(
        caption="The criteria, with the worst measured values of the flights that they judge, and of all flights.",
        head=head[first:],
        rows=[row[first:] for row in rows],
        widths=widths[first:],
        left_columns=5 - first,
    )


def _whose(trial: Trial, of: Criterion) -> str:
    """Return the worst of a figure among all flights, with the flight that has it."""
    words = worst_words(trial.run, of, of.worst_of_all)
    return f"{words} ({of.worst_of_all.flight})" if of.worst_of_all else words


def fault_table(trial: Trial) -> Table:
    """Return a row per kind of fault: how the flights ended, and how close they came from the fault,
    of several from the first, on.
    """
    flown = trial.flown
    differ = radii_differ(flown)
    after = {
        str(row["flight_id"]): _closest_after(trial, row, beyond=differ)
        for _, row in flown.iterrows()
    }
    rows = []
    for kind, members in flown.groupby(names_of_faults(flown), sort=False):
        closest = [after[str(flight_id)] for flight_id in members["flight_id"]]
        known = [value for value in closest if value is not None]
        rows.append([
            str(kind),
            f"{len(members)}",
            f"{count(kept_out(members))}",
            f"{count(completed(members))}",
            f"{count(lost(members))}",
            f"{total(members, 'keepout_violations')}",
            *nearest_cells(members)[: 2 if differ else 1],
            number(min(known, default=None), "{:+.1f}" if differ else "{:.1f}")
            + (f" (of {len(known)})" if known and len(known) < len(closest) else ""),
            span(column(members, "end_distance_m"), "{:.0f}"),
            counted(members["mode_at_end"]),
        ])  # fmt: skip
    approach_head = trial.run.column("min_distance_m").head
    head = [
        "Fault", "Flights", "Kept out", "Completed", "Aircraft lost", "Keep-out violations", approach_head,
        *([_BEYOND, f"after the fault, {_BEYOND}"] if differ else ["Closest after the fault [m]"]),
        "At the end [m]", "Mode at the end",
    ]  # fmt: skip
    return Table(
        caption="The faults: how the flights ended, and how close they came from the fault on.",
        head=head,
        rows=rows,
        widths=[1.5, 0.7, 0.7, 1.1, 0.8, 1.0, 0.8, *([0.8] if differ else []), 1.2, 1.1, 1.8],
    )


def _closest_after(trial: Trial, row: "pd.Series[Any]", *, beyond: bool) -> float | None:
    """Return how close a flight came from its fault on [m], ``beyond`` its own r_min or not; None
    without fault or time history.
    """
    history = None if pd.isna(row["fault_time_s"]) else trial.run.history(str(row["flight_id"]))
    if history is None:
        return None
    after = history[history["time_s"] >= row["fault_time_s"]]
    if not len(after):
        return None
    return float(keepout_distance(after, trial.flight_config(row)).min()) - beyond * float(
        row["keepout_radius_m"]
    )


def failed_blocks(trials: Sequence[Trial]) -> list[Block]:
    """Return the flights that failed a criterion, the most severe first, ``FAILED_MAX`` at most,
    each with its reason.
    """
    run = trials[0].run
    by_key, summary = (
        {trial.key: trial for trial in trials},
        pd.concat([trial.rows for trial in trials]),
    )
    failed = summary.assign(clearance_m=clearance(summary))[~met(summary)]
    if not len(failed):
        return []
    differ = radii_differ(summary)
    rows = [
        [
            told_name(by_key[row["trial"]], row),
            number(row["nu"] if pd.notna(row.get("duration_s")) else None, "{:.2f}"),
            number(row["keepout_violations"], "{:.0f}"),
            _cell(row, "min_distance_m", run.column("min_distance_m")),
            *([_cell(row, "clearance_m", run.column("clearance_m"))] if differ else []),
            ending(row),
        ]
        for _, row in by_severity(failed).iloc[:FAILED_MAX].iterrows()
    ]
    margin = [_BEYOND] if differ else []
    ended = "How it ended, and the criteria that it failed"
    head = [
        "Flight",
        "ν flown [-]",
        "Keep-out violations",
        run.column("min_distance_m").head,
        *margin,
        ended,
    ]
    table = Table(
        caption="Flights that failed a criterion, each with its reason.",
        head=head,
        rows=rows,
        widths=[
            min(2.4, 0.12 * max(len(row[0]) for row in rows)),
            0.5,
            0.9,
            0.8,
            *([0.8] if differ else []),
            4.4,
        ],
        prose=True,
        left_columns=len(head),
        breakable=True,
    )
    words = _FAILED.format(failed=len(failed), listed=len(rows), summary=SUMMARY)
    return [Text(words), table]
