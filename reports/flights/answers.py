"""Answers to the questions of flights of a scenario, of a list of trials, and of a sweep."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from common.verdict import COMPLETED, Counts, KeepOut
from reports.document.tables import approach
from reports.flights.criteria import MEASURED, limit_words, worst_in_words, worst_words
from reports.run.columns import completed, count, met, violated
from reports.run.run_data import RunData
from reports.run.trials import read_trials

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
    "{kept:,} of {beside:,} {points} kept out, {finished:,} finished. Crossing intervals are up to"
    " {worst} off the prediction, limit {limit}, missed by {failed:,}"
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
    troubles = [f"{number:,} {words}" for words, number in _troubles(run, counts).items() if number]
    said = ", ".join([first, f"{counts.completed:,} finished", *troubles])
    worst = ", ".join(_worst(run))
    return f"{said}. Worst: {worst}" if worst else said


def _troubles(run: RunData, counts: Counts) -> dict[str, int]:
    """Return how many flights came to grief, by what they did."""
    rows = run.summary
    missed = completed(rows) & ~met(rows) & ~violated(rows)
    return {
        "violated": counts.violated,
        "lost": counts.lost - counts.diverged,
        "diverged": counts.diverged,
        "could not be flown": counts.not_flown,
        "unknown": counts.unknown - counts.not_flown - counts.diverged,
        "missed a limit": count(missed),
    }


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
        finished=counts.completed,
        worst=worst_words(run, criterion, criterion.worst_of_all),
        limit=limit_words(run, criterion.key, criterion.column, criterion.limits[0]).lstrip("≤ "),
        failed=criterion.failed,
    )
