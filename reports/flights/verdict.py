"""What the flights of a run show, at a glance."""

import math

import numpy as np
import pandas as pd

from reports.document.blocks import Verdict
from reports.document.tables import limit, number, vehicles_flown
from reports.flights.criteria import MEASURED, Criterion, criteria_of
from reports.monte_carlo.tables import percent
from reports.run.columns import clearance, column, largest, lost, measured, met, total, violated
from reports.run.run_data import RunData
from reports.run.trials import Trial

_NAMED_MAX = 3
"""Failed flights of a trial that the verdict names one by one."""


def flight_verdict(run: RunData, trials: list[Trial]) -> Verdict:
    """Judge a run by its summary: flights were flown, none violated the keep-out area, and all met their criteria."""
    rows, flown = run.summary, measured(run.summary)
    violations = total(flown, "keepout_violations")
    planned = int(run.manifest["flights_planned"])
    return Verdict(
        holds=len(flown) > 0 and violations == 0,
        complete=int(np.count_nonzero(met(rows))) == planned,
        headline=_headline(rows, flown, planned),
        detail=_detail(run, trials, flown, planned),
        failures=[line for trial in trials for line in _failures(trial)],
        figures=[*_bound(run), *_figures(trials, flown)],
    )


def _headline(rows: pd.DataFrame, flown: pd.DataFrame, planned: int) -> str:
    if not len(flown):
        return "Nothing was flown"
    flights = f"{len(flown):,} flight{'s' if len(flown) > 1 else ''}"
    if violations := total(flown, "keepout_violations"):
        inside = int(np.count_nonzero(violated(flown)))
        return f"Keep-out violations in {inside:,} of {flights}, {violations:,} in all"
    gone = lost(rows) & rows["criteria_met"].to_numpy(dtype=np.bool_)
    counts = {
        "failed a criterion": int(np.count_nonzero(~rows["criteria_met"])),
        "lost the aircraft, as their criteria allow": int(np.count_nonzero(gone)),
        "not flown yet": planned - len(rows),
    }
    others = [f"{count:,} {what}" for what, count in counts.items() if count]
    kept = f"No keep-out violation in {flights} ({hours(flown)})"
    return f"{kept}; of {planned:,}, {', '.join(others)}" if others else f"{kept}; every flight met its criteria"


def hours(flown: pd.DataFrame) -> str:
    """Return how long all flights took together."""
    time = total(flown, "duration_s") / 3600.0
    return f"{time:,.0f} h" if time >= 100.0 else f"{time:.2g} h"


def _detail(run: RunData, trials: list[Trial], flown: pd.DataFrame, planned: int) -> str:
    count = f"{len(trials)} trials, " if len(trials) > 1 else ""
    fulfilled = int(np.count_nonzero(met(run.summary)))
    detail = f"{count}{len(run.summary):,} of {planned:,} flights are in this report; {fulfilled:,} met every criterion."
    if len(flown):
        closest = flown.iloc[int(np.argmin(clearance(flown)))]
        detail += (
            f" Closest approach of any flight, from its first second: {float(closest['min_distance_m']):.1f} m, in"
            f" {closest['flight_id']}."
        )
    if run.statistics is not None:
        detail += (
            f" With {percent(run.statistics['confidence'])} confidence a flight violates the keep-out area with a probability of at"
            f" most {percent(run.statistics['violation']['pessimistic']['upper'])}."
        )
        if run.statistics.get("method") == "subset":
            detail += " Subset simulation leads its flights towards violations: their share in these flights is no probability."
    elif len(flown):
        detail += " No bound on a probability follows from these flights; a Monte Carlo study gives one."
    detail += f" {vehicles_flown(run)}"
    if run.manifest.get("state") != "complete":
        detail += f" The run is {run.manifest.get('state', 'unfinished')}; continue it with --resume."
    return detail


