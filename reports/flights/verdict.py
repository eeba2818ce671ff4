"""What the flights of a run show, at a glance: no more than was flown."""

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pandas as pd

from common.intervals import CONFIDENCE, clopper_pearson, percent
from common.premises import UNEXPLAINED
from common.verdict import FAILED, MET, Closest, Counts, Premises, RunVerdict
from reports.document.blocks import Card, Verdict
from reports.document.state import state_words
from reports.document.tables import approach, span
from reports.flights.bounds import counted_as_violations, sampled, violation_bound
from reports.flights.criteria import (
    MEASURED,
    SCALED,
    TRACKING,
    counted,
    criterion_title,
    limit_words,
    switched_off,
    worst_words,
)
from reports.flights.first_page import simulated
from reports.flights.names import told_name
from reports.flights.trials.crossing_gaps import gap_lines
from reports.flights.trials.failures import failure_lines, noteworthy, tracking_lines
from reports.measurement.flights import (
    sulphur_above,
    sulphur_below,
    sulphur_cards,
    sulphur_headline,
    sulphur_verdicts,
)
from reports.monte_carlo.subset import plain_bound_in_words, subset_headline
from reports.run.columns import (
    beside_vessel,
    column,
    count,
    flights_flown,
    largest,
    radii_differ,
    total,
    was_flown,
)
from reports.run.run_data import RunData
from reports.run.trials import SHAPES, Trial, measured_from

ROUNDING = 1e-9
"""What binary fractions may add to a figure that is limited by design [-]."""

_ALLOWED = "not required of every flight"
"""What is said of an outcome where some flights are required to keep out, and no more."""

_COMMAND, _DEMAND = (
    f"Heading rate {what}, largest, as a ratio to ω_max" for what in ("commanded", "demanded")
)
"""Names of figures."""

_QUANTILE, _QUANTILE_OF = 0.99, 100
"""Fraction of flights whose tracking error is no larger than the one that is shown, and flights of
which there is one at least.
"""

_POINTS = {
    "own": "Each point of the sweep has starts, noise and sampled instruments of its own.",
    "common": "All points of the sweep have the same starts, noise and sampled instruments: what differs between them follows"
    " from what is swept, but an error that they have in common may come from the one sample.",
}
"""What is said of the points of a sweep, by whose random numbers they have."""


def flight_verdict(run: RunData, trials: list[Trial]) -> Verdict:
    """Return what the run's verdict says, in words.

    It fails if no flight was flown, if one violated the keep-out area, if one lost its aircraft
    that was required to complete, or if the fuel of an only flight is called above its limit.
    It is complete if the run ended with exit status 0, every planned flight met every criterion,
    and the fuel of an only flight is called below its limit.
    """
    verdict, counts = run.verdict, run.verdict.counts
    flown = flights_flown(run.summary)
    kept = counts.flown > 0 and not counts.violated and not verdict.lost_against_requirement
    headlines = [words for words in (sulphur_headline(run), _answer(run, flown)) if words]
    if sulphur_verdicts(run) and verdict.all_kept_out:
        # A study of the method asks for its verdicts alone.
        headlines = headlines[:1]
    if wrong := counts.unexplained:
        flights = f"{wrong:,} flight{'s' * (wrong > 1)}"
        headlines = [f"The keep-out guard is wrong: in {flights} {UNEXPLAINED}", *headlines[::-1]]
    elif verdict.lost_against_requirement or counts.violated:
        # What must never happen stands before what was measured.
        headlines = headlines[::-1]
    met = verdict.exit_status == MET and counts.met == counts.planned
    return Verdict(
        holds=kept and not sulphur_above(run),
        complete=met and sulphur_below(run),
        headline=". ".join([*_state(verdict), *headlines]),
        detail=_detail(run, trials, flown),
        failures=[
            *_warnings(run),
            *(line for trial in trials for line in failure_lines(trial)),
            *(line for trial in trials for line in tracking_lines(trial, only=len(trials) == 1)),
            *(line for trial in trials for line in gap_lines(trial, only=len(trials) == 1)),
            *noteworthy(verdict, flown),
        ],
        figures=[*sulphur_cards(run), *_bound_figure(run), *_figures(trials, flown)],
    )


def _warnings(run: RunData) -> list[str]:
    """Return what files of the run lack that a reader of its results has to know."""
    files = run.manifest.get("vessel_files", {}).values()
    return [str(file["warning"]) for file in files if file.get("warning")]


