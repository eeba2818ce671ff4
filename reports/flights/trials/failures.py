"""Which flights failed a criterion, were not flown, or are to be noted without failing, in lines
for page 1.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from common.faults import faults_in
from common.premises import TITLES, ratio_column
from common.verdict import Premises, RunVerdict
from reports.document.tables import ending, first_sentence, in_symbols, number, span
from reports.flights.criteria import counted, criterion_title, limits_words
from reports.flights.names import told_name
from reports.run.columns import (
    Mask,
    column,
    count,
    largest,
    met,
    was_flown,
)
from reports.run.faults import fault_name
from reports.run.trials import Trial

_NAMED_MAX = 3
"""Flights of a trial that the verdict names one by one."""

_SEVERAL = {False: ", ", True: "; "}
"""Between the names of flights, whether or not these have commas of their own."""


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
    """Return which flights of a trial failed a criterion, each of a few, else by criterion; and
    which were not flown.
    """
    rows = trial.rows
    failed = rows[~met(rows)]
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
        reasons.setdefault(_reason(row), []).append(told_name(trial, row))
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
        f"{trial.title}: {len(flights)} of {trial.planned} not flown; the first,"
        f" {told_name(trial, first)}: {ending(first)}"
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
