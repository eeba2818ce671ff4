"""Tables over all flights of a run."""

import pandas as pd

from reports.document.blocks import Table
from reports.document.tables import number, outcome, parameter_table
from reports.flights.speed_ratio_charts import variant_name
from reports.run.run_data import RunData

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
        rows.append([name, *(number(row[key], pattern) for _, key, pattern in _FLIGHT_COLUMNS), outcome(row)])
    head = [first, *(title for title, _, _ in _FLIGHT_COLUMNS), "Outcome"]
    return Table(head=head, rows=rows, widths=[1.0 if first == "ν" else 2.2, *[1.05] * len(_FLIGHT_COLUMNS), 2.2])


def comparison_table(run: RunData) -> Table:
    """Return the comparisons and, beside them, the study's own flights at the same speed ratios."""
    ratios = set(run.comparison["nu"])
    study = run.summary[run.summary["nu"].isin(ratios)].copy()
    study["flight_id"] = "nu_0_as_flown_in_the_study"
    both = pd.concat([study, run.comparison]).sort_values("nu", kind="stable")
    return flight_table(both, first="Guidance")


def oscillation_table(run: RunData) -> Table:
    """Return the reference's oscillation at every speed ratio."""
    rows = [
        [
            f"{row['nu']:.2f}",
            number(row["eta"], "{:.4f}"),
            number(row["omega_0_rad_s"], "{:.4f}"),
            number(row["crossing_interval_predicted_s"], "{:.3f}"),
            number(row["r_co_m"], "{:.2f}"),
            "" if pd.isna(row["oscillation_limit"]) else str(row["oscillation_limit"]),
        ]
        for _, row in run.summary.iterrows()
    ]
    head = ["ν, vessel over UAV speed", "η = J₀⁻¹(ν) (6) [rad]", "ω₀ (8) [rad/s]", "π/ω₀ [s]", "r_CO (10) [m]", "ω₀ limited by"]
    return Table(head=head, rows=rows, widths=[1.0] * 6)


def sweep_parameter_table(run: RunData) -> Table:
    """Return every parameter of the run with its unit and meaning, and what follows from them."""
    rows = []
    known = run.summary["heading_rate_limit_rad_s"].dropna()
    if len(known):
        rows.append(["ω_max", f"{known.iloc[0]:.4f}", "rad/s", "Largest heading-rate command: g tan(bank)/V_r, or as given."])
    if "guidance_lag_s" in run.manifest:
        rows.append([
            "guidance lag", f"{run.manifest['guidance_lag_s']:.3f}", "s",
            "Lag of the heading rate behind its command (measured of an aircraft, given of a kinematic vehicle) and half a step of"
            " the guidance: the preview's lead.",
        ])  # fmt: skip
    if run.manifest["config"]["guidance"]["tuning"] == "bounded":
        for name, key, pattern, unit in (
            ("ε as searched", "epsilon_per_m", "{:.5f}", "1/m"),
            ("R as searched", "look_ahead_m", "{:.1f}", "m"),
            ("steering_max as searched", "steering_max_rad_s", "{:.4f}", "rad/s"),
            ("bound on what the law asks for", "heading_rate_bound_rad_s", "{:.5f}", "rad/s"),
        ):
            rows.append([name, _range(run.summary[key], pattern), unit, "Over the flights; docs/actuation_bounds.md."])
    return parameter_table(run, rows)


def _range(values: "pd.Series[float]", pattern: str) -> str:
    """Return the least and the largest value, or the only one."""
    known = values.dropna()
    if not len(known):
        return "–"
    ends = [pattern.format(known.min()), pattern.format(known.max())]
    return ends[0] if ends[0] == ends[1] else " to ".join(ends)