def _state(verdict: RunVerdict) -> list[str]:
    """Return that a run was interrupted or is incomplete, which stands before anything else."""
    counts = verdict.counts
    if not counts.left and not verdict.is_done:
        word = "Interrupted" if verdict.interrupted else "Incomplete"
        return [f"{word} before all comparisons were flown"]
    return state_words(
        "flights",
        counts.done,
        counts.planned,
        is_done=verdict.is_done,
        interrupted=verdict.interrupted,
    )


def _answer(run: RunData, flown: pd.DataFrame) -> str:
    """Return the sentence that answers the question of the run's study; of a study that has no such
    question, how its flights kept out.
    """
    answer, closest = _ANSWERS.get(str(run.manifest.get("study"))), run.verdict.whole.closest
    if answer is None or closest is None or _subset(run) is not None:
        return _headline(run, flown)
    return answer(run, closest)


def _nearest_found(run: RunData, nearest: Closest) -> str:
    """Return the nearest flight that a search found, where, and what was violated or lost."""
    counts = run.verdict.counts
    row = run.summary[run.summary["flight_id"] == nearest.flight].iloc[0]
    fault = str(row["fault"]).replace("_", " ")
    return (
        f"Nearest of {_plural(counts.flown, 'flight')}: {_beyond(nearest)} m beyond r_min,"
        f" {nearest.flight} (fault {fault}, wind {row['wind_speed_mps']:.1f} m/s);"
        f" {counts.violated:,} violated, {counts.lost - counts.diverged:,} lost, {counts.diverged:,} diverged,"
        f" {counts.unknown:,} unknown"
    )


def _probabilities(run: RunData, _: Closest) -> str:
    """Return the probabilities of a violation, of a loss and of a flight that does not finish."""
    counts = run.verdict.counts
    violation = _probability(run, counts.violated, counts.unknown)
    loss = _probability(run, counts.lost)
    unfinished = _probability(run, counts.done - counts.completed)
    return (
        f"Probability of violation {violation}, of loss {loss}, of not finishing {unfinished},"
        f" at {percent(_confidence(run))} confidence"
    )


def _probability(run: RunData, events: int, unknown: int = 0) -> str:
    """Return the share of flights with an event and the interval of its probability, which has each
    unknown flight as one at its upper end.

    Flights that share what is random count as one.
    """
    done, level = run.verdict.counts.done, _confidence(run)
    bound = run.verdict.whole.bound
    samples = bound.samples if bound else done
    low = clopper_pearson(math.floor(events * samples / done), samples, level).low
    high = clopper_pearson(math.ceil((events + unknown) * samples / done), samples, level).high
    return f"{percent(events / done)} ({100.0 * low:.3g} to {percent(high)})"


def _confidence(run: RunData) -> float:
    """Return the confidence of each interval, that of a study that was looked at repeatedly too."""
    return float((run.statistics or {}).get("interval_confidence", CONFIDENCE))


def _beyond(closest: Closest) -> str:
    """Return how far beyond r_min the closest flight stayed, negative inside [m]."""
    return approach(closest.distance_m - closest.radius_m, 0.0)


_ANSWERS: Mapping[str, Callable[[RunData, Closest], str]] = {
    "falsify": _nearest_found,
    "monte_carlo": _probabilities,
}
"""What answers the question of a study, by its name in the manifest."""


def _headline(run: RunData, flown: pd.DataFrame) -> str:
    """Return in a sentence how the flights kept out, and in what others fell short.

    "No keep-out violation" is said only where each planned flight is known to have kept out, and
    came back; else it begins with those that did not.
    """
    counts = run.verdict.counts
    if not counts.flown:
        ends = run.summary["outcome"].astype(str).str.replace("_", " ")
        return (
            f"Nothing was flown{f': of {counts.planned:,}, {counted(ends)}' if len(ends) else ''}"
        )
    kept = _keeping_out(run, flown)
    if _subset(run) is None and counts.violated:
        return kept
    troubles, short = _shortfalls(run)
    if counts.planned == 1:
        it = next(iter((*troubles, *short)), "met its criteria")
        return f"The flight {it}; {kept}" if troubles else f"{kept}; it {it}"
    numbers = [[f"{number:,} {what}" for what, number in of.items()] for of in (troubles, short)]
    if troubles:
        flights = _plural(counts.planned, "flight")
        return f"{', '.join(numbers[0])}, of {flights}; {'; '.join([kept, *numbers[1]])}"
    if short:
        return f"{kept}; of {counts.planned:,}, {', '.join(numbers[1])}"
    return f"{kept}; every flight met its criteria" if run.verdict.is_done else kept


