"""The report of the paper's three simulations: each figure on both vehicles, and each published
number beside ours.
"""

import json
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from common.run_layout import BOUNDS
from reports.design.section import innerloop_section
from reports.document.blocks import (
    Findings,
    FlightContent,
    FlightPicker,
    Heading,
    Section,
    Table,
    Text,
)
from reports.document.chart import Chart
from reports.document.tables import approach, kinematic, length, number, outcome, parameter_blocks
from reports.flights.flight_view import flight_view
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import track_picture
from reports.paper.bounds import bounds_section
from reports.paper.charts import sim_1_charts, sim_2_charts, sim_3_charts
from reports.paper.checks import (
    DISTANCE_PRINTED,
    INTERVAL_PRINTED,
    paper_verdict,
    rows_by_id,
    vehicles,
)
from reports.paper.flown import VEHICLES, find_flight, vehicle_name
from reports.replay.flight_scene import flight_scene
from reports.run.run_data import RunData
from reports.run.trials import read_trials


def paper_content(run: RunData) -> Findings:
    """Return the findings of the paper's simulations."""
    bounds = run.path / BOUNDS
    sections = [
        Section(
            anchor="numbers",
            title="The paper's numbers, and ours",
            nav_title="Numbers",
            blocks=[Text(_NUMBERS), _number_table(run), _flight_table(run)],
        ),
        *(
            Section(anchor=f"sim{i}", title=f"Simulation {i}: {title}", nav_title=f"Sim. {i}", blocks=[Text(text), *charts])
            for i, (title, text, figures) in enumerate(_SIMULATIONS, start=1)
            if (charts := [chart for chart in figures(run) if chart.panels])
        ),
        *([bounds_section(json.loads(bounds.read_text(encoding="utf-8")))] if bounds.is_file() else []),
        _detail(_flights(run)),
        innerloop_section(run),
        Section(
            anchor="parameters",
            title="Parameters",
            blocks=[
                Heading("What each simulation sets"),
                _case_table(run),
                *parameter_blocks(run),
            ],
        ),
    ]  # fmt: skip
    return Findings(
        flown=_flown(run), verdict=paper_verdict(run), picture=_picture(run), sections=sections
    )


def _flown(run: RunData) -> str:
    names = {"kinematic": f"the kinematic vehicle, {kinematic(run)}"}
    flown = ", and of ".join(
        names.get(fidelity, "the aircraft in six degrees of freedom") for fidelity in vehicles(run)
    )
    return f"Simulations 1 to 3 of the paper: {len(run.summary)} flights of {flown}."


def _picture(run: RunData) -> Chart | None:
    """Return Simulation 3 on each vehicle, or the first figure that there is."""
    (trial,) = read_trials(run)
    rows = {
        fidelity: row
        for fidelity in VEHICLES
        if (row := rows_by_id(run).get(f"sim3_{fidelity}")) is not None
    }
    shown = [
        (trial, row, f"Simulation 3: {vehicle_name(run, fidelity)}")
        for fidelity, row in rows.items()
    ]
    charts = (
        chart for figures in (sim_1_charts, sim_2_charts) for chart in figures(run) if chart.panels
    )
    return track_picture(shown) or next(charts, None)


_NUMBERS = (
    "The same guidance steers both vehicles, from the same starts. The kinematic vehicle keeps its speed, as in the paper; the"
    " aircraft is flown as everywhere in this study, its airspeed trimmed by the along-track error. The paper prints neither"
    " gains nor starts: what can be compared are the numbers and statements of its section V."
)

_DEMAND, _END = "heading_rate_demand_max_rad_s", "tracking_error_end_m"

_SIM_ONE = (
    "The UAV starts beside the reference and heads the other way. Look-ahead and steering are those that converge fastest while"
    " the heading-rate demand of the law stays within ω_max in every state (see the section on actuation bounds). That is why it"
    " turns so gently, and strays hundreds of metres before it comes back: the price of the guarantee."
)

_SIM_TWO = (
    "Both UAVs start in front of the reference and fly towards it. Passing it, the line of sight turns arbitrarily fast: there"
    " is the singularity that the δ formulation takes away. The paper has UAV 1 converge fast onto the reference; with our gain"
    " it is near within seconds, but at constant speed stays behind for good."
)

