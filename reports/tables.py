"""Tables of a report: heads and rows of text."""

import math
from dataclasses import dataclass
from typing import Any

import pandas as pd

from reports.run_data import RunData
from reports.sweep_charts import variant_name


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table of text.

    Attributes
    ----------
    head : column titles with units
    rows : cells
    widths : relative widths of the columns
    """

    head: list[str]
    rows: list[list[str]]
    widths: list[float]


_FLIGHT_COLUMNS = (
    ("Entries", "keepout_violations", "{:.0f}"),
    ("Closest [m]", "min_distance_m", "{:.1f}"),
    ("Crossings", "crossing_count", "{:.0f}"),
    ("Interval [s]", "crossing_interval_mean_s", "{:.2f}"),
    ("π/ω₀ [s]", "crossing_interval_predicted_s", "{:.2f}"),
    ("Crossing, min [m]", "crossing_distance_min_m", "{:.1f}"),
    ("Settled [s]", "settling_time_s", "{:.0f}"),
    ("Tracking rms [m]", "tracking_error_rms_m", "{:.2f}"),
)


def flight_table(frame: pd.DataFrame, first: str = "ν") -> Table:
    """Return a row per flight, and its outcome in words."""
    rows = []
    for _, row in frame.iterrows():
        name = f"{row['nu']:.2f}" if first == "ν" else f"{variant_name(str(row['flight_id']))}, ν = {row['nu']:g}"
        rows.append([name, *(_number(row[key], pattern) for _, key, pattern in _FLIGHT_COLUMNS), _outcome(row)])
    head = [first, *(title for title, _, _ in _FLIGHT_COLUMNS), "Outcome"]
    return Table(head=head, rows=rows, widths=[1.0 if first == "ν" else 2.4, *[0.9] * len(_FLIGHT_COLUMNS), 2.6])


def comparison_table(run: RunData) -> Table:
    """Return the comparisons and, beside them, the study's own flights at the same speed ratios."""
    ratios = set(run.comparison["nu"])
    study = run.summary[run.summary["nu"].isin(ratios)].copy()
    study["flight_id"] = "nu_0_as_flown_in_the_study"
    both = pd.concat([study, run.comparison]).sort_values("nu", kind="stable")
    return flight_table(both, first="Guidance")


def parameter_table(run: RunData) -> Table:
    """Return every parameter of the run with its unit and meaning, and what follows from them."""
    rows = [[p["key"], _value(p["value"]), p["unit"], p["meaning"]] for p in run.manifest["parameters"]]
    summary = run.summary
    known = summary["heading_rate_limit_rad_s"].dropna()
    if len(known):
        rows.append(["ω_max", f"{known.iloc[0]:.4f}", "rad/s", "Largest heading-rate command: g tan(bank)/V_r, or as given."])
    if "guidance_lag_s" in run.manifest:
        rows.append([
            "guidance lag", f"{run.manifest['guidance_lag_s']:.3f}", "s",
            "Measured lag of the flown heading rate behind its command, and half a guidance step; the preview's lead.",
        ])  # fmt: skip
    return Table(head=["Parameter", "Value", "Unit", "Meaning and equation"], rows=rows, widths=[2.2, 1.2, 0.7, 4.5])


def oscillation_table(run: RunData) -> Table:
    """Return the reference's oscillation at every speed ratio."""
    rows = [
        [
            f"{row['nu']:.2f}",
            _number(row["eta"], "{:.4f}"),
            _number(row["omega_0_rad_s"], "{:.4f}"),
            _number(row["crossing_interval_predicted_s"], "{:.3f}"),
            _number(row["r_co_m"], "{:.2f}"),
            "" if pd.isna(row["oscillation_limit"]) else str(row["oscillation_limit"]),
        ]
        for _, row in run.summary.iterrows()
    ]
    head = ["ν, vessel over UAV speed", "η = J₀⁻¹(ν) (6) [rad]", "ω₀ (8) [rad/s]", "π/ω₀ [s]", "r_CO (10) [m]", "ω₀ limited by"]
    return Table(head=head, rows=rows, widths=[1.0] * 6)


