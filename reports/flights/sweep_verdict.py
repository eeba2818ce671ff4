"""What a sweep shows, at a glance."""

import numpy as np
import pandas as pd

from reports.document.blocks import Verdict
from reports.document.tables import aircraft, kinematic, limit
from reports.run.run_data import RunData


def verdict(run: RunData) -> Verdict:
    """Judge a run by its summary: safe if no flight entered the keep-out area and every crossing lay outside it."""
    summary, manifest = run.summary, run.manifest
    planned = int(manifest["flights_planned"])
    flown = summary[summary["min_distance_m"].notna()]
    entries = int(flown["keepout_violations"].sum())
    inside = int((flown["crossing_distance_min_m"] < flown["keepout_radius_m"]).sum())
    met = int(summary["criteria_met"].sum())
    safe = entries == 0 and inside == 0 and len(flown) > 0
    complete = met == planned
    closest = float(flown["min_distance_m"].min()) if len(flown) else float("nan")
    radius = float(manifest["config"]["keepout"]["radius_m"])
    if not len(flown):
        headline = "Nothing was flown"
    elif not safe:
        headline = f"Not safe: {entries} entries into the keep-out area of {radius:g} m, {inside} flights crossed inside it"
    elif complete:
        headline = f"Safe: no flight entered the keep-out area of {radius:g} m, and every flight met its criteria"
    else:
        headline = f"No flight entered the keep-out area of {radius:g} m, but {planned - met} of {planned} fell short"
    unmet = summary[~summary["criteria_met"]]
    failures = [f"ν = {row['nu']:g}: {row['outcome'].replace('_', ' ')}, {row['message']}" for _, row in unmet.iterrows()]
    detail = f"{len(summary)} of {planned} flights are in this report; {met} completed and met every criterion."
    if len(flown):
        detail += f" Closest approach of any flight, from its first second: {closest:.1f} m."
    if manifest["config"].get("fidelity") == "kinematic":
        detail += f" Flown with the kinematic vehicle, {kinematic(run)}, not with an aircraft."
    else:
        detail += f" Aircraft: {aircraft(run)}, in six degrees of freedom."
    if manifest.get("state") != "complete":
        detail += f" The run is {manifest.get('state', 'unfinished')}; continue it with --resume."
    return Verdict(safe=safe, complete=complete, headline=headline, detail=detail, failures=failures, figures=_figures(run, flown))


def _figures(run: RunData, flown: pd.DataFrame) -> list[tuple[str, str, str]]:
    criteria = run.manifest["config"]["criteria"]
    radius = float(run.manifest["config"]["keepout"]["radius_m"])
    interval = flown["crossing_interval_mean_s"] / flown["crossing_interval_predicted_s"] - 1.0

    def worst(values: "pd.Series[float]", pattern: str) -> str:
        known = values.dropna()
        return pattern.format(float(known.max())) if len(known) else "none"

    crossings = int(flown["crossing_count"].sum()) if len(flown) else 0
    minimum = flown["crossing_distance_min_m"].dropna()
    command = flown["heading_rate_command_max_rad_s"] / flown["heading_rate_limit_rad_s"]
    closest = f"{float(minimum.min()):.1f} m" if len(minimum) else "none"
    interval_limit = f"≤ {limit(100 * criteria['crossing_interval_error'])} %"
    tracking_limit = f"≤ {limit(criteria['tracking_error_rms_m'])} m"
    airspeed_limit = f"≤ {limit(criteria['airspeed_error_rms_mps'])} m/s"
    altitude_limit = f"≤ {limit(criteria['altitude_error_max_m'])} m"
    asked = [("Heading-rate command over ω_max, worst", worst(command, "{:.3f}"), "≤ 1")]
    if run.manifest["config"]["guidance"].get("tuning") == "bounded":
        wanted = flown["heading_rate_wanted_max_rad_s"] / flown["heading_rate_limit_rad_s"]
        bound = flown["heading_rate_bound_rad_s"] / flown["heading_rate_limit_rad_s"]
        asked = [("The law asks for, over ω_max, worst", worst(wanted, "{:.3f}"), worst(bound, "≤ {:.4f} in any state"))]
    return [
        ("Entries into the keep-out area", f"{int(flown['keepout_violations'].sum())}", "0"),
        ("Plume crossings after settling", f"{crossings}", ""),
        ("Closest crossing", closest, f"≥ {radius:g} m"),
        ("Mean interval against π/ω₀, worst", worst(np.abs(interval) * 100.0, "{:.2f} %"), interval_limit),
        ("Tracking error rms, worst", worst(flown["tracking_error_rms_m"], "{:.2f} m"), tracking_limit),
        ("Airspeed error rms, worst", worst(flown["airspeed_error_rms_mps"], "{:.3f} m/s"), airspeed_limit),
        ("Altitude error, worst", worst(flown["altitude_error_max_m"], "{:.2f} m"), altitude_limit),
        *asked,
    ]