def _shortfalls(run: RunData) -> tuple[dict[str, int], dict[str, int]]:
    """Return how many flights came to nothing or did not come back, and how many of the others did
    not complete or failed another criterion, by what they did; only what some did.
    """
    counts = run.verdict.counts
    gone = {
        "diverged": counts.diverged,
        "lost the aircraft": counts.lost - counts.diverged,
        "failed": counts.failed - _unflown(run.summary, FAILED),
    }
    came_back = counts.flown - sum(gone.values())
    others = {
        "did not complete the mission": came_back - counts.completed,
        "failed another criterion": counts.completed - counts.met,
    }
    troubles = gone | {"could not be flown": counts.not_flown}
    worse, short = (
        {what: number for what, number in of.items() if number} for of in (troubles, others)
    )
    return worse, short


def _unflown(rows: pd.DataFrame, outcome: str) -> int:
    """Return how many flights of an outcome were never flown."""
    return count((rows["outcome"] == outcome).to_numpy(dtype=np.bool_) & ~was_flown(rows))


def _keeping_out(run: RunData, flown: pd.DataFrame) -> str:
    """Return how the flights kept out of the keep-out area, and what bound follows; a flight about
    a circle has none.
    """
    counts, time = run.verdict.counts, simulated(flown)
    if not counts.beside:
        return f"{_plural(counts.flown, 'flight')} ({time}) without a vessel to keep out of"
    led, bound, inside = _subset(run), violation_bound(run), counts.violated
    flights = _plural(counts.beside, "flight")
    if led is not None and bound:
        return f"{subset_headline(led)}; {inside:,} of its {flights} ({time}) violated the keep-out area"
    if inside:
        return (
            f"Keep-out violations in {inside:,} of {flights}, {counts.keepout_violations:,} in all"
        )
    if counts.beside == 1 and not counts.kept_out:
        known = (
            "it ended outside of the keep-out area"
            if counts.outside
            else "nobody knows whether it kept out"
        )
        return f"{known} ({time})"
    if not run.verdict.all_kept_out:
        outside = f", {counts.outside:,} ended outside of the area" if counts.outside else ""
        unknown = f", unknown of {counts.unknown:,}" if counts.unknown else ""
        return f"{counts.kept_out:,} of {flights} kept out ({time}){outside}{unknown}"
    shown = (
        f": at most {percent(bound[0])} of such flights violate the area, at {percent(bound[1])} confidence"
        if bound
        else ""
    )
    alone = f", and {counts.no_area:,} without a vessel" if counts.no_area else ""
    return f"No keep-out violation in {flights} ({time}){shown}{alone}"


def _plural(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'s' * (number != 1)}"


def _subset(run: RunData) -> "dict[str, Any] | None":
    """Return the statistics of a study by subset simulation; None of any other run."""
    return (
        run.statistics
        if run.statistics is not None and run.statistics.get("method") == "subset"
        else None
    )


def _detail(run: RunData, trials: list[Trial], flown: pd.DataFrame) -> str:
    counts, beside = run.verdict.counts, beside_vessel(flown)
    several = f"Flights of {len(trials)} trials: " if len(trials) > 1 else ""
    sentences = [
        f"{several or 'Flights: '}{counts.planned:,} planned, {counts.flown:,} flown,"
        f" {counts.completed:,} completed, {counts.met:,} met every criterion.",
        *([_closest(found, trials, beside)] if (found := run.verdict.whole.closest) else []),
    ]
    sentences += [
        words
        for kind, words in _POINTS.items()
        if kind in run.manifest.get("random_numbers_of_points", {}).values()
    ]
    led, bound = _subset(run), violation_bound(run)
    if bound and led is not None:
        sentences.append(
            f"The simulation's bound, {percent(bound[1])} confidence, is on flights whose inputs are distributed as the scenario"
            f" declares, in this simulation. {plain_bound_in_words(led)} Flights of further levels are led towards violations:"
            " their share in all flights is no probability."
        )
    elif bound:
        sentences.append(
            f"With {percent(bound[1])} confidence a flight sampled as these were violates the keep-out area with a probability of"
            f" at most {percent(bound[0])}, on average and in this simulation.{counted_as_violations(run.verdict.whole.bound)}"
        )
    elif len(beside) and (run.statistics is not None or sampled(trials)):
        few = "A single flight sets" if len(beside) == 1 else "So few flights set"
        sentences.append(
            f"{few} no bound on the probability of a keep-out violation that is worth stating."
        )
    elif len(beside):
        sentences.append(
            "No bound on a probability follows from these flights: they are no random sample."
        )
    if alone := counts.required.get("keep_out", 0):
        are = "flight is" if alone == 1 else "flights are"
        sentences.append(
            f"{alone:,} {are} required only to stay outside of the keep-out area, and not to complete;"
            f" {counts.passed:,} of {counts.planned:,} flights did what is required of them."
        )
    if not run.verdict.is_done:
        sentences.append("The run did not end; continue it with --resume.")
    return " ".join(sentences)


