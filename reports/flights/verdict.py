"""What the flights of a run show, at a glance: no more than was flown."""

import math
from typing import Any

import numpy as np
import pandas as pd

from common.intervals import percent
from common.premises import UNEXPLAINED
from reports.document.blocks import Card, Verdict
from reports.document.tables import approach, span
from reports.flights.bounds import counted_as_violations, sampled, violation_bound
from reports.flights.criteria import MEASURED, Criterion, counted, criteria_of, switched_off
from reports.flights.first_page import simulated
from reports.flights.names import told_name
from reports.flights.trials.crossing_gaps import gap_lines
from reports.flights.trials.failures import failure_lines, noteworthy, tracking_lines
from reports.measurement.flights import (
    sulphur_above,
    sulphur_below,
    sulphur_cards,
    sulphur_headline,
)
from reports.monte_carlo.subset import plain_bound_in_words, subset_headline
from reports.run.columns import (
    beside_vessel,
    clearance,
    column,
    completed,
    count,
    flights_flown,
    kept_out,
    largest,
    lost,
    met,
    passed,
    premises_exceeded,
    radii_differ,
    total,
    unexplained,
    violated,
)
from reports.run.flight_config import keepout_shape
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

_TRACKING = "tracking_error_rms_m"

_QUANTILE, _QUANTILE_OF = 0.99, 100
"""Fraction of flights whose tracking error is no larger than the one that is shown, and flights of
which there is one at least.
"""

_LIMITED = " of the trials that limit it"
"""How the worst figure is named that is not that of all flights."""

_POINTS = {
    "own": "Each point of the sweep has starts, noise and sampled instruments of its own.",
    "common": "All points of the sweep have the same starts, noise and sampled instruments: what differs between them follows"
    " from what is swept, but an error that they have in common may come from the one sample.",
}
"""What is said of the points of a sweep, by whose random numbers they have."""


def flight_verdict(run: RunData, trials: list[Trial]) -> Verdict:
    """Judge a run by its summary.

    It fails if no flight was flown, if one violated the keep-out area, if one lost its aircraft
    that was required to complete, or if the fuel of an only flight is called above its limit.
    It is complete if every planned flight met every criterion, and the fuel of an only flight is
    called below its limit.
    """
    rows, flown = run.summary, flights_flown(run.summary)
    planned = int(run.manifest["flights_planned"])
    kept = (
        len(flown) > 0
        and total(flown, "keepout_violations") == 0
        and not np.any(lost(rows) & ~passed(rows))
    )
    headlines = [
        words for words in (sulphur_headline(run), _headline(run, trials, flown, planned)) if words
    ]
    if wrong := count(unexplained(flown)):
        flights = f"{wrong:,} flight{'s' * (wrong > 1)}"
        headlines = [f"The keep-out guard is wrong: in {flights} {UNEXPLAINED}", *headlines[::-1]]
    return Verdict(
        holds=kept and not sulphur_above(run),
        complete=count(met(rows)) == planned and sulphur_below(run),
        # What must never happen stands before what was measured.
        headline=". ".join(headlines if kept or wrong else headlines[::-1]),
        detail=_detail(run, trials, flown, planned),
        failures=[
            *(line for trial in trials for line in failure_lines(trial)),
            *(line for trial in trials for line in tracking_lines(trial, only=len(trials) == 1)),
            *(line for trial in trials for line in gap_lines(trial, only=len(trials) == 1)),
            *noteworthy(flown),
        ],
        figures=[
            *sulphur_cards(run),
            *_bound_figure(run, trials),
            *_figures(trials, flown, planned),
        ],
    )


