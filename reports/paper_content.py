"""The report of the paper's three simulations: each figure on both vehicles, and each published number beside ours."""

import json
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from reports.blocks import Content, FlightContent, FlightPicker, Heading, Section, Table, Text, Verdict
from reports.bounds_section import bounds_section
from reports.flight_charts import flight_charts
from reports.innerloop_section import innerloop_section
from reports.paper_charts import VEHICLES, find_flight, sim_1_charts, sim_2_charts, sim_3_charts
from reports.run_data import RunData
from reports.tables import number, parameter_table, provenance_table

INTERVAL_PRINTED, DISTANCE_PRINTED = 9.5, 214.0
"""What section V of the paper publishes of Simulation 3 [s, m]."""


def paper_content(run: RunData) -> Content:
    """Return everything that the report of the paper's simulations shows."""
    flown = {name: charts for name, charts in _simulations(run).items() if charts}
    bounds = run.path / "bounds.json"
    picker = _flights(run)
    sections = [
        Section(
            anchor="numbers",
            title="The paper's numbers, and ours",
            nav_title="Numbers",
            blocks=[Text(_NUMBERS), _number_table(run)],
        ),
        *(
            Section(anchor=f"sim{number}", title=title, nav_title=f"Sim. {number}", blocks=[Text(text), *flown[number]])
            for number, title, text in _SIMULATIONS
            if number in flown
        ),
        *([bounds_section(json.loads(bounds.read_text(encoding="utf-8")))] if bounds.is_file() else []),
        *([Section(anchor="flights", title="Simulation 3 in detail", blocks=[picker])] if picker.flights else []),
        *([innerloop_section(run.innerloop)] if run.innerloop else []),
        Section(
            anchor="parameters",
            title="Parameters",
            blocks=[
                Heading("What each simulation sets"),
                _case_table(run),
                Heading("Every parameter, where a simulation sets nothing"),
                parameter_table(run),
            ],
        ),
        Section(anchor="provenance", title="Provenance", blocks=[provenance_table(run)]),
    ]  # fmt: skip
    return Content(
        title=run.manifest["title"],
        description=run.manifest["config"]["description"],
        changes=", ".join(run.manifest["overrides"]),
        verdict=_verdict(run),
        sections=sections,
    )


_NUMBERS = (
    "The same guidance steers both vehicles, from the same starts. The kinematic vehicle keeps its speed, as in the paper; the"
    " aircraft is flown as everywhere in this study, its airspeed trimmed by the along-track error. The paper prints neither"
    " gains nor starts: what can be compared are the numbers and statements of its section V."
)

_SIMULATIONS = (
    ("1", "Simulation 1: a circular reference, opposite headings",
     "The UAV starts beside the reference and heads the other way. Look-ahead and steering are those that converge fastest while no"
     " state whatever makes the law ask for more than ω_max (see the section on actuation bounds)."),
    ("2", "Simulation 2: line of sight against the δ formulation",
     "Both UAVs start in front of the reference and fly towards it. Passing it, the line of sight turns arbitrarily fast: there is"
     " the singularity that the δ formulation takes away."),
    ("3", "Simulation 3: the smoke plume at ν = 0.5",
     "A vessel on a straight course at half the UAV's speed, plume straight astern, r_min = 200 m. As in the paper the reference"
     " spends all of ω_max; then no parameters bound what the law asks for, and commands are cut at ω_max on the way to it."),
)  # fmt: skip


def _simulations(run: RunData) -> dict[str, list[Any]]:
    charts = {"1": sim_1_charts(run), "2": sim_2_charts(run), "3": sim_3_charts(run)}
    return {name: [chart for chart in found if chart.panels] for name, found in charts.items()}


def _rows(run: RunData) -> dict[str, "pd.Series[Any]"]:
    return {str(row["flight_id"]): row for frame in (run.summary, run.comparison) for _, row in frame.iterrows()}


def _number_table(run: RunData) -> Table:
    rows = _rows(run)

    def both(case: str, show: Callable[["pd.Series[Any]"], str]) -> list[str]:
        cells = []
        for fidelity in VEHICLES:
            row = rows.get(f"{case}_{fidelity}")
            cells.append("–" if row is None else show(row))
        return cells

    def value(key: str, pattern: str) -> Callable[["pd.Series[Any]"], str]:
        return lambda row: number(row[key], pattern)

    def against(key: str, printed: float, pattern: str) -> Callable[["pd.Series[Any]"], str]:
        return lambda row: f"{number(row[key], pattern)} ({100.0 * (float(row[key]) / printed - 1.0):+.2f} %)"

    def omega(row: "pd.Series[Any]") -> str:
        wanted, limit = float(row["heading_rate_wanted_max_rad_s"]), float(row["heading_rate_limit_rad_s"])
        return f"{wanted:.3f} rad/s ({'within' if wanted <= limit else 'exceeds'} {limit:g})"

    def end(row: "pd.Series[Any]") -> str:
        return f"{float(row['tracking_error_end_m']):.4f} m after {float(row['duration_s']):.0f} s"

    def falls(row: "pd.Series[Any]") -> str:
        return _rise_once_inside(run, str(row["flight_id"]))

    interval = against("crossing_interval_mean_s", INTERVAL_PRINTED, "{:.4f} s")
    distance = against("crossing_distance_mean_m", DISTANCE_PRINTED, "{:.2f} m")
    closest = value("min_distance_m", "{:.2f} m")
    table = [
        ["Sim. 3", "smoke plume measurements every", "9.5 s", *both("sim3", interval)],
        ["Sim. 3", "distance from the vessel there", "214 m", *both("sim3", distance)],
        ["Sim. 3", "never enters the keep-out area of 200 m: closest approach", "> 200 m", *both("sim3", closest)],
        ["Sim. 3", "η = J₀⁻¹(0.5), eq. (6)", "not printed", *both("sim3", value("eta", "{:.6f} rad"))],
        ["Sim. 1", "converges onto the circle: distance at the end", "→ 0", *both("sim1", end)],
        ["Sim. 1", "largest rise of d in a sample with |φ| < |φ_r|", "none", *both("sim1", falls)],
        ["Sim. 2", "δ law: largest heading rate asked for", "feasible", *both("sim2_delta", omega)],
        ["Sim. 2", "δ law: distance at the end", "→ 0", *both("sim2_delta", end)],
        ["Sim. 2", "line of sight: largest heading rate asked for", "saturates", *both("sim2_los", omega)],
        ["Sim. 2", "line of sight: distance at the end", "near soon", *both("sim2_los", end)],
    ]  # fmt: skip
    head = ["", "What section V says", "Printed", "Kinematic", "Six degrees of freedom"]
    return Table(head=head, rows=table, widths=[0.6, 2.6, 0.9, 1.7, 1.7], left_columns=2)