def _closest(found: Closest, trials: list[Trial], beside: pd.DataFrame) -> str:
    """Return how close the closest flight came, and to what: the shape of the keep-out area decides
    what a distance is.
    """
    closest = beside[beside["flight_id"] == found.flight].iloc[0]
    (trial,) = [trial for trial in trials if trial.key == closest["trial"]]
    name, shape = told_name(trial, closest), found.shape
    where = f" ({name})" if trial.swept else f", in {name}"
    distance, radius = found.distance_m, found.radius_m
    nearest = f"{approach(distance, radius)} m {measured_from(shape)}"
    words = f"Closest approach of any flight, from its first second: {nearest}{where}"
    if radii_differ(beside):
        words = (
            f"Each flight is judged by its own r_min, {span(column(beside, 'keepout_radius_m'), '{:g}')} m. Least distance beyond"
            f" it, from the first second: {approach(distance - radius, 0.0)} m{where}: {nearest}, where r_min is {radius:g} m"
        )
    horizontal = closest.get("horizontal_distance_min_m", math.nan)
    if shape == "sphere" and horizontal < distance - 1.0:
        words += f"; {float(horizontal):.1f} m horizontally from the funnel"
    return f"{words}."


def _bound_figure(run: RunData) -> list[Card]:
    bound = violation_bound(run)
    if bound is None:
        return []
    name = f"Probability of a keep-out violation in a flight, at most, with {percent(bound[1])} confidence"
    return [Card(name, percent(bound[0]))]


def _violation_cards(counts: Counts) -> list[Card]:
    """Return how many keep-out violations there were, and of how many flights that is unknown."""
    if not counts.beside:
        return []
    value = f"{counts.keepout_violations:,}"
    if counts.unknown:
        value += f" known, unknown in {_plural(counts.unknown, 'flight')}"
    held = not counts.violated and not counts.unknown
    cards = [Card("Keep-out violations", value, "0", held)]
    if counts.unexplained:
        name = "Violations with every premise of the guard held"
        cards.append(Card(name, f"{counts.unexplained:,}", "0", met=False))
    return cards


def _figures(trials: list[Trial], flown: pd.DataFrame) -> list[Card]:
    run = trials[0].run
    verdict, counts, closest = run.verdict, run.verdict.counts, run.verdict.whole.closest
    if not counts.flown:
        return [
            Card("Keep-out violations", "none flown", "not judged"),
            Card("Flights flown", f"0 of {counts.planned:,}", "all", met=False),
        ]
    limits = column(flown, "heading_rate_limit_rad_s")
    command = largest(column(flown, "heading_rate_command_max_rad_s") / limits)
    guarded, unable = (
        count(column(flown, "guard_interventions") > 0.0),
        count(column(flown, "guard_lost_s") > 0.0),
    )
    crossings = total(flown, "crossing_count")
    # Of some flights it may be required to stay outside, and no more.
    allowed = (_ALLOWED,) if counts.required.get("keep_out") and counts.passed > counts.met else ()
    worst = [_worst(trials, key) for key in MEASURED]
    tracking = verdict.whole.criterion(TRACKING)
    figures = [
        *_violation_cards(counts),
        *([_closest_figure(closest, trials, beside_vessel(flown))] if closest else []),
        Card(
            "Missions completed",
            f"{counts.completed:,} of {counts.planned:,}",
            *(allowed or ("all", counts.completed == counts.planned)),
        ),
        *(figure for figure in worst if figure),
        Card(
            f"Flights flown, {simulated(flown)}",
            f"{counts.flown:,} of {counts.planned:,}",
            "all",
            counts.flown == counts.planned,
        ),
        *_kept_cards(counts, allowed),
        Card("Aircraft lost", f"{counts.lost:,}", *(allowed or ("0", counts.lost == 0))),
        *_premise_cards(verdict.premises),
        *([Card("Plume crossings after settling", f"{crossings:,}")] if crossings else []),
        *(Card(name, worst) for name, worst in switched_off(trials)),
        *_tracking(flown, run.column(TRACKING).title, told=tracking.judged > 0),
        Card(_COMMAND, "none")
        if command is None
        else Card(_COMMAND, f"{command:.3f}", "≤ 1", command <= 1.0 + ROUNDING),
    ]
    if any(trial.setting("guidance.tuning") == "bounded" for trial in trials):
        demand = largest(column(flown, "heading_rate_demand_max_rad_s") / limits)
        bound = largest(column(flown, "heading_rate_bound_rad_s") / limits)
        if demand is not None and bound is not None:
            words = f"≤ {bound:.4f} in any state"
            figures.append(Card(_DEMAND, f"{demand:.3f}", words, demand <= bound + ROUNDING))
    if guarded:
        figures.append(
            Card("Flights in which the guard intervened", f"{guarded:,} of {len(flown):,}")
        )
    if unable:
        figures.append(
            Card(
                "Flights in which the guard could not hold its own radius for a while",
                f"{unable:,}",
            )
        )
    return figures