def _headline(run: RunData, trials: list[Trial], flown: pd.DataFrame, planned: int) -> str:
    if not len(flown):
        ends = run.summary["outcome"][~completed(run.summary)].astype(str).str.replace("_", " ")
        return f"Nothing was flown{f': of {planned:,}, {counted(ends)}' if len(ends) else ''}"
    rows, kept = run.summary, _keeping_out(run, trials, flown)
    if _subset(run) is None and np.any(violated(flown)):
        return kept
    counts = {
        "lost the aircraft": count(lost(rows)),
        "did not complete the mission": count(~completed(flown) & ~lost(flown)),
        "could not be flown": count(~lost(rows)) - count(~lost(flown)),
        "failed another criterion": count(completed(rows) & ~met(rows) & ~violated(rows)),
        "not flown yet": planned - len(rows),
    }
    others = [f"{number_of:,} {what}" for what, number_of in counts.items() if number_of]
    if np.any(lost(rows) & ~passed(rows)):
        of = f"{planned:,} flight{'s' * (planned != 1)}"
        return f"{others[0].capitalize()}, of {of}{''.join(f', {other}' for other in others[1:])}. {kept}"
    if planned == 1:
        return f"{kept}; it {next((what for what, number_of in counts.items() if number_of), 'met its criteria')}"
    if others:
        return f"{kept}; of {planned:,}, {', '.join(others)}"
    return f"{kept}; every flight met its criteria" if met(rows).all() else kept


def _keeping_out(run: RunData, trials: list[Trial], flown: pd.DataFrame) -> str:
    """Return how the flights kept out of the keep-out area, and what bound follows; a flight about
    a circle has none.
    """
    beside = beside_vessel(flown)
    flights, alone = _flights(beside), len(flown) - len(beside)
    if not len(beside):
        return f"{_flights(flown)} ({simulated(flown)}) without a vessel to keep out of"
    led, bound, inside = _subset(run), violation_bound(run, trials), count(violated(flown))
    if led is not None and bound:
        return f"{subset_headline(led)}; {inside:,} of its {flights} ({simulated(beside)}) violated the keep-out area"
    if violations := total(flown, "keepout_violations"):
        return f"Keep-out violations in {inside:,} of {flights}, {violations:,} in all"
    shown = (
        f": at most {percent(bound[0])} of such flights violate the area, at {percent(bound[1])} confidence"
        if bound
        else ""
    )
    return f"No keep-out violation in {flights} ({simulated(beside)}){shown}{f', and {alone:,} without a vessel' if alone else ''}"


def _flights(rows: pd.DataFrame) -> str:
    return f"{len(rows):,} flight{'s' * (len(rows) != 1)}"


def _subset(run: RunData) -> "dict[str, Any] | None":
    """Return the statistics of a study by subset simulation; None of any other run."""
    return (
        run.statistics
        if run.statistics is not None and run.statistics.get("method") == "subset"
        else None
    )


