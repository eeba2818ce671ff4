"""Figures over all flights of a run."""

from typing import Any

import numpy as np
import pandas as pd

from reports.document.chart import Array, Chart, Line, Panel, Style, constant
from reports.run.run_data import RunData
from reports.run.time_history import tracking_error

_NU = "Speed ratio ν = V_vessel/V_r [-]"
_SHOWN_TURNS = 45.5
"""How much of a flight a comparison shows after settling, over the time to turn by one radian at omega_max [-]."""

_SHOWN_BANDS = 1.2
"""Largest distance that a comparison shows, over the settling band [-]."""

VARIANT_COLOURS = ("vermillion", "orange", "sky", "purple", "green", "grey")


def sweep_charts(run: RunData) -> list[Chart]:
    """Return the figures over the speed ratio, for the flights that have something to show."""
    flown = run.summary[run.summary["crossing_interval_mean_s"].notna()]
    charts = [
        _interval(flown, run.manifest),
        _distance(run.summary),
        _tracking(flown, run.manifest),
        _command(run.summary, run.manifest),
    ]
    return [chart for chart in charts if any(len(line.x) for panel in chart.panels for line in panel.lines)]


def comparison_chart(run: RunData) -> Chart | None:
    """Return the tracking error of the study's flight and of its comparisons over time since settling, or None."""
    rows = run.comparison
    if not len(rows):
        return None
    ratios = sorted(rows["nu"].unique())
    # The same part of the flight for a fast aircraft, which turns slowly, as for a slow one.
    turn = 1.0 / float(rows["heading_rate_limit_rad_s"].max())
    shown = float(f"{_SHOWN_TURNS * turn:.2g}")
    band = _SHOWN_BANDS * float(run.manifest["config"]["flight"]["settling_band_m"])
    panels = []
    for nu in ratios:
        study = run.summary[np.isclose(run.summary["nu"], nu)]
        compared = rows[np.isclose(rows["nu"], nu)]
        lines = []
        for i, (_, row) in enumerate(compared.iterrows()):
            name = variant_name(str(row["flight_id"]))
            lines += _error_line(run, row, name, VARIANT_COLOURS[i % len(VARIANT_COLOURS)], shown)
        for _, row in study.iterrows():
            lines += _error_line(run, row, "as flown in the study", "blue", shown)
        if lines:
            panels.append(
                Panel(
                    x_label="Time since settling [s]",
                    y_label="Tracking error [m]",
                    lines=lines,
                    title=f"ν = {nu:g}",
                    x_range=(0.0, shown),
                    y_range=(0.0, band),
                )
            )
    if not panels:
        return None
    return Chart(
        name="comparison",
        caption="Distance to the reference from settling on, with parts of the guidance switched off, one at a time and together.",
        panels=panels,
        panel_height=0.34,
    )


def variant_name(flight_id: str) -> str:
    """Return what a comparison is called, from its flight id."""
    return flight_id.split("_", 2)[2].replace("_", " ")


def _error_line(run: RunData, row: "pd.Series[Any]", label: str, colour: str, duration: float) -> list[Line]:
    history = run.history(str(row["flight_id"]))
    if history is None or pd.isna(row["settling_time_s"]):
        return []
    settled = history[history["time_s"] >= row["settling_time_s"]]
    time = settled["time_s"].to_numpy() - float(row["settling_time_s"])
    error = tracking_error(settled)
    shown = time <= duration
    return [Line(x=time[shown], y=error[shown], label=label, colour=colour)]


def _reference(nu: Array, values: Array, label: str, colour: str, style: Style = "dash") -> Line:
    """Return a line to compare points with; drawn to both sides of a single one."""
    if len(nu) == 1:
        nu, values = np.array([nu[0] - 0.05, nu[0] + 0.05]), np.array([values[0], values[0]])
    return Line(x=nu, y=values, label=label, colour=colour, style=style)


def _column(frame: pd.DataFrame, name: str) -> Array:
    return frame[name].to_numpy(dtype=np.float64)