_SIM_THREE = (
    "A vessel on a straight course, the UAV from a random place behind it. In the paper the vessel has half the UAV's speed,"
    " and the reference spends all of ω_max; then no parameters keep the demand of the law within it, and commands are cut at"
    " ω_max."
)

_SIMULATIONS = (
    ("a circular reference, opposite headings", _SIM_ONE, sim_1_charts),
    ("line of sight against the δ formulation", _SIM_TWO, sim_2_charts),
    ("the smoke plume", _SIM_THREE, sim_3_charts),
)


def _detail(picker: FlightPicker) -> Section:
    text = Text("The flights beside a vessel, drawn as those of any other study.")
    return Section(
        anchor="flights",
        title="Single flights",
        nav_title="Flights",
        blocks=[text, picker] if picker.flights else [],
    )


def _flight_table(run: RunData) -> Table:
    rows = []
    for flight_id, row in rows_by_id(run).items():
        end = row[_END]
        rows.append([
            flight_id,
            number(row["settling_time_s"], "{:.1f}"),
            "–" if pd.isna(end) else length(float(end)),
            number(row[_DEMAND], "{:.3f}"),
            number(row["crossing_interval_mean_s"], "{:.3f}"),
            number(row["crossing_distance_mean_m"], "{:.2f}"),
            approach(float(row["min_distance_m"]), float(row["keepout_radius_m"])),
            outcome(row),
        ])  # fmt: skip
    head = [
        "Flight", "Settled [s]", "Distance at the end", "Demand [rad/s]", "Interval [s]", "Crossing [m]", "Closest [m]",
        "Outcome",
    ]  # fmt: skip
    return Table(
        caption="The flights, a row each, with their outcome.",
        head=head,
        rows=rows,
        widths=[1.9, 0.9, 1.1, 1.1, 0.9, 1.0, 1.0, 1.6],
    )


def _number_table(run: RunData) -> Table:
    rows = rows_by_id(run)

    def both(case: str, show: Callable[["pd.Series[Any]"], str], key: str) -> list[str]:
        """Return a cell per vehicle; a dash where there is no such flight, or its row has nothing
        under ``key``.
        """
        found = [rows.get(f"{case}_{fidelity}") for fidelity in VEHICLES]
        return ["–" if row is None or pd.isna(row[key]) else show(row) for row in found]

    def against(key: str, printed: float, pattern: str) -> Callable[["pd.Series[Any]"], str]:
        return lambda row: (
            f"{number(row[key], pattern)} ({number(100.0 * (float(row[key]) / printed - 1.0), '{:+.2f} %')})"
        )

    def omega(row: "pd.Series[Any]") -> str:
        demand, limit = float(row[_DEMAND]), float(row["heading_rate_limit_rad_s"])
        return f"{demand:.3f} rad/s ({'within' if demand <= limit else 'exceeds'} {limit:g})"

    def end(row: "pd.Series[Any]") -> str:
        return f"{length(float(row[_END]))} after {float(row['duration_s']):.0f} s"

    def near(row: "pd.Series[Any]") -> str:
        return _near_for_good(run, str(row["flight_id"]))

    def falls(row: "pd.Series[Any]") -> str:
        return _rise_once_inside(run, str(row["flight_id"]))

    interval, distance, closest = (
        "crossing_interval_mean_s",
        "crossing_distance_mean_m",
        "min_distance_m",
    )
    radius = f"{float(run.manifest['config']['keepout']['radius_m']):g} m"
    table = [
        ["Sim. 3", "smoke plume measurements every", "9.5 s",
         *both("sim3", against(interval, INTERVAL_PRINTED, "{:.4f} s"), interval)],
        ["Sim. 3", "distance from the vessel there", "214 m",
         *both("sim3", against(distance, DISTANCE_PRINTED, "{:.2f} m"), distance)],
        ["Sim. 3", f"never enters the keep-out area of {radius}: closest approach", "> 200 m",
         *both("sim3", lambda row: f"{float(row[closest]):.2f} m", closest)],
        ["Sim. 3", "η = J₀⁻¹(ν), eq. (6)", "not printed", *both("sim3", lambda row: f"{float(row['eta']):.6f} rad", "eta")],
        ["Sim. 1", "converges onto the circle: distance at the end", "→ 0", *both("sim1", end, _END)],
        ["Sim. 1", "largest rise of d in a sample with |φ| < |φ_r|", "none", *both("sim1", falls, _END)],
        ["Sim. 2", "δ law: largest heading-rate demand", "feasible", *both("sim2_delta", omega, _DEMAND)],
        ["Sim. 2", "δ law: distance at the end", "→ 0", *both("sim2_delta", end, _END)],
        ["Sim. 2", "line of sight: largest heading-rate demand", "saturates", *both("sim2_los", omega, _DEMAND)],
        ["Sim. 2", "line of sight: within 30 m for good", "fast", *both("sim2_los", near, _END)],
        ["Sim. 2", "line of sight: distance at the end", "not printed", *both("sim2_los", end, _END)],
    ]  # fmt: skip
    head = ["", "What section V says", "Printed", "Kinematic", "Six degrees of freedom"]
    return Table(
        caption="What section V of the paper prints, and what both vehicles show.",
        head=head,
        rows=table,
        widths=[0.6, 2.6, 0.9, 1.7, 1.7],
        left_columns=2,
    )


