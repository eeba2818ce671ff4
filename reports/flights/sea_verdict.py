"""What trials over the real sea show, at a glance."""

import math

import numpy as np
import pandas as pd

from reports.document.blocks import Verdict
from reports.document.tables import aircraft
from reports.flights.criteria import Asked, asked
from reports.run.run_data import RunData
from reports.run.trials import Trial, clearance, column, entered, total

_SHOWN = ("crossing_interval_error", "tracking_error_rms_m", "resumes_within_periods")
"""Criteria whose worst figure of all trials has a tile."""


def sea_verdict(run: RunData, trials: list[Trial]) -> Verdict:
    """Judge a run by its summary: safe if flights were flown and none entered the keep-out area."""
    rows = run.summary
    planned = int(run.manifest["flights_planned"])
    flown = rows[rows["min_distance_m"].notna()]
    entries, inside = total(flown, "keepout_violations"), int(np.count_nonzero(entered(flown)))
    met = int(rows["criteria_met"].sum())
    if not len(flown):
        headline = "Nothing was flown"
    elif entries:
        times = "once" if entries == 1 else f"{entries} times in all"
        headline = f"Not safe: {inside} of {len(flown)} flights entered the keep-out area, {times}"
    elif met == planned:
        headline = "Safe: no flight entered the keep-out area, and every flight met what its trial asks for"
    else:
        headline = f"No flight entered the keep-out area, but {planned - met} of {planned} fell short of what their trials ask for"
    return Verdict(
        safe=len(flown) > 0 and entries == 0,
        complete=met == planned,
        headline=headline,
        detail=_detail(run, trials, planned, met, flown),
        failures=[_failure(trial) for trial in trials if not trial.rows["criteria_met"].all() or len(trial.rows) < trial.planned],
        figures=[*_bound(run), *_figures(trials, flown)],
    )


def _detail(run: RunData, trials: list[Trial], planned: int, met: int, flown: pd.DataFrame) -> str:
    count = f"{len(trials)} trials, " if len(trials) > 1 else ""
    detail = f"{count}{len(run.summary):,} of {planned:,} flights are in this report; {met:,} met every criterion."
    if len(flown):
        closest = flown.iloc[int(np.argmin(clearance(flown)))]
        detail += (
            f" Closest approach of any flight, from its first second: {float(closest['min_distance_m']):.1f} m, in"
            f" {closest['flight_id']}."
        )
    if trials and trials[0].config["fidelity"] == "kinematic":
        detail += " Flown with the kinematic vehicle, not with an aircraft."
    else:
        detail += f" Aircraft: {aircraft(run)}, in six degrees of freedom."
    if run.manifest.get("state") != "complete":
        detail += f" The run is {run.manifest.get('state', 'unfinished')}; continue it with --resume."
    return detail


def _failure(trial: Trial) -> str:
    """Return what a trial is short of: entries first, then each criterion, then flights that are not done."""
    rows = trial.rows
    inside = int(np.count_nonzero(entered(rows)))
    parts = [f"{inside} entered the keep-out area, by up to {np.nanmax(column(rows, 'keepout_depth_m')):.1f} m"] if inside else []
    parts += [f"{a.short} did not meet “{a.what}, {a.limit}”" for a in asked(trial) if a.short]
    missing = trial.planned - len(rows)
    parts += [f"{missing} not flown yet"] if missing else []
    unmet = int((~rows["criteria_met"]).sum()) + missing
    return f"{trial.title}: {unmet} of {trial.planned} fell short" + (f" ({'; '.join(parts)})" if parts else "")


def _bound(run: RunData) -> list[tuple[str, str, str]]:
    """Return the bound on the probability of an entry, of a study that estimated it."""
    if run.statistics is None:
        return []
    confidence = f"{100.0 * run.statistics['confidence']:g} %"
    bound = run.statistics["violation"]["pessimistic"]["upper"]
    return [(f"Probability that a flight enters, at most, with {confidence} confidence", f"{bound:.4g}", "")]


def _figures(trials: list[Trial], flown: pd.DataFrame) -> list[tuple[str, str, str]]:
    least = clearance(flown)
    nearest = flown.iloc[int(np.argmin(least))] if len(flown) else None
    command = column(flown, "heading_rate_command_max_rad_s") / column(flown, "heading_rate_limit_rad_s")
    guarded = int(np.count_nonzero(column(flown, "guard_interventions") > 0.0))
    lost = int(np.count_nonzero(column(flown, "guard_lost_s") > 0.0))
    asked_for = {trial.title: asked(trial) for trial in trials}
    worst = [_worst(asked_for, key) for key in _SHOWN]
    return [
        ("Flights flown", f"{len(flown):,}", ""),
        ("Entries into the keep-out area", f"{total(flown, 'keepout_violations'):,}", "0"),
        (
            "Closest approach",
            "none" if nearest is None else f"{float(nearest['min_distance_m']):.1f} m",
            "" if nearest is None else f"≥ {float(nearest['keepout_radius_m']):g} m",
        ),
        ("Heading-rate command over ω_max, worst", f"{np.nanmax(command):.3f}" if np.isfinite(command).any() else "none", "≤ 1"),
        *(figure for figure in worst if figure),
        ("Flights in which the guard intervened", f"{guarded:,} of {len(flown):,}", ""),
        ("Flights in which it could not hold its own radius for a while", f"{lost:,}", ""),
    ]


def _worst(asked_for: dict[str, list[Asked]], key: str) -> tuple[str, str, str] | None:
    """Return the worst figure of a criterion among all trials: that which takes the largest share of its trial's limit."""
    known = [a for criteria in asked_for.values() for a in criteria if a.key == key and not math.isnan(a.share)]
    if not known:
        return None
    worst = max(known, key=lambda a: a.share)
    return f"{worst.what}, worst where asked for", worst.worst.split(";")[0], worst.limit