def _failures(trial: Trial) -> list[str]:
    """Return what failed in a trial: each flight of a few, else each criterion; then flights not flown yet."""
    rows = trial.rows
    failed, missing = rows[~rows["criteria_met"]], trial.planned - len(rows)
    lines = [f"{trial.title}: {missing} of {trial.planned} not flown yet"] if missing else []
    if len(failed) <= _NAMED_MAX:
        named = [f"{row['flight_id']}: {row['outcome'].replace('_', ' ')}; {row['message']}" for _, row in failed.iterrows()]
        return [*named, *lines]
    inside, depth = int(np.count_nonzero(violated(rows))), largest(column(rows, "keepout_depth_m"))
    parts = [f"{inside} violated the keep-out area, by up to {number(depth, '{:.1f} m')}"] if inside else []
    parts += [f"{c.failed} did not meet “{c.what}, {c.limit}”" for c in criteria_of(trial) if c.failed]
    why = f" ({'; '.join(parts)})" if parts else ""
    return [f"{trial.title}: {len(failed)} of {trial.planned} failed{why}", *lines]


def _bound(run: RunData) -> list[tuple[str, str, str]]:
    """Return the bound on the probability of a keep-out violation, of a study that estimated it."""
    if run.statistics is None:
        return []
    name = f"Probability of a keep-out violation in a flight, at most, with {percent(run.statistics['confidence'])} confidence"
    return [(name, f"{run.statistics['violation']['pessimistic']['upper']:.4g}", "")]


def _figures(trials: list[Trial], flown: pd.DataFrame) -> list[tuple[str, str, str]]:
    nearest = flown.iloc[int(np.argmin(clearance(flown)))] if len(flown) else None
    limits = column(flown, "heading_rate_limit_rad_s")
    command = largest(column(flown, "heading_rate_command_max_rad_s") / limits)
    guarded = int(np.count_nonzero(column(flown, "guard_interventions") > 0.0))
    unable = int(np.count_nonzero(column(flown, "guard_lost_s") > 0.0))
    crossings = total(flown, "crossing_count")
    worst = [_worst([criterion for trial in trials for criterion in criteria_of(trial)], key) for key in MEASURED]
    figures = [
        ("Flights flown", f"{len(flown):,}, {hours(flown)}", ""),
        ("Keep-out violations", f"{total(flown, 'keepout_violations'):,}", "0"),
        (
            "Closest approach",
            "none" if nearest is None else f"{float(nearest['min_distance_m']):.1f} m",
            "" if nearest is None else f"≥ {limit(float(nearest['keepout_radius_m']))} m",
        ),
        *([("Plume crossings after settling", f"{crossings:,}", "")] if crossings else []),
        *(figure for figure in worst if figure),
        ("Heading-rate command over ω_max, worst", "none" if command is None else f"{command:.3f}", "≤ 1"),
    ]
    if any(trial.setting("guidance.tuning") == "bounded" for trial in trials):
        demand = largest(column(flown, "heading_rate_demand_max_rad_s") / limits)
        bound = largest(column(flown, "heading_rate_bound_rad_s") / limits)
        if demand is not None and bound is not None:
            figures.append(("Heading-rate demand over ω_max, worst", f"{demand:.3f}", f"≤ {bound:.4f} in any state"))
    if guarded:
        figures.append(("Flights in which the guard intervened", f"{guarded:,} of {len(flown):,}", ""))
    if unable:
        figures.append(("Flights in which the guard could not hold its own radius for a while", f"{unable:,}", ""))
    if gone := int(np.count_nonzero(lost(flown))):
        figures.append(("Flights that lost the aircraft", f"{gone:,}", ""))
    return figures


def _worst(criteria: list[Criterion], key: str) -> tuple[str, str, str] | None:
    """Return the worst figure of a criterion among all trials: the largest fraction of its trial's limit."""
    known = [criterion for criterion in criteria if criterion.key == key and not math.isnan(criterion.fraction)]
    if not known:
        return None
    worst = max(known, key=lambda criterion: criterion.fraction)
    return f"{worst.what}, worst", worst.worst.split(";")[0], worst.limit