def _detail(run: RunData, trials: list[Trial], flown: pd.DataFrame, planned: int) -> str:
    rows, beside = run.summary, beside_vessel(flown)
    several = f"Flights of {len(trials)} trials: " if len(trials) > 1 else ""
    sentences = [
        f"{several or 'Flights: '}{planned:,} planned, {len(flown):,} flown,"
        f" {count(completed(rows)):,} completed, {count(met(rows)):,} met every criterion.",
        *([_closest(trials, beside)] if len(beside) else []),
    ]
    sentences += [
        words
        for kind, words in _POINTS.items()
        if kind in run.manifest.get("random_numbers_of_points", {}).values()
    ]
    led, bound = _subset(run), violation_bound(run, trials)
    if bound and led is not None:
        sentences.append(
            f"The simulation's bound, {percent(bound[1])} confidence, is on flights whose inputs are distributed as the scenario"
            f" declares, in this simulation. {plain_bound_in_words(led)} Flights of further levels are led towards violations:"
            " their share in all flights is no probability."
        )
    elif bound:
        sentences.append(
            f"With {percent(bound[1])} confidence a flight sampled as these were violates the keep-out area with a probability of"
            f" at most {percent(bound[0])}, on average and in this simulation.{counted_as_violations(rows)}"
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
    if "required" in rows and (rows["required"] == "keep_out").any():
        alone = rows[rows["required"] == "keep_out"]
        are = "flight is" if len(alone) == 1 else "flights are"
        sentences.append(
            f"{len(alone):,} {are} required to keep out, not to complete: {count(kept_out(alone)):,} kept out,"
            f" {count(completed(alone)):,} completed. For the exit status, it is enough that these kept out."
        )
    if run.manifest.get("state") != "complete":
        sentences.append(
            f"The run is {run.manifest.get('state', 'unfinished')}; continue it with --resume."
        )
    return " ".join(sentences)


def _closest(trials: list[Trial], beside: pd.DataFrame) -> str:
    """Return how close the closest flight came, and to what: the shape of the keep-out area decides
    what a distance is.
    """
    closest = _nearest(beside)
    (trial,) = [trial for trial in trials if trial.key == closest["trial"]]
    name, shape = told_name(trial, closest), keepout_shape(trial.flight_config(closest))
    where = f" ({name})" if trial.swept else f", in {name}"
    distance, radius = float(closest["min_distance_m"]), float(closest["keepout_radius_m"])
    nearest = f"{approach(distance, radius)} m {measured_from(shape)}"
    words = f"Closest approach of any flight, from its first second: {nearest}{where}"
    if radii_differ(beside):
        words = (
            f"Each flight is judged by its own r_min, {span(column(beside, 'keepout_radius_m'), '{:g}')} m. Least distance beyond"
            f" it, from the first second: {approach(distance - radius, 0.0)} m{where}: {nearest}, where r_min is {radius:g} m"
        )
    horizontal = closest.get("horizontal_distance_min_m", math.nan)
    if shape == "sphere" and horizontal < float(closest["min_distance_m"]) - 1.0:
        words += f"; {float(horizontal):.1f} m horizontally from the funnel"
    return f"{words}."


def _nearest(beside: pd.DataFrame) -> "pd.Series[Any]":
    """Return the row of the flight that stayed the least off its keep-out area."""
    return beside.iloc[int(np.argmin(clearance(beside)))]


def _bound_figure(run: RunData, trials: list[Trial]) -> list[Card]:
    bound = violation_bound(run, trials)
    if bound is None:
        return []
    name = f"Probability of a keep-out violation in a flight, at most, with {percent(bound[1])} confidence"
    return [Card(name, percent(bound[0]))]


def _unexplained_cards(flown: pd.DataFrame) -> list[Card]:
    """Return how many flights violated the area although every premise of its guard held, if any."""
    wrong = count(unexplained(flown))
    name = "Violations with every premise of the guard held"
    return [Card(name, f"{wrong:,}", "0", met=False)] if wrong else []


def _premise_cards(flown: pd.DataFrame) -> list[Card]:
    """Return in how many flights a premise of the keep-out guard did not hold."""
    flights = premises_exceeded(flown)
    if not flights:
        return []
    some = sum(bool(terms) for terms in flights)
    return [Card("Flights with a premise of the guard exceeded", f"{some:,} of {len(flights):,}")]


def _figures(trials: list[Trial], flown: pd.DataFrame, planned: int) -> list[Card]:
    if not len(flown):
        return [
            Card("Keep-out violations", "none flown", "not judged"),
            Card("Flights flown", f"0 of {planned:,}", "all", met=False),
        ]
    beside = beside_vessel(flown)
    limits = column(flown, "heading_rate_limit_rad_s")
    command = largest(column(flown, "heading_rate_command_max_rad_s") / limits)
    guarded, unable = (
        count(column(flown, "guard_interventions") > 0.0),
        count(column(flown, "guard_lost_s") > 0.0),
    )
    crossings, violations = total(flown, "crossing_count"), total(flown, "keepout_violations")
    done, kept, gone = count(completed(flown)), count(kept_out(flown)), count(lost(flown))
    # Of some flights it may be required to keep out, and no more.
    allowed = (_ALLOWED,) if np.any(passed(flown) & ~met(flown)) else ()
    worst = [
        _worst([criterion for trial in trials for criterion in criteria_of(trial)], key)
        for key in MEASURED
    ]
    error = trials[0].run.column(_TRACKING).title
    told = any(of and _tells_of_all(of.name, error, len(flown)) for of in worst)
    figures = [
        *(
            [Card("Keep-out violations", f"{violations:,}", "0", violations == 0)]
            if len(beside)
            else []
        ),
        *_unexplained_cards(flown),
        *([_closest_figure(trials, beside)] if len(beside) else []),
        Card(
            "Missions completed", f"{done:,} of {planned:,}", *(allowed or ("all", done == planned))
        ),
        *(figure for figure in worst if figure),
        Card(
            f"Flights flown, {simulated(flown)}",
            f"{len(flown):,} of {planned:,}",
            "all",
            len(flown) == planned,
        ),
        *(
            [
                Card(
                    "Flights that kept out",
                    f"{kept:,} of {len(beside):,}",
                    "all",
                    kept == len(beside),
                )
            ]
            if len(beside)
            else []
        ),
        Card("Aircraft lost", f"{gone:,}", *(allowed or ("0", gone == 0))),
        *_premise_cards(flown),
        *([Card("Plume crossings after settling", f"{crossings:,}")] if crossings else []),
        *(Card(name, worst) for name, worst in switched_off(trials)),
        *_tracking(flown, error, told=told),
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


def _closest_figure(trials: list[Trial], beside: pd.DataFrame) -> Card:
    nearest, shapes = _nearest(beside), {trial.shape for trial in trials}
    name = (
        f"Closest approach, {trials[0].measured_from}"
        if len(shapes) == 1 and shapes <= set(SHAPES)
        else "Closest approach"
    )
    distance, radius = float(nearest["min_distance_m"]), float(nearest["keepout_radius_m"])
    if radii_differ(beside):
        return Card(
            "Closest approach, beyond the flight's own r_min",
            f"{approach(distance - radius, 0.0)} m",
            "≥ 0 m",
            distance >= radius,
        )
    return Card(name, f"{approach(distance, radius)} m", f"≥ {radius:g} m", distance >= radius)


def _tells_of_all(name: str, error: str, flights: int) -> bool:
    """Return whether the figure of a criterion is the tracking error of all flights."""
    return name.startswith(error) and (flights == 1 or _LIMITED not in name)


def _tracking(flown: pd.DataFrame, error: str, *, told: bool) -> list[Card]:
    """Return the tracking error of nearly all flights that settled, whether or not a criterion asks
    for it.

    Of few flights there is no such quantile, and the largest alone is shown, unless that has been
    told.
    """
    errors = column(flown, _TRACKING)
    known = errors[np.isfinite(errors)]
    if not len(known):
        return []
    if len(known) < _QUANTILE_OF:
        name = f"{error}, largest of the flights" if len(known) > 1 else error
        return [] if told else [Card(name, f"{known.max():.3g} m")]
    high = float(np.quantile(known, _QUANTILE))
    name = f"{error}: {percent(_QUANTILE)} quantile of the flights, and their largest"
    return [Card(name, f"{high:.3g} m, largest {known.max():.3g} m")]


def _worst(criteria: list[Criterion], key: str) -> Card | None:
    """Return the worst figure of a criterion among all trials: the largest fraction of its trial's
    limit.
    """
    known = [
        criterion
        for criterion in criteria
        if criterion.key == key and not math.isnan(criterion.fraction)
    ]
    if not known:
        return None
    worst = max(known, key=lambda criterion: criterion.fraction)
    failed = sum(criterion.flown_failed for criterion in criteria if criterion.key == key)
    missing = [
        criterion.missing for criterion in criteria if criterion.key == key and criterion.missing
    ]
    # Flights that were flown and have no figure fail the criterion; of those that were not another
    # tile tells.
    without = f" ({'; '.join(missing)})" if missing and worst.fraction <= 1.0 else ""
    # The tracking error of every trial is a figure of its own, which may be larger where nothing
    # limits it.
    everywhere = sum(criterion.key == key for criterion in criteria) == sum(
        criterion.key == "mission" for criterion in criteria
    )
    of = "" if everywhere else _LIMITED
    return Card(f"{worst.what}, worst{of}{without}", worst.worst, worst.limit, not failed)