def _rise_once_inside(run: RunData, flight_id: str) -> str:
    """Return the largest rise of the distance between samples that both have |phi| < |phi_r|, eq.
    (35).
    """
    flown = find_flight(run, flight_id)
    if flown is None:
        return "–"
    phi, phi_r = np.abs(flown.column("phi_rad")), np.abs(flown.column("phi_r_rad"))
    inside = np.maximum(phi[:-1], phi[1:]) < np.minimum(phi_r[:-1], phi_r[1:])
    rise = float(np.max(np.diff(flown.distance)[inside], initial=0.0))
    return "none" if rise < 1e-6 else f"{1000.0 * rise:.2g} mm"


def _near_for_good(run: RunData, flight_id: str) -> str:
    """Return the time after which a flight stays within 30 m of its reference."""
    flown = find_flight(run, flight_id)
    if flown is None or flown.distance[-1] >= 30.0:
        return "never"
    return f"after {float(np.max(flown.time[flown.distance >= 30.0], initial=0.0)):.0f} s"


def _case_table(run: RunData) -> Table:
    def words(values: dict[str, Any]) -> str:
        return ", ".join(f"{key} = {json.dumps(value)}" for key, value in values.items())

    rows = [
        [case["name"], words(case["set"]), words(case["set_kinematic"])]
        for case in run.manifest["config"]["cases"]
    ]
    head = ["Simulation", "Both vehicles", "Kinematic vehicle besides"]
    return Table(
        head=head, rows=rows, widths=[0.9, 3.4, 1.8], left_columns=3, prose=True, breakable=True
    )


def _flights(run: RunData) -> FlightPicker:
    """Return the flights with a vessel whose world is the run's own, which their figures are drawn
    in.
    """
    elsewhere = {
        case["name"]
        for case in run.manifest["config"]["cases"]
        if _is_elsewhere({**case["set"], **case["set_kinematic"]})
    }
    (trial,) = read_trials(run)
    flights = []
    for flight_id, row in rows_by_id(run).items():
        fidelity = str(row["fidelity"])
        case = flight_id.removesuffix(f"_{fidelity}")
        if pd.isna(row["min_distance_m"]) or case in elsewhere:
            continue
        name = "Simulation 3" if case == "sim3" else case
        view = flight_view(trial, row)
        flights.append(
            FlightContent(
                flight_id=flight_id,
                label=f"{name} · {vehicle_name(run, fidelity)}",
                title=f"{name}: {vehicle_name(run, fidelity)}",
                charts=flight_charts(view),
                scene=flight_scene(trial, row, view.whole) if view else None,
            )
        )
    return FlightPicker(flights=flights)


def _is_elsewhere(values: dict[str, Any]) -> bool:
    """Return whether a case sets anything of the world that the figures of a flight are drawn in."""
    return any(
        key.startswith(("vessel", "plume", "keepout", "guidance.airspeed_mps")) for key in values
    )
