"""What page 1 says of flights: the state of the run, the answer to the question of its study, and
the figures that it rests on.
"""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np
import pandas as pd

from common.intervals import percent
from common.premises import UNEXPLAINED
from common.verdict import COMPLETED, MET, Counts, Criterion, KeepOut, RunVerdict
from reports.document.blocks import Card, LossCard, Verdict
from reports.document.state import state_words
from reports.document.tables import approach
from reports.finding.searches import search_answer, search_cards
from reports.flights.criteria import (
    MEASURED,
    SCALED,
    TRACKING,
    bound_note,
    counted,
    criterion_title,
    limit_words,
    limited_by_default,
    worst_in_words,
    worst_words,
)
from reports.flights.names import name_in_run
from reports.flights.trials.tables import failure_lines, noteworthy, tracking_lines
from reports.measurement.flights import (
    sulphur_below,
    sulphur_cards,
    sulphur_headline,
    sulphur_remarks,
)
from reports.run.columns import (
    Mask,
    beside_vessel,
    column,
    completed,
    count,
    flights_flown,
    kept_out,
    largest,
    met,
    radii_differ,
    violated,
)
from reports.run.run_data import RunData
from reports.run.trials import SHAPES, Trial, measured_from, read_trials

_KEPT = {
    KeepOut.KEPT_OUT: "kept out",
    KeepOut.OUTSIDE: "stayed outside of the keep-out area",
    KeepOut.VIOLATED: "violated the keep-out area",
    KeepOut.UNKNOWN: "is not known to have kept out",
    KeepOut.NO_AREA: "had no area to keep out of",
}

_ENDED: Mapping[str, str] = MappingProxyType(
    {
        COMPLETED: "finished",
        "infeasible": "could not be flown",
        "trim_failed": "could not be trimmed",
        "incomplete": "did not finish",
        "not_settled": "did not settle",
        "failed": "failed",
        "aircraft_lost": "lost its aircraft",
        "diverged": "diverged",
    }
)
"""How a flight ended, by its outcome; one that is unexplained says so before."""

_ONE_FLIGHT = "The flight {kept} and {ended}; it met {met} of the {judged} criteria that judge it"
_SWEEP = (
    "{kept:,} of {beside:,} {points} kept out, {ended}. Crossing intervals are up to {worst} off"
    " the prediction, limit {limit}"
)

_PREMISES = (
    "In {exceeded:,} of {measured:,} flights an error exceeded what the guard reckons with;"
    " {violated:,} violated the area, {unexplained:,} of them with every premise held"
)


def premises_exceeded(run: RunData) -> str:
    """Return in how many flights a premise of the guard did not hold, and what came of it."""
    premises, counts = run.verdict.premises, run.verdict.counts
    if not premises.measured:
        return ""
    return _PREMISES.format(
        exceeded=premises.exceeded,
        measured=premises.measured,
        violated=counts.violated,
        unexplained=counts.unexplained,
    )


def kept_out_and_finished(run: RunData) -> str:
    """Return how many flights kept out and finished, and the worst of each criterion over all of
    them; of a sweep whether they cross as often as predicted.
    """
    if run.verdict.counts.done == 1:
        return _one_flight(run)
    return _sweep(run) or _flights(run)


def _flights(run: RunData) -> str:
    counts = run.verdict.counts
    kept = f"{counts.kept_out:,} of {counts.beside:,} flights kept out"
    first = kept if counts.beside else f"{counts.done:,} flights about a circle, without a vessel"
    said = f"{first}, {_ended(run, counts)}"
    worst = ", ".join(_worst(run))
    return f"{said}. Worst: {worst}" if worst else said


def _ended(run: RunData, counts: Counts) -> str:
    """Return how many flights finished, and how many came to grief, by what they did."""
    rows = run.summary
    missed = completed(rows) & ~met(rows) & ~violated(rows)
    troubles = {
        "violated": counts.violated,
        "lost": counts.lost - counts.diverged,
        "diverged": counts.diverged,
        "could not be flown": counts.not_flown,
        "unknown": counts.unknown - counts.not_flown - counts.diverged,
        "missed a limit": count(missed),
    }
    troubled = [f"{number:,} {words}" for words, number in troubles.items() if number]
    return ", ".join([f"{counts.completed:,} finished", *troubled])


