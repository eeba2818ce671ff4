"""Tables of trials and of their flights, and lines on those that failed for page 1."""

import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

from common.columns import Column
from common.faults import faults_in
from common.intervals import CONFIDENCE, percent
from common.premises import TITLES, ratio_column
from common.run_layout import SUMMARY
from common.verdict import Criterion, Premises, RunVerdict
from reports.document.blocks import Block, Table, Text
from reports.document.tables import (
    Cell,
    approach,
    ending,
    first_sentence,
    in_symbols,
    number,
    outcome,
    rows_table,
    span,
)
from reports.flights.criteria import (
    MEASURED,
    counted,
    criterion_title,
    limits_words,
    trial_bound,
    worst_words,
)
from reports.flights.names import name_in_run
from reports.run.columns import (
    Mask,
    by_severity,
    clearance,
    column,
    completed,
    count,
    kept_out,
    largest,
    lost,
    met,
    passed,
    radii_differ,
    total,
    was_flown,
)
from reports.run.flight_config import fault_name, names_of_faults
from reports.run.run_data import RunData
from reports.run.time_history import keepout_distance
from reports.run.trials import Name, Trial

_FAILED = (
    "{failed:,} flights did not meet every criterion; {listed:,} are listed, lost ones, diverged"
    " ones"
    " and keep-out violations first. {summary} has all, with what to do about each."
)

FAILED_MAX = 8
"""Flights that failed a criterion and are listed."""

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
    name: Name,
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
    keys = list(_FLIGHT_COLUMNS)
    if radii_differ(rows):
        rows = rows.assign(clearance_m=clearance(rows))
        keys.insert(2, "clearance_m")
    names, outcomes = ([words(row) for _, row in rows.iterrows()] for words in (name, outcome))
    # A name goes on over the next line where a word of it ends.
    parts = [part for words in names for part in re.split(r" |(?<=_)(?=[a-z])", words)]
    least = _NAME_LETTER * max(map(len, parts), default=0)
    cells = [
        Cell(head, name, width=max(least, _words_width(names))),
        Cell("Outcome", outcome, width=_words_width(outcomes)),
    ]
    if flown_ratio:
        caption += _FLOWN_RATIO
        cells.append(Cell("ν flown [-]", _ratio_flown, "{:.2f}", _NUMBER))
    for key in keys:
        of = _figure_cell(run, key, _APART if key == "clearance_m" else _NUMBER)
        # The longest word of a heading has to fit.
        longest = _LETTER * max(map(len, of.head.split()))
        cells.append(of._replace(width=max(of.width, longest)))
    shown = [row for _, row in rows.iterrows()]
    return rows_table(shown, cells, caption=caption, left_columns=2, breakable=True)


_FLOWN_RATIO = (
    " ν is swept as the ratio of the speeds over the ground; as flown, in wind, it is that through"
    " the air."
)


def _words_width(words: Sequence[str]) -> float:
    return min(_WORDS_MAX, max(1.0, 0.1 * max(map(len, words), default=0)))


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
    cells = [
        Cell("Trial", lambda of: of.title, width=2.0),
        Cell("Planned", lambda of: of.verdict.counts.planned, "{:.0f}", 0.8),
        Cell("Flown", lambda of: of.verdict.counts.flown, "{:.0f}", 0.7),
        Cell("Completed", lambda of: of.verdict.counts.completed, "{:.0f}"),
        Cell("Met", lambda of: of.verdict.counts.met, "{:.0f}", 0.6),
        Cell("Aircraft lost", lambda of: of.verdict.counts.lost, "{:.0f}", 0.8),
        Cell("Kept out", lambda of: of.verdict.counts.kept_out, "{:.0f}", 0.7),
        Cell(f"Violate, at most ({percent(CONFIDENCE)})", _bound, width=0.9),
        Cell("Keep-out violations", lambda of: of.verdict.counts.keepout_violations, "{:.0f}"),
        Cell(
            trials[0].run.column("min_distance_m").head,
            lambda of: nearest_cells(of.flown)[0],
            width=0.8,
        ),
        Cell(_BEYOND, lambda of: nearest_cells(of.flown)[1], width=0.8),
        Cell("With guard", _guarded, "{:.0f}", 0.7),
        Cell("Mode at the end", _modes, width=1.4),
    ]
    return rows_table(
        trials,
        cells,
        caption="The trials: flights as planned, flown, completed and met, and how they ended.",
        print_size_pt=6.0,
    )