def _rise_once_inside(run: RunData, flight_id: str) -> str:
    """Return the largest rise of the distance between samples that both have |phi| < |phi_r|, eq. (35)."""
    flown = find_flight(run, flight_id)
    if flown is None:
        return "–"
    phi, phi_r = np.abs(flown.column("phi_rad")), np.abs(flown.column("phi_r_rad"))
    inside = np.maximum(phi[:-1], phi[1:]) < np.minimum(phi_r[:-1], phi_r[1:])
    rise = float(np.max(np.diff(flown.distance)[inside], initial=0.0))
    return "none" if rise < 1e-6 else f"{1000.0 * rise:.2g} mm"


def _case_table(run: RunData) -> Table:
    def words(values: dict[str, Any]) -> str:
        return ", ".join(f"{key} = {json.dumps(value)}" for key, value in values.items())

    rows = [[case["name"], words(case["set"]), words(case["set_kinematic"])] for case in run.manifest["config"]["cases"]]
    head = ["Simulation", "Both vehicles", "Kinematic vehicle besides"]
    return Table(head=head, rows=rows, widths=[0.9, 3.4, 1.8], left_columns=3, prose=True, breakable=True)


def _flights(run: RunData) -> FlightPicker:
    flights = [
        FlightContent(
            flight_id=str(row["flight_id"]),
            label=VEHICLES[str(row["fidelity"])],
            title=f"Simulation 3: {VEHICLES[str(row['fidelity'])]}",
            charts=flight_charts(run, row),
        )
        for _, row in run.summary.iterrows()
        if str(row["flight_id"]).startswith("sim3") and not math.isnan(float(row["min_distance_m"]))
    ]
    return FlightPicker(flights=flights)


def _verdict(run: RunData) -> Verdict:
    summary, rows = run.summary, _rows(run)
    planned = int(run.manifest.get("flights_planned", len(summary)))
    met = int(summary["criteria_met"].sum())
    entries = int(summary["keepout_violations"].fillna(0).sum())
    complete = met == planned
    if entries:
        headline = f"Simulation 3 entered the keep-out area {entries} times"
    elif complete:
        headline = "Reproduced: every statement of section V that we could test holds, on both vehicles"
        if run.manifest["config"]["fidelity"] != "both":
            headline = f"Reproduced on the {VEHICLES[run.manifest['config']['fidelity']]}"
    else:
        headline = f"{planned - met} of {planned} flights fell short"
    failures = [
        f"{row['flight_id']}: {str(row['outcome']).replace('_', ' ')}, {row['message']}"
        for _, row in summary[~summary["criteria_met"]].iterrows()
    ]
    detail = f"{len(summary)} of {planned} flights are in this report; {met} met every criterion."
    if run.manifest.get("state") != "complete":
        detail += f" The run is {run.manifest.get('state', 'unfinished')}; continue it with --resume."

    figures = []
    for fidelity, name in (("kinematic", "kinematic"), ("six_dof", "six degrees of freedom")):
        limit = "± 0.5 %" if fidelity == "kinematic" else "± 2 %"
        row = rows.get(f"sim3_{fidelity}")
        if row is not None:
            figures += [
                (f"Sim. 3 interval, {name}", number(row["crossing_interval_mean_s"], "{:.3f} s"), f"9.5 s {limit}"),
                (f"Sim. 3 distance, {name}", number(row["crossing_distance_mean_m"], "{:.2f} m"), f"214 m {limit}"),
            ]
    for case, name in (("sim1", "Sim. 1"), ("sim2_delta", "Sim. 2")):
        row = rows.get(f"{case}_kinematic")
        if row is not None:
            figures.append((f"{name} distance at the end, kinematic", number(row["tracking_error_end_m"], "{:.4f} m"), "< 0.1 m"))
    for case, name in (("sim2_delta", "δ law"), ("sim2_los", "line of sight")):
        row = rows.get(f"{case}_kinematic")
        if row is not None:
            limit = number(row["heading_rate_limit_rad_s"], "{:g} rad/s")
            wanted = number(row["heading_rate_wanted_max_rad_s"], "{:.3f} rad/s")
            figures.append((f"Sim. 2, {name} asks for", wanted, f"≤ {limit}" if case == "sim2_delta" else f"> {limit}"))
    return Verdict(safe=entries == 0, complete=complete, headline=headline, detail=detail, failures=failures, figures=figures)
