"""The report of the paper's three simulations: each figure on both vehicles, and each published
number beside ours.
"""

import json
from collections.abc import Callable
from typing import Any

import pandas as pd

from common.run_layout import BOUNDS
from reports.design.section import design_words
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
from reports.document.parameters import parameter_blocks
from reports.document.tables import (
    Cell,
    kinematic,
    rows_table,
)
from reports.flights.flight_view import flight_view
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import track_picture
from reports.paper.bounds import bounds_section
from reports.paper.charts import sim_1_charts, sim_2_charts, sim_3_charts
from reports.paper.flown import VEHICLES, vehicle_name
from reports.paper.statements import (
    SHORT,
    Statement,
    paper_statements,
    paper_verdict,
    rows_by_id,
    vehicles,
)
from reports.replay.flight_scene import flight_scene
from reports.run.run_data import RunData
from reports.run.trials import read_trials


def paper_content(run: RunData) -> Findings:
    """Return the findings of the paper's simulations."""
    sections = [
        Section(
            anchor="numbers",
            title="The paper's numbers, and ours",
            nav_title="Numbers",
            blocks=[
                Text(_NUMBERS),
                statement_table(run),
            ],
        ),
        *_simulations(run),
        *_bounds(run),
        _detail(_flights(run)),
        Section(
            anchor="parameters",
            title="Parameters",
            blocks=[
                Heading("What each simulation sets"),
                _case_table(run),
                *parameter_blocks(run),
                *design_words(run),
            ],
        ),
    ]
    return Findings(
        flown=_flown(run), verdict=paper_verdict(run), picture=_picture(run), sections=sections
    )


def _simulations(run: RunData) -> list[Section]:
    """Return a section for each simulation that has a figure."""
    shown = (
        (i, title, text, [chart for chart in figures(run) if chart.panels])
        for i, (title, text, figures) in enumerate(_SIMULATIONS, start=1)
    )
    return [
        Section(
            anchor=f"sim{i}",
            title=f"Simulation {i}: {title}",
            nav_title=f"Sim. {i}",
            blocks=[Text(text), *charts],
        )
        for i, title, text, charts in shown
        if charts
    ]


def _bounds(run: RunData) -> list[Section]:
    path = run.path / BOUNDS
    return [bounds_section(json.loads(path.read_text(encoding="utf-8")))] if path.is_file() else []


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
    "The same guidance steers both vehicles, from the same starts. The kinematic vehicle keeps"
    " its speed, as in the paper; the aircraft is flown as everywhere in this study, its airspeed"
    " trimmed by the along-track error. The paper prints neither gains nor starts: what can be"
    " compared are the numbers and statements of its section V."
)

_SIM_ONE = (
    "The UAV starts beside the reference and heads the other way. Look-ahead and steering are"
    " those that converge fastest while the heading-rate demand of the law stays within ω_max in"
    " every state (see the section on actuation bounds). That is why it turns so gently, and"
    " strays hundreds of metres before it comes back: the price of the guarantee."
)

_SIM_TWO = (
    "Both UAVs start in front of the reference and fly towards it. Passing it, the line of sight"
    " turns arbitrarily fast: there is the singularity that the δ formulation takes away. The"
    " paper has UAV 1 converge fast onto the reference. That is not reproduced: with our gain it"
    " is near within seconds, but at constant speed stays behind for good."
)

_SIM_THREE = (
    "A vessel on a straight course, the UAV from a random place behind it. In the paper the"
    " vessel has half the UAV's speed, and the reference spends all of ω_max; then no parameters"
    " keep the demand of the law within it, and commands are cut at ω_max."
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


def statement_table(run: RunData) -> Table:
    """Return what section V of the paper says, and what each vehicle showed."""
    cells = [
        Cell("", lambda of: of.simulation, width=0.6),
        Cell("What section V says", lambda of: of.words, width=2.6),
        Cell("Printed", lambda of: of.printed, width=1.2),
        *(Cell(SHORT[vehicle].capitalize(), _shown_by(vehicle)) for vehicle in vehicles(run)),
        Cell("", lambda of: of.card.result, width=1.0),
    ]
    return rows_table(
        paper_statements(run),
        cells,
        caption="What section V of the paper prints, and what each vehicle showed.",
        left_columns=2,
    )


def _shown_by(vehicle: str) -> Callable[[Statement], str]:
    return lambda statement: statement.values[vehicle]


def _case_table(run: RunData) -> Table:
    def words(values: dict[str, Any]) -> str:
        return ", ".join(f"{key} = {json.dumps(value)}" for key, value in values.items())

    cells = [
        Cell("Simulation", "name", width=0.9),
        Cell("Both vehicles", lambda case: words(case["set"]), width=3.4),
        Cell("Kinematic vehicle besides", lambda case: words(case["set_kinematic"]), width=1.8),
    ]
    cases = run.manifest["config"]["cases"]
    return rows_table(cases, cells, left_columns=3, prose=True, breakable=True)


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
                # Simulation 3 has figures of its own.
                printed=False,
                scene=flight_scene(trial, row, view.whole) if view else None,
            )
        )
    return FlightPicker(flights=flights)


def _is_elsewhere(values: dict[str, Any]) -> bool:
    """Return whether a case sets the world that the figures of a flight are drawn in."""
    return any(
        key.startswith(("vessel", "plume", "keepout", "guidance.airspeed_mps")) for key in values
    )