def _bound(trial: Trial) -> str | None:
    bound = trial_bound(trial)
    return None if bound is None else percent(bound)


def _guarded(trial: Trial) -> int:
    return count(column(trial.flown, "guard_interventions") > 0.0)


def _modes(trial: Trial) -> str | None:
    return counted(trial.flown["mode_at_end"]) if "mode_at_end" in trial.flown else None


def criteria_table(trials: list[Trial]) -> Table:
    """Return a row per criterion of each trial: its limit, the worst among the flights that it
    judges and among all of them, how many it judges, and how many failed it.

    What every flight has to meet, as keeping out, has a row where one of several trials failed it:
    of a trial that is alone the tiles of page 1 say it.
    """
    several = len(trials) > 1
    judged = [
        {"trial": trial, "of": of}
        for trial in trials
        for of in trial.verdict.criteria
        if of.judged and (of.key in MEASURED or (of.failed and several))
    ]
    cells = [
        Cell("Trial", lambda row: row["trial"].title, width=1.6),
        Cell("Criterion", lambda row: criterion_title(row["trial"].run, row["of"]), width=2.2),
        Cell("Limit", lambda row: limits_words(row["trial"], row["of"])),
        Cell("Worst judged", _worst),
        Cell("Worst of all", lambda row: _whose(row["trial"], row["of"]), width=1.8),
        Cell("Judged", _judged, width=0.8),
        Cell("Not met", lambda row: row["of"].failed, "{:.0f}", 0.6),
    ]
    return rows_table(
        judged,
        cells if several else cells[1:],
        caption="The criteria, with the worst measured values of the flights that they judge, and"
        " of all flights.",
        left_columns=4 + several,
    )


def _worst(row: dict[str, Any]) -> str:
    return worst_words(row["trial"].run, row["of"], row["of"].worst)


def _judged(row: dict[str, Any]) -> str:
    return f"{row['of'].judged} of {row['trial'].verdict.counts.done}"


def _whose(trial: Trial, of: Criterion) -> str:
    """Return the worst of a figure among all flights, with the flight that has it."""
    words = worst_words(trial.run, of, of.worst_of_all)
    return f"{words} ({of.worst_of_all.flight})" if of.worst_of_all else words


def fault_table(trial: Trial) -> Table:
    """Return a row per kind of fault: how the flights ended, and how close they came from the
    fault, of several from the first, on.
    """
    flown = trial.flown
    differ = radii_differ(flown)
    after = {
        str(row["flight_id"]): _closest_after(trial, row, beyond=differ)
        for _, row in flown.iterrows()
    }
    kinds = [
        {"kind": str(kind), "rows": rows, "after": [after[str(of)] for of in rows["flight_id"]]}
        for kind, rows in flown.groupby(np.array(names_of_faults(flown)), sort=False)
    ]
    since = f"after the fault, {_BEYOND}" if differ else "Closest after the fault [m]"
    cells = [
        Cell("Fault", "kind", width=1.5),
        Cell("Flights", lambda of: len(of["rows"]), "{:.0f}", 0.7),
        Cell("Kept out", lambda of: count(kept_out(of["rows"])), "{:.0f}", 0.7),
        Cell("Completed", lambda of: count(completed(of["rows"])), "{:.0f}", 1.1),
        Cell("Aircraft lost", lambda of: count(lost(of["rows"])), "{:.0f}", 0.8),
        Cell("Keep-out violations", lambda of: total(of["rows"], "keepout_violations"), "{:.0f}"),
        Cell(
            trial.run.column("min_distance_m").head,
            lambda of: nearest_cells(of["rows"])[0],
            width=0.8,
        ),
        Cell(_BEYOND, lambda of: nearest_cells(of["rows"])[1], width=0.8),
        Cell(since, lambda of: _least_words(of["after"], signed=differ), width=1.2),
        Cell("At the end [m]", lambda of: span(column(of["rows"], "end_distance_m"), "{:.0f}")),
        Cell("Mode at the end", lambda of: counted(of["rows"]["mode_at_end"]), width=1.8),
    ]
    return rows_table(
        kinds,
        [cell for cell in cells if differ or cell.head != _BEYOND],
        caption="The faults: how the flights ended, and how close they came from the fault on.",
    )