def margin_table(design: dict[str, Any]) -> Table:
    """Return the margins at the middle design airspeed."""
    airspeed = design["design_airspeed_mps"]
    rows = [
        [
            m["loop"].replace("_", " "),
            _margin(m["gain_db"], "{:.1f}", m["loop"]),
            _margin(m["phase_deg"], "{:.1f}", m["loop"]),
            _number(m["crossover"], "{:.2f}"),
            _number(m["disk_gain_db"], "{:.1f}"),
            _number(m["disk_phase_deg"], "{:.1f}"),
        ]
        for m in design["margins"]
        if m["airspeed_mps"] == airspeed
    ]
    head = ["Loop opened at", "Gain [dB]", "Phase [deg]", "Crossover [rad/s]", "Disk gain [dB]", "Disk phase [deg]"]
    return Table(head=head, rows=rows, widths=[1.6, 1.0, 1.0, 1.2, 1.1, 1.2])


def step_table(design: dict[str, Any]) -> Table:
    """Return what the flown steps show."""
    rows = [
        [
            f"{response['command'].replace('_', ' ')}, {response['size']:g}",
            response["kind"],
            _number(response["rise_time_s"], "{:.2f}"),
            f"{100 * response['overshoot']:.1f}",
            f"{response['altitude_largest_m']:.3f}",
            f"{response['airspeed_largest_mps']:.3f}",
        ]
        for response in design["responses"]
    ]
    head = ["Step [rad/s, m/s, m]", "", "Rise 10–90 % [s]", "Overshoot [%]", "Altitude moves [m]", "Airspeed moves [m/s]"]
    return Table(head=head, rows=rows, widths=[1.6, 0.9, 1.2, 1.0, 1.2, 1.3])


def trim_table(design: dict[str, Any]) -> Table:
    """Return the equilibria behind the design."""
    rows = [
        [
            f"{t['airspeed_mps']:g}",
            f"{round(math.degrees(t['bank_rad']), 1) + 0.0:.1f}",
            f"{t['alpha_rad']:.4f}",
            f"{t['sideslip_rad']:.4f}",
            f"{t['pitch_rad']:.4f}",
            f"{t['yaw_rate_rad_s']:.4f}",
            f"{t['elevator_position']:.4f}",
            f"{t['aileron_position']:.4f}",
            f"{t['throttle']:.3f}",
        ]
        for t in design["trims"]
    ]
    head = [
        "Airspeed [m/s]", "Bank [deg]", "α [rad]", "β [rad]", "θ [rad]", "Yaw rate [rad/s]", "Elevator [rad]", "Aileron [rad]",
        "Throttle [-]",
    ]  # fmt: skip
    return Table(head=head, rows=rows, widths=[1.0] * 9)


def provenance_table(run: RunData) -> Table:
    """Return where the run comes from."""
    manifest = run.manifest
    rows = [
        ["Scenario", f"{manifest['name']}: {manifest['title']}"],
        ["Aircraft", run.innerloop["title"] + ". " + run.innerloop["source"] if run.innerloop else manifest["config"]["aircraft"]],
        ["Seed", str(manifest["config"]["seed"])],
        ["Configuration hash", manifest["config_hash"]],
        ["Source revision", manifest["git_revision"]],
        ["Python", f"{manifest['python']} on {manifest['platform']}"],
        ["Packages", ", ".join(f"{name} {version}" for name, version in manifest["packages"].items())],
        ["State", manifest["state"]],
    ]
    if "wall_time_s" in manifest:
        rows.append(["Wall time", f"{manifest['wall_time_s']:.1f} s"])
    return Table(head=["", ""], rows=rows, widths=[1.0, 4.0])


def _margin(value: float | None, pattern: str, loop: str) -> str:
    if value is None:
        return "–" if loop == "all controls" else "∞"
    return pattern.format(value)


def _number(value: Any, pattern: str) -> str:
    return "–" if value is None or pd.isna(value) else pattern.format(float(value))


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return " to ".join(_value(v) for v in value)
    return "not set" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _outcome(row: "pd.Series[Any]") -> str:
    message = str(row["message"])
    if row["criteria_met"]:
        return "met"
    outcome = str(row["outcome"]).replace("_", " ")
    return f"{outcome}: {message}" if message else outcome