def _worst(run: RunData) -> Iterator[str]:
    """Yield the worst of the closest approach and of each criterion over all flights."""
    whole = run.verdict.whole
    if whole.closest:
        beyond = whole.closest.distance_m - whole.closest.radius_m
        yield f"{approach(beyond, 0.0)} m beyond r_min"
    for key in MEASURED:
        criterion = whole.criterion(key)
        if criterion.judged and criterion.worst_of_all:
            yield worst_in_words(run, criterion)


def _one_flight(run: RunData) -> str:
    row = run.summary.iloc[0].to_dict()
    judged = [of for of in run.verdict.whole.criteria if of.judged]
    return _ONE_FLIGHT.format(
        kept=_KEPT[KeepOut.of(row)],
        ended=_ENDED.get(str(row["outcome"]), str(row["outcome"]).replace("_", " ")),
        met=sum(of.failed == 0 for of in judged),
        judged=len(judged),
    )


def _sweep(run: RunData) -> str:
    """Return whether the points of a sweep keep out and cross as often as predicted; no word of
    flights that are no sweep, or whose crossings no criterion judges.
    """
    counts, criterion = run.verdict.counts, run.verdict.whole.criterion("crossing_interval_error")
    swept = [trial.swept for trial in read_trials(run)]
    if len(swept) != 1 or not swept[0] or not criterion.judged or not counts.beside:
        return ""
    return _SWEEP.format(
        kept=counts.kept_out,
        beside=counts.beside,
        points="speed ratios" if list(swept[0]) == ["nu"] else "flights",
        ended=_ended(run, counts),
        worst=worst_words(run, criterion, criterion.worst_of_all),
        limit=limit_words(run, criterion.key, criterion.column, criterion.limits[0]).lstrip("≤ "),
    )


Answer = Callable[[RunData], str]
"""Returns the sentence that answers the question of a study, given its run; no word where the run
has nothing to answer it with. Some flight was flown.
"""

ROUNDING = 1e-9
"""What binary fractions may add to a figure that is limited by design [-]."""

_ALLOWED = "not required of every flight"
"""What is said of an outcome where some flights are required to keep out, and no more."""

_COMMAND, _DEMAND = (
    f"Heading rate {what}, largest, as a ratio to ω_max" for what in ("commanded", "demanded")
)
"""Names of figures."""

_QUANTILE, _QUANTILE_OF = 0.99, 100
"""Fraction of flights whose tracking error stays below the one that is shown, and number of flights
from which on it is shown.
"""

_BESIDE = 1.0
"""How much nearer the funnel is horizontally than in space, from which on both are shown [m]."""

_NOTHING_FLOWN = "Nothing was flown: of {planned:,}, {outcomes}"
_GUARD_IS_WRONG = "The keep-out guard is wrong in {flights:,} of {done:,} flights: {unexplained}"

_ONLY_TO_KEEP_OUT = (
    "Of the flights, {alone:,} had only to stay outside of the keep-out area: {outside:,} did, and"
    " {finished:,} also finished."
)
_NOT_JUDGED = "{flight}, not judged; of {judged:,} judged {worst}, required {required}"
_RESUME = "The run did not end; continue it with --resume."

_POINTS = {
    "own": "Each point of the sweep has starts, noise and sampled instruments of its own.",
    "common": "All points of the sweep have the same starts, noise and sampled instruments: what"
    " differs between them follows from what is swept, but an error that they have in common may"
    " come from the one sample.",
}
"""What page 1 says of the points of a sweep, by the kind of their random numbers."""