def _interval(flown: pd.DataFrame, manifest: dict[str, Any]) -> Chart:
    nu, mean, predicted = (_column(flown, name) for name in ("nu", "crossing_interval_mean_s", "crossing_interval_predicted_s"))
    limit = 100.0 * float(manifest["config"]["criteria"]["crossing_interval_error"])
    error = 100.0 * (mean / predicted - 1.0)
    return Chart(
        name="interval",
        caption="Time between plume crossings against half the reference's period, π/ω₀. Bars are one standard deviation.",
        panels=[
            Panel(
                x_label=_NU,
                y_label="Crossing interval [s]",
                lines=[
                    _reference(nu, predicted, "predicted, π/ω₀", "black", "solid"),
                    Line(
                        x=nu, y=mean, label="flown, mean", colour="blue", style="points",
                        error=_column(flown, "crossing_interval_std_s"),
                    ),
                ],
            ),
            Panel(
                x_label=_NU,
                y_label="Mean against prediction [%]",
                lines=[
                    Line(x=nu, y=error, label="flown, mean", colour="blue", style="points"),
                    _reference(nu, constant(nu, limit), "criterion", "vermillion"),
                    _reference(nu, constant(nu, -limit), "criterion", "vermillion"),
                ],
            ),
        ],
        columns=2,
        panel_height=0.4,
    )  # fmt: skip


def _distance(summary: pd.DataFrame) -> Chart:
    nu = _column(summary, "nu")
    return Chart(
        name="distance",
        caption="Distances from the funnel. Every crossing and the closest approach of the whole flight lie outside the keep-out"
        " radius, or the flight failed.",
        panels=[
            Panel(
                x_label=_NU,
                y_label="Distance from the funnel [m]",
                lines=[
                    _reference(nu, _column(summary, "keepout_radius_m"), "keep-out radius r_min", "vermillion", "solid"),
                    _reference(nu, _column(summary, "r_co_m"), "centre of oscillation r_CO", "grey"),
                    Line(
                        x=nu, y=_column(summary, "crossing_distance_mean_m"), label="crossings, mean", colour="blue",
                        style="points",
                    ),
                    Line(
                        x=nu, y=_column(summary, "crossing_distance_min_m"), label="crossings, closest", colour="sky",
                        style="diamonds",
                    ),
                    Line(
                        x=nu, y=_column(summary, "min_distance_m"), label="closest approach, whole flight", colour="green",
                        style="points",
                    ),
                ],
            )
        ],
        panel_height=0.42,
    )  # fmt: skip


def _tracking(flown: pd.DataFrame, manifest: dict[str, Any]) -> Chart:
    nu = _column(flown, "nu")
    criteria = manifest["config"]["criteria"]

    def panel(quantity: str, name: str, limit: float) -> Panel:
        return Panel(
            x_label=_NU,
            y_label=quantity,
            lines=[
                Line(x=nu, y=_column(flown, name), label="flown", colour="blue", style="points"),
                _reference(nu, constant(nu, limit), "criterion", "vermillion"),
            ],
            y_range=(0.0, 1.15 * max(limit, float(np.max(_column(flown, name), initial=0.0)))),
        )

    return Chart(
        name="tracking",
        caption="Errors after settling: distance to the reference, airspeed against its command, altitude against that of the"
        " centre of oscillation.",
        panels=[
            panel("Tracking error, rms [m]", "tracking_error_rms_m", criteria["tracking_error_rms_m"]),
            panel("Airspeed error, rms [m/s]", "airspeed_error_rms_mps", criteria["airspeed_error_rms_mps"]),
            panel("Altitude error, max [m]", "altitude_error_max_m", criteria["altitude_error_max_m"]),
        ],
        columns=3,
        panel_height=0.32,
    )


def _command(summary: pd.DataFrame, manifest: dict[str, Any]) -> Chart:
    nu = _column(summary, "nu")
    kinematic = manifest["config"].get("fidelity") == "kinematic"
    about_bank = ""
    if kinematic:
        about_bank = " The kinematic vehicle has no bank: shown is that of a coordinated turn."
    elif manifest["config"]["aircraft"] == "x8":
        about_bank = " The X8 has no rudder: it slips in turns and needs two to three degrees more bank than a coordinated turn."
    return Chart(
        name="command",
        caption="Largest commanded heading rate against ω_max, largest bank, and settling time." + about_bank,
        panels=[
            Panel(
                x_label=_NU,
                y_label="Heading rate [rad/s]",
                lines=[
                    Line(
                        x=nu, y=_column(summary, "heading_rate_command_max_rad_s"), label="largest command", colour="orange",
                        style="points",
                    ),
                    _reference(nu, _column(summary, "heading_rate_limit_rad_s"), "ω_max", "vermillion"),
                ],
            ),
            Panel(
                x_label=_NU,
                y_label="Largest bank [deg]",
                lines=[Line(x=nu, y=_column(summary, "bank_max_deg"), label="flown", colour="blue", style="points")],
            ),
            Panel(
                x_label=_NU,
                y_label="Settling time [s]",
                lines=[Line(x=nu, y=_column(summary, "settling_time_s"), label="flown", colour="blue", style="points")],
            ),
        ],
        columns=3,
        panel_height=0.32,
    )  # fmt: skip