def _least_words(distances: Sequence[float | None], *, signed: bool) -> str:
    """Return the least of the known distances, and how many are known where that is not all."""
    known = [distance for distance in distances if distance is not None]
    words = number(min(known, default=None), "{:+.1f}" if signed else "{:.1f}")
    return f"{words} (of {len(known)})" if 0 < len(known) < len(distances) else words


def _closest_after(trial: Trial, row: "pd.Series[Any]", *, beyond: bool) -> float | None:
    """Return how close a flight came from its fault on [m], from its r_min on if ``beyond``; None
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
    run, by_key = trials[0].run, {trial.key: trial for trial in trials}
    summary = pd.concat([trial.rows for trial in trials])
    failed = summary.assign(clearance_m=clearance(summary))[~met(summary)]
    if not len(failed):
        return []
    shown = [row for _, row in by_severity(failed).iloc[:FAILED_MAX].iterrows()]
    names = [name_in_run(by_key[row["trial"]], row) for row in shown]
    distances = ["min_distance_m", *(["clearance_m"] if radii_differ(summary) else [])]
    cells = [
        Cell(
            "Flight",
            lambda row: name_in_run(by_key[row["trial"]], row),
            width=min(2.4, 0.12 * max(map(len, names))),
        ),
        Cell("ν flown [-]", _ratio_flown, "{:.2f}", 0.5),
        Cell("Keep-out violations", "keepout_violations", "{:.0f}", 0.9),
        *(_figure_cell(run, key, 0.8) for key in distances),
        Cell("How it ended, and the criteria that it failed", ending, width=4.4),
    ]
    table = rows_table(
        shown,
        cells,
        caption="Flights that failed a criterion, each with its reason.",
        prose=True,
        left_columns=len(cells),
        breakable=True,
    )
    words = _FAILED.format(failed=len(failed), listed=len(shown), summary=SUMMARY)
    return [Text(words), table]


def _ratio_flown(row: "pd.Series[Any]") -> float | None:
    return float(row["nu"]) if pd.notna(row.get("duration_s")) else None


def _figure_cell(run: RunData, key: str, width: float) -> Cell:
    """Return the column of a figure of flights."""
    of = run.column(key)
    head = _BEYOND if key == "clearance_m" else of.head
    return Cell(head, lambda row: _cell(row, key, of), width=width)


_NAMED_MAX = 3
"""Flights of a trial that the verdict names one by one."""

_SEVERAL = {False: ", ", True: "; "}
"""Between the names of flights: without and with commas in the names."""


_LOST_TRACK = (
    "{far:,} of the {settled:,} settled flights lost their track again, by up to {most:.3g} m rms;"
    " no criterion limits it: {causes}."
)
_LOST_TRACK_ALONE = (
    "The flight lost its track again, by {most:.3g} m rms; no criterion limits it: {causes}."
)
_CAUSE = "{what} in {here:,} of these and in {there:,} of the others"
_NO_CAUSE = "nothing in the summary sets them apart"
_NOTHING = "nothing in the summary explains it"

_USUAL_MODES = (
    "approach",
    "tracking",
    "found",
    "departing",
    "retreating",
    "gliding",
    "terminating",
)
"""Modes in which a flight tracks its reference, or in which the tracking error is not measured."""


_WORDS = {"modes": "", "turbulence": "none"}
"""Columns of words, and what stands in them for nothing."""


def failure_lines(trial: Trial) -> list[str]:
    """Return which flights of a trial failed what is required of them, each of a few, else by
    criterion; and which could not be flown.
    """
    rows = trial.rows
    failed = rows[~passed(rows)]
    begun = was_flown(failed)
    flown, unflown = failed[begun], failed[~begun]
    lines = (
        [*_named(trial, flown)] if len(flown) <= _NAMED_MAX else [_by_criterion(trial, len(flown))]
    )
    lines += (
        [*_named(trial, unflown)] if len(unflown) <= _NAMED_MAX else [_not_flown(trial, unflown)]
    )
    missing = trial.verdict.counts.left
    return [
        *lines,
        *([f"{trial.title}: {missing} of {trial.planned} not flown yet"] if missing else []),
    ]


def _named(trial: Trial, flights: pd.DataFrame) -> Iterator[str]:
    """Yield the flights by name, those of one reason together."""
    reasons: dict[str, list[str]] = {}
    for _, row in flights.iterrows():
        reasons.setdefault(_reason(row), []).append(name_in_run(trial, row))
    for reason, names in reasons.items():
        yield f"{_SEVERAL[bool(trial.swept)].join(names)}: {reason}"


def _by_criterion(trial: Trial, failed: int) -> str:
    """Return how many of the flights that were flown failed which criterion."""
    counts, flown = trial.verdict.counts, trial.flown
    depth = largest(column(flown, "keepout_depth_m"))
    parts = (
        [f"{counts.violated} violated the keep-out area, by up to {number(depth, '{:.1f} m')}"]
        if counts.violated
        else []
    )
    if without := counts.flown - counts.completed:
        parts.append(f"{without} did not complete the mission")
    parts += [
        f"{c.failed}: {criterion_title(trial.run, c)}, {limits_words(trial, c)}"
        for c in trial.verdict.criteria
        if c.failed and c.key not in ("keep_out", "mission")
    ]
    why = f" ({'; '.join(parts)})" if parts else ""
    return (
        f"{trial.title}: {failed} of {counts.flown} flights{' flown' * (counts.not_flown > 0)}"
        f" failed a criterion{why}"
    )


def _not_flown(trial: Trial, flights: pd.DataFrame) -> str:
    """Return how many flights were not flown, and why the first of them was not."""
    first = flights.iloc[0]
    return (
        f"{trial.title}: {len(flights)} of {trial.planned} could not be flown; the first,"
        f" {name_in_run(trial, first)}: {ending(first)}"
    )


def _reason(row: "pd.Series[Any]") -> str:
    """Return why a flight failed a criterion, without advice; that it did not settle its message
    says already.
    """
    ended = "" if row["outcome"] == "not_settled" else str(row["outcome"]).replace("_", " ")
    message = first_sentence(in_symbols(str(row["message"])))
    return "; ".join(words for words in (ended, message) if words)


def noteworthy(verdict: RunVerdict, flown: pd.DataFrame) -> list[str]:
    """Return what a reader has to know of the flights, whether or not a criterion asks for it."""
    lines = _premise_lines(verdict.premises, flown)
    unable = column(flown, "guard_lost_s")
    if without := count(unable > 0.0):
        lines.append(
            f"{_in_flights(without, len(flown))} the guard could not hold its own radius, for up to"
            f" {np.nanmax(unable):.1f} s."
        )
    if unflown := count(column(flown, "manoeuvres_unflown") > 0.0):
        flights = f"{unflown:,} flight{'s' * (unflown > 1)}"
        lines.append(
            f"In {flights} a manoeuvre of the vessel begins after the end of the flight, and was"
            " never flown."
        )
    begun = flown[column(flown, "fault_time_s") <= column(flown, "duration_s")]
    if len(begun):
        faults = [
            (fault_name(kind), at)
            for row in begun.to_dict("records")
            for kind, at in faults_in(row)
            if at <= row["duration_s"]
        ]
        kinds = pd.Series([kind for kind, _ in faults])
        times = span(np.array([at for _, at in faults]), "{:.0f}")
        kind = kinds.iloc[0] if kinds.nunique() == 1 else counted(kinds)
        lines.append(
            f"{_in_flights(len(begun), len(flown))} a fault began, as the scenario has it: {kind},"
            f" at {times} s."
        )
    return lines


def _premise_lines(premises: Premises, flown: pd.DataFrame) -> list[str]:
    """Return in how many flights a premise of the keep-out guard did not hold, and which."""
    if not premises.exceeded:
        return []
    largest_of = "; ".join(
        f"{TITLES[term]} in {number_of:,}, up to {np.nanmax(column(flown, ratio_column(term))):.2f}"
        for term, number_of in premises.terms.items()
    )
    return [
        f"{_in_flights(premises.exceeded, premises.measured)} an error was larger than the keep-out"
        f" guard reckons with, as a ratio to that: {largest_of}."
    ]


def _in_flights(some: int, flown: int) -> str:
    return "In the flight" if flown == 1 else f"In {some:,} of {flown:,} flights"


def tracking_lines(trial: Trial, *, only: bool = True) -> list[str]:
    """Return in a line how many flights left the band again in which they had settled, and what
    happened after that.

    It is about flights whose tracking error no criterion limits: of the others the criterion tells.

    Parameters
    ----------
    trial : whose flights
    only : whether it is the run's only one, else the line begins with its title
    """
    criteria, flown = trial.criteria, trial.flown
    if criteria.get("tracking_error_rms_m") and criteria.get("settles", True):
        return []
    band = float(trial.setting("flight.settling_band_m"))
    errors = column(flown, "tracking_error_rms_m")
    far, others = flown[errors > band], flown[errors <= band]
    if not len(far):
        return []
    most = float(np.nanmax(errors))
    if len(flown) == 1:
        happened = [what for what, mask in _after_settling(far).items() if mask.any()]
        line = _LOST_TRACK_ALONE.format(most=most, causes=", ".join(happened) or _NOTHING)
    else:
        line = _LOST_TRACK.format(
            far=len(far),
            settled=len(far) + len(others),
            most=most,
            causes=", ".join(_causes(far, others)) or _NO_CAUSE,
        )
    return [line if only else f"{trial.title}: {line}"]


def _causes(far: pd.DataFrame, others: pd.DataFrame) -> Iterator[str]:
    """Yield what happened after settling, in how many of the flights that left the band and in how
    many of the others; not what happened in all.
    """
    for what, mask in _after_settling(pd.concat([far, others])).items():
        here, there = count(mask[: len(far)]), count(mask[len(far) :])
        if here and here + there < len(mask):
            yield _CAUSE.format(what=what, here=here, there=there)


def _after_settling(rows: pd.DataFrame) -> dict[str, Mask]:
    """Return what took flights off their reference after they had settled, and which flights."""
    settled = column(rows, "settling_time_s")
    modes, air = (
        rows[name].fillna(no) if name in rows else pd.Series(no, rows.index)
        for name, no in _WORDS.items()
    )
    others = {
        mode: None
        for flown in modes
        for mode in str(flown).split(", ")
        if mode and mode not in _USUAL_MODES
    }
    return {
        "the vessel manoeuvred": column(rows, "manoeuvre_end_s") > settled,
        "the keep-out guard changed commands": column(rows, "guard_after_settling_s") > 0.0,
        "a fault began": column(rows, "fault_time_s") > settled,
        "the air was turbulent": ~air.isin(["none"]).to_numpy(),
        **{
            f"the mode was '{mode}' for a time": modes.str.contains(mode, regex=False).to_numpy()
            for mode in others
        },
    }