def flight_verdict(
    run: RunData, trials: Sequence[Trial], answer: Answer = kept_out_and_finished
) -> Verdict:
    """Return what the run's verdict says, in words.

    Parameters
    ----------
    run, trials : the run, and its trials
    answer : to the question of its study
    """
    flown, only = flights_flown(run.summary), len(trials) == 1
    return Verdict(
        headline=". ".join(_headline(run, answer)),
        detail=" ".join(_detail(run)),
        failures=[
            *_warnings(run),
            *(line for trial in trials for line in failure_lines(trial)),
            *(line for trial in trials for line in tracking_lines(trial, only=only)),
            *noteworthy(run.verdict, flown),
            *sulphur_remarks(run),
        ],
        figures=[*(search_cards(run) or sulphur_cards(run)), *_figures(trials, flown)],
        # A fuel that was not measured, or not surely, has no tile that says so.
        complete=sulphur_below(run),
        exit_status=run.verdict.exit_status,
    )


def _headline(run: RunData, answer: Answer) -> Iterator[str]:
    """Yield the sentences of the headline: the state first, and what must never happen before what
    was measured.
    """
    verdict, counts = run.verdict, run.verdict.counts
    yield from state_words(
        "flights",
        counts.done,
        counts.planned,
        is_done=verdict.is_done,
        interrupted=verdict.interrupted,
        missing="all comparisons were flown",
    )
    if not counts.flown:
        ends = counted(run.summary["outcome"].astype(str).str.replace("_", " "))
        yield _NOTHING_FLOWN.format(planned=counts.planned, outcomes=ends or "none was begun")
        return
    if counts.unexplained:
        yield _GUARD_IS_WRONG.format(
            flights=counts.unexplained, done=counts.done, unexplained=UNEXPLAINED
        )
    if search := search_answer(run):
        yield search
        return
    sulphur = sulphur_headline(run)
    if not sulphur or verdict.exit_status != MET:
        yield answer(run) or kept_out_and_finished(run)
    if sulphur:
        yield sulphur


def _warnings(run: RunData) -> list[str]:
    """Return what files of the run lack that a reader of its results has to know."""
    files = run.manifest.get("vessel_files", {}).values()
    return [str(file["warning"]) for file in files if file.get("warning")]


def _detail(run: RunData) -> Iterator[str]:
    """Yield what a reader has to know of the tiles."""
    numbers = run.manifest.get("random_numbers_of_points", {}).values()
    yield from (words for kind, words in _POINTS.items() if kind in numbers)
    if alone := run.verdict.counts.required.get("keep_out", 0):
        rows = run.summary[run.summary["required"] == "keep_out"]
        outside = count(kept_out(rows)) + run.verdict.counts.outside
        yield _ONLY_TO_KEEP_OUT.format(
            alone=alone, outside=outside, finished=count(completed(rows))
        )
    if not run.verdict.is_done:
        yield _RESUME


def _figures(trials: Sequence[Trial], flown: pd.DataFrame) -> list[Card]:
    """Return the figures of a verdict, those that say the most first."""
    run = trials[0].run
    verdict, counts = run.verdict, run.verdict.counts
    if not counts.flown:
        return [Card("Flights flown", f"0 of {counts.planned:,}", "all", met=False)]
    found = [
        _kept_out_card(run, trials),
        _finished_card(verdict),
        _lost_card(verdict),
        _unexplained_card(verdict),
        _closest_card(trials, beside_vessel(flown)),
        *(_worst_card(trials, key) for key in MEASURED),
        *_further(trials, flown),
    ]
    return [card for card in found if card is not None]


def _loss_is_allowed(verdict: RunVerdict) -> bool:
    """Return whether a flight did what is required of it, which was to stay outside, and no
    more.
    """
    counts = verdict.counts
    return bool(counts.required.get("keep_out")) and counts.passed > counts.met