def _kept_cards(counts: Counts, allowed: tuple[str, ...]) -> list[Card]:
    """Return how many flights kept out, of those that have an area to keep out of."""
    if not counts.beside:
        return []
    value = f"{counts.kept_out:,} of {counts.beside:,}"
    if counts.outside:
        value += f", {counts.outside:,} ended outside"
    elsewise = counts.violated or counts.unknown
    required = allowed if counts.outside and not elsewise else ()
    return [
        Card(
            "Flights that kept out", value, *(required or ("all", counts.kept_out == counts.beside))
        )
    ]


def _premise_cards(premises: Premises) -> list[Card]:
    """Return in how many flights a premise of the keep-out guard did not hold."""
    if not premises.measured:
        return []
    value = f"{premises.exceeded:,} of {premises.measured:,}"
    return [Card("Flights with a premise of the guard exceeded", value)]


def _closest_figure(closest: Closest, trials: list[Trial], beside: pd.DataFrame) -> Card:
    shapes = {trial.shape for trial in trials}
    name = (
        f"Closest approach, {trials[0].measured_from}"
        if len(shapes) == 1 and shapes <= set(SHAPES)
        else "Closest approach"
    )
    distance, radius = closest.distance_m, closest.radius_m
    if radii_differ(beside):
        return Card(
            "Closest approach, beyond the flight's own r_min",
            f"{approach(distance - radius, 0.0)} m",
            "≥ 0 m",
            distance >= radius,
        )
    return Card(name, f"{approach(distance, radius)} m", f"≥ {radius:g} m", distance >= radius)


def _tracking(flown: pd.DataFrame, error: str, *, told: bool) -> list[Card]:
    """Return the tracking error of nearly all flights that settled, whether or not a criterion asks
    for it.

    Of few flights there is no such quantile, and the largest alone is shown, unless that has been
    told.
    """
    errors = column(flown, TRACKING)
    known = errors[np.isfinite(errors)]
    if not len(known):
        return []
    if len(known) < _QUANTILE_OF:
        name = f"{error}, largest of the flights" if len(known) > 1 else error
        return [] if told else [Card(name, f"{known.max():.3g} m")]
    high = float(np.quantile(known, _QUANTILE))
    name = f"{error}: {percent(_QUANTILE)} quantile of the flights, and their largest"
    return [Card(name, f"{high:.3g} m, largest {known.max():.3g} m")]


def _worst(trials: list[Trial], key: str) -> Card | None:
    """Return the worst figure of a criterion: among the flights that it judges the one that is the
    largest for its limit, and the worst of all flights, where that is another.
    """
    run = trials[0].run
    criterion = run.verdict.whole.criterion(key)
    if not criterion.judged:
        return None
    name = f"{criterion_title(run, criterion)}, worst"
    worst, worst_of_all = criterion.worst, criterion.worst_of_all
    value = worst_words(run, criterion, worst)
    if worst_of_all and worst_of_all != worst:
        name += f" of the {criterion.judged:,} flights that it is required of, and of all"
        value += f", {worst_words(run, criterion, worst_of_all)} ({worst_of_all.flight})"
    limit = worst.limit if worst else criterion.limits[0]
    words = limit_words(run, key, criterion.column, limit)
    if any(trial.is_scaled(f"criteria.{key}") for trial in trials):
        words += SCALED
    return Card(name, value, words, criterion.met)