def _kept_out_card(run: RunData, trials: Sequence[Trial]) -> Card | None:
    """Return how many flights kept out, of those that have an area to keep out of; nothing of a
    flight alone that did.
    """
    verdict, counts = run.verdict, run.verdict.counts
    all_of_them = counts.kept_out == counts.beside
    if not counts.beside or (counts.planned == 1 and all_of_them):
        return None
    others = {
        "violated the area": counts.violated,
        "unknown": counts.unknown,
        "lost or failed outside": counts.outside,
    }
    note = _noted(
        *(f"{number:,} {words}" for words, number in others.items() if number),
        *bound_note(run, trials),
    )
    known = f"{counts.kept_out:,} of {counts.beside:,}"
    if counts.outside and not (counts.violated or counts.unknown) and _loss_is_allowed(verdict):
        return Card("Kept out", known, _ALLOWED, note=note)
    return Card("Kept out", known, "all", all_of_them, note)


def _finished_card(verdict: RunVerdict) -> Card | None:
    """Return how many flights finished; nothing of a flight alone that did."""
    counts = verdict.counts
    value = f"{counts.completed:,} of {counts.done:,}"
    if counts.planned == counts.completed == 1:
        return None
    if _loss_is_allowed(verdict):
        return Card("Finished", value, _ALLOWED)
    return Card("Finished", value, "all", counts.completed == counts.done)


def _lost_card(verdict: RunVerdict) -> Card | None:
    """Return how many flights lost their aircraft or diverged, and which, where some did."""
    name = "Aircraft lost or diverged" if verdict.counts.diverged else "Aircraft lost"
    names = verdict.flights.get("lost", ())
    if not names:
        return None
    note = ", ".join(names[:2]) + (f" and {len(names) - 2:,} more" if len(names) > 2 else "")
    if not verdict.lost_against_requirement:
        return LossCard(name, f"{len(names):,}", _ALLOWED, note=note)
    return Card(name, f"{len(names):,}", "0", False, note)


def _unexplained_card(verdict: RunVerdict) -> Card | None:
    """Return how many violations show that the guard is wrong, where there are such."""
    name, wrong = "Violations with every premise of the guard held", verdict.counts.unexplained
    return Card(name, f"{wrong:,}", "0", met=False) if wrong else None


def _closest_card(trials: Sequence[Trial], beside: pd.DataFrame) -> Card | None:
    """Return how close the closest flight came, to what, and which one it is: the shape of the
    keep-out area decides what a distance is.
    """
    closest = trials[0].run.verdict.whole.closest
    if closest is None:
        return None
    row = beside[beside["flight_id"] == closest.flight].iloc[0]
    note = _named(trials, closest.flight)
    distance, radius = closest.distance_m, closest.radius_m
    horizontal = float(row.get("horizontal_distance_min_m", math.nan))
    if closest.shape == "sphere" and horizontal < distance - _BESIDE:
        note += f", {horizontal:.1f} m horizontally from the stack"
    kept = distance >= radius
    if radii_differ(beside):
        name = "Closest approach, beyond the flight's own r_min"
        note += f", {approach(distance, radius)} m where r_min is {radius:g} m"
        return Card(name, f"{approach(distance - radius, 0.0)} m", "≥ 0 m", kept, note)
    shapes = {trial.shape for trial in trials}
    is_known = len(shapes) == 1 and shapes <= set(SHAPES)
    name = f"Closest approach, {trials[0].measured_from}" if is_known else "Closest approach"
    if not is_known and closest.shape:
        note += f", {measured_from(closest.shape)}"
    return Card(name, f"{approach(distance, radius)} m", f"≥ {radius:g} m", kept, note)


def _named(trials: Sequence[Trial], flight: str) -> str:
    """Return what a flight is called beside a figure; no word of one that is alone."""
    if trials[0].run.verdict.counts.planned == 1:
        return ""
    for trial in trials:
        rows = trial.rows[trial.rows["flight_id"] == flight]
        if len(rows):
            return name_in_run(trial, rows.iloc[0])
    return flight


def _worst_card(trials: Sequence[Trial], key: str) -> Card | None:
    """Return the worst figure of a criterion over all flights, and whose it is.

    Where that flight is not judged by it, the worst of those that are stands beside it. A figure
    that no flight is judged by is shown where a criterion limits it by default.
    """
    run = trials[0].run
    criterion = run.verdict.whole.criterion(key)
    if not (criterion.judged or (criterion.worst_of_all and limited_by_default(trials, key))):
        return None
    title = criterion_title(run, criterion)
    worst, of_all = criterion.worst, criterion.worst_of_all
    name = f"{title}, worst" if run.verdict.counts.planned > 1 else title
    nearly_all = _nearly_all(run, key)
    if criterion.met and of_all and worst and _is_within(of_all.value, worst.limit):
        worst = of_all
    if criterion.judged and (not criterion.met or of_all in (None, worst)):
        note = _noted(_named(trials, worst.flight) if worst else "", nearly_all)
        words = worst_words(run, criterion, worst)
        return Card(name, words, _required(trials, criterion), criterion.met, note)
    note = _noted(_named(trials, of_all.flight) if of_all else "", nearly_all)
    if criterion.judged:
        note = _NOT_JUDGED.format(
            flight=note,
            judged=criterion.judged,
            worst=worst_words(run, criterion, worst),
            required=_required(trials, criterion),
        )
    return Card(name, worst_words(run, criterion, of_all), note=note)


def _is_within(value: float | str, limit: object) -> bool:
    """Return whether the worst of all flights is within the limit of those that are judged by
    it.
    """
    return isinstance(value, float | int) and isinstance(limit, float | int) and value <= limit


def _noted(*notes: str) -> str:
    return "; ".join(note for note in notes if note)


def _nearly_all(run: RunData, key: str) -> str:
    """Return what nearly all of many flights stay below, of the tracking error; no word of
    others.
    """
    if key != TRACKING:
        return ""
    errors = column(run.summary, TRACKING)
    known = errors[np.isfinite(errors)]
    if len(known) < _QUANTILE_OF:
        return ""
    return f"{percent(_QUANTILE)} of flights below {float(np.quantile(known, _QUANTILE)):.3g} m"


def _required(trials: Sequence[Trial], criterion: Criterion) -> str:
    """Return the limit of a criterion: that of the flight with the worst figure."""
    key = criterion.key
    limit = criterion.worst.limit if criterion.worst else criterion.limits[0]
    words = limit_words(trials[0].run, key, criterion.column, limit)
    return words + SCALED * any(trial.is_scaled(f"criteria.{key}") for trial in trials)


def _further(trials: Sequence[Trial], flown: pd.DataFrame) -> Iterator[Card]:
    """Yield figures that page 1 has room for if there are few others."""
    guarded = column(flown, "guard_interventions") > 0.0
    yield from _of_flights("Flights in which the guard intervened", guarded)
    unable = column(flown, "guard_lost_s") > 0.0
    yield from _of_flights("Flights in which the guard could not hold its own radius", unable)
    premises = trials[0].run.verdict.premises
    if premises.measured:
        value = f"{premises.exceeded:,} of {premises.measured:,}"
        yield Card("Flights with a premise of the guard exceeded", value)
    yield from _commands(trials, flown)


def _of_flights(name: str, which: Mask) -> Iterator[Card]:
    """Yield in how many flights something happened, where it did in any."""
    if which.any():
        yield Card(name, f"{count(which):,} of {len(which):,}")


def _commands(trials: Sequence[Trial], flown: pd.DataFrame) -> Iterator[Card]:
    """Yield the largest heading rates: commanded, and demanded where their bound is known."""
    limits = column(flown, "heading_rate_limit_rad_s")
    command = largest(column(flown, "heading_rate_command_max_rad_s") / limits)
    if command is not None:
        yield Card(_COMMAND, f"{command:.3f}", "≤ 1", command <= 1.0 + ROUNDING)
    if not any(trial.setting("guidance.tuning") == "bounded" for trial in trials):
        return
    demand = largest(column(flown, "heading_rate_demand_max_rad_s") / limits)
    bound = largest(column(flown, "heading_rate_bound_rad_s") / limits)
    if demand is not None and bound is not None:
        words = f"≤ {bound:.4f} in any state"
        yield Card(_DEMAND, f"{demand:.3f}", words, demand <= bound + ROUNDING)
