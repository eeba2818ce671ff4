"""The report of the paper's three simulations: each figure on both vehicles, and each published
number beside ours.
"""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
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
from reports.document.chart import Chart, Line, Panel, Style, across
from reports.document.palette import Meaning
from reports.document.parameters import parameter_blocks
from reports.document.ship_map import on_map, ship_lines
from reports.document.tables import Cell, kinematic, rows_table
from reports.flights.single_flight import flight_charts
from reports.flights.tracks import flight_view, track_picture
from reports.paper.flown import VEHICLES, Flown, find_flight, vehicle_name
from reports.paper.statements import (
    SHORT,
    Statement,
    paper_statements,
    paper_verdict,
    rows_by_id,
    vehicles,
)
from reports.replay.flight_scene import flight_scene
from reports.run.columns import Array, column
from reports.run.flight_config import flight_config, is_level, keepout_shape
from reports.run.run_data import RunData
from reports.run.surroundings import surroundings
from reports.run.time_history import keepout_distance
from reports.run.trials import read_trials


def bounds_section(record: dict[str, Any]) -> Section:
    """Return the section on a record of bounds: how tight they are, and what a guarantee costs."""
    return Section(
        anchor="bounds",
        title="Actuation bounds: the largest demand of the law, over all states",
        nav_title="Bounds",
        blocks=[
            Text(_BOUND.format(samples=record["samples"])),
            _tightness_table(record["flown"]),
            Heading("What a guarantee costs"),
            Text(_COST),
            *(
                [Text(_COST_FOR.format(**record["guaranteed_for"]))]
                if record["guaranteed_for"]
                else []
            ),
            _cost_table(record["guaranteed"]),
        ],
    )


_BOUND = (
    "The paper's abstract announces sufficient conditions for the heading rate to stay within its"
    " bound; its text does not print them. docs/actuation_bounds.md derives one. The bound holds"
    " for law (30) in every state, at any distance and on any course; beside it stands the largest"
    " command that was found by a search over {samples:,} states, refined from the worst of them."
)

_COST = (
    "On the reference itself the law demands ω_r plus what h and V/R add, so a reference that"
    " spends all of ω_max, as the paper's Simulation 3 does, leaves no ε, R and h that keep"
    " commands within ω_max. A reserve buys them. The parameters below converge fastest among"
    " those that keep every command within ω_max; the price is a longer look-ahead, hence slower"
    " convergence, and a longer crossing interval. The catalog's Simulation 3 and sweep do not pay"
    " it: their commands are cut at ω_max on the way to the reference. guidance.tuning=bounded"
    " with a guidance.reserve of some tenths flies with the guarantee."
)

_COST_FOR = (
    "For speeds up to {speed_mps:g} m/s, which is the largest commanded airspeed and for an"
    " aircraft a margin, and ω_max = {heading_rate_max_rad_s:g} rad/s; the time is estimated from"
    " {distance_from_m:g} m to {distance_to_m:g} m."
)


def _tightness_table(rows: list[dict[str, Any]]) -> Table:
    cells = [
        Cell("Flights", lambda row: ", ".join(row["flights"]), width=2.2),
        Cell("Parameters", lambda row: _PARAMETERS.get(row["tuning"], "given")),
        Cell("Speed [m/s]", "speed_mps", "{:.2f}", 0.8),
        Cell("ε [1/m]", "epsilon_per_m", "{:.4f}", 0.8),
        Cell("R [m]", "look_ahead_m", "{:.1f}", 0.8),
        Cell("|h| max [rad/s]", "steering_max_rad_s", "{:.3f}", 0.9),
        Cell("|ω_r| max [rad/s]", "reference_heading_rate_max_rad_s", "{:.3f}", 0.9),
        Cell("Bound [rad/s]", "bound_rad_s", "{:.5f}", 0.9),
        Cell("Largest found [rad/s]", "largest_found_rad_s", "{:.5f}"),
        Cell("ω_max [rad/s]", "heading_rate_max_rad_s", "{:.5f}", 0.9),
    ]
    return rows_table(
        rows,
        cells,
        caption="The largest demand of the law: its bound, and the largest that was found.",
        left_columns=2,
    )


_PARAMETERS = {"bounded": "searched"}
"""How the parameters of a flight were found, by its tuning; others are given."""


def _cost_table(rows: list[dict[str, Any]]) -> Table:
    cells = [
        Cell("Reserve [% of ω_max]", lambda row: 100.0 * row["reserve"], "{:g}"),
        Cell("Crossing interval [s]", "crossing_interval_s", "{:.2f}"),
        Cell("ε [1/m]", "epsilon_per_m", "{:.4f}"),
        Cell("R [m]", "look_ahead_m", "{:.0f}"),
        Cell("|h| max [rad/s]", "steering_max_rad_s", "{:.4f}"),
        Cell("Bound [rad/s]", "bound_rad_s", "{:.4f}"),
        Cell("Estimated time to settle [s]", _settling, "{:.0f}"),
    ]
    caption = "What it costs that the demand of the law stays within ω_max."
    return rows_table(rows, cells, caption=caption, left_columns=0)


def _settling(row: dict[str, Any]) -> object:
    return row.get("convergence_time_s") if "bound_rad_s" in row else "no such parameters"


_PHI_GONE = 0.02
"""|phi| below which a coincidence of phi and phi_r counts as one at zero [rad]."""


def sim_1_charts(run: RunData) -> list[Chart]:
    """Return figures 3, 4 and 5: a circular reference, opposite initial headings."""
    return [
        _side_by_side(
            run, ["sim1"], _figure_3, name="fig3", aspect=0.9, panel_height=0.44,
            labels=("East [m]", "North [m]"),
            caption=(
                "To put beside the paper's figure 3: the circular reference and the UAV. Rings:"
                " where each is at the start."
            ),
        ),
        _side_by_side(
            run, ["sim1"], _figure_4, name="fig4", labels=("Time [s]", "Angle [rad]"),
            caption="The paper's figure 4: "
            "φ, course of the UAV against that of z, goes to zero first; then φ_r follows as the"
            " unforced system does.",
        ),
        _side_by_side(
            run, ["sim1"], _figure_5, name="fig5", labels=("Time [s]",
            "Distance to the reference [m]"),
            caption="The paper's figure 5: "
            "while |φ| ≤ |φ_r| the distance does not rise. Where φ_r = φ the rate of V₁ vanishes,"
            " eq. (35): a peak or a trough of the distance while φ is not zero, a saddle point"
            " once it is. The aircraft closes in there too, for it trims its airspeed.",
        ),
    ]  # fmt: skip


def sim_2_charts(run: RunData) -> list[Chart]:
    """Return figures 6 and 7, and the distance, which the paper does not show: line of sight
    against the delta formulation.
    """
    cases = ["sim2_los", "sim2_delta"]
    return [
        _side_by_side(
            run, cases, _figure_6, name="fig6", aspect=1.2, panel_height=0.36, labels=("East [m]",
            "North [m]"),
            caption=(
                "The paper's figure 6: both UAVs start in front of the reference and fly the"
                " other way. UAV 1 steers by the line of sight, UAV 2 by the δ formulation. Rings:"
                " starts."
            ),
        ),
        _side_by_side(
            run, cases, _figure_7, name="fig7", labels=("Time [s]", "Heading-rate demand [rad/s]"),
            caption="The paper's figure 7: "
            "the heading-rate demand of each law. Dashed: ±ω_max. The kinematic UAV 1 flies its"
            " demand, as in the paper; the aircraft's commands are cut at ω_max.",
        ),
        _side_by_side(
            run, cases, _distances, name="sim2distance", labels=("Time [s]",
            "Distance to the reference [m]"),
            caption=(
                "Not in the paper: UAV 1 is near sooner, but at constant speed stays behind the"
                " reference. The aircraft trims its airspeed and catches up, and there its line of"
                " sight swings again and again. UAV 2 gets onto the reference."
            ),
        ),
    ]  # fmt: skip


def sim_3_charts(run: RunData) -> list[Chart]:
    """Return figures 8 and 9, of the smoke plume; none of flights without a vessel."""
    flights = run.summary[run.summary["flight_id"].astype(str).str.startswith("sim3_")]
    if flights["nu"].isna().any():
        return []

    def figure_8(flights: dict[str, Flown]) -> list[Line]:
        flown = flights["sim3"]
        times = run.crossings_of(str(flown.row["flight_id"]))["time_s"].to_numpy(dtype=np.float64)
        times = times[times <= flown.time[-1]]
        east, north = (
            np.interp(times, flown.time, flown.column(name)) for name in ("east_m", "north_m")
        )
        about = surroundings(flight_config(run, flown.row), flown.row, flown.history)
        place = (float(flown.column(name)[-1]) for name in ("vessel_east_m", "vessel_north_m"))
        return [
            *ship_lines(about, 0.0, *place),
            _path(flown, "vessel_", "ship's track", Meaning.SHIP, "thin"),
            _path(flown, "", "flown"),
            _path(flown, "reference_", "reference", Meaning.COMMANDED, "thin"),
            _crossings(east, north),
        ]

    def figure_9(flights: dict[str, Flown]) -> list[Line]:
        flown = flights["sim3"]
        crossings = run.crossings_of(str(flown.row["flight_id"]))
        config = flight_config(run, flown.row)
        times, distance = (
            crossings["time_s"].to_numpy(dtype=np.float64),
            keepout_distance(flown.history, config),
        )
        crossed = column(
            crossings,
            "horizontal_distance_m" if is_level(keepout_shape(config)) else "distance_m",
        )
        return [
            across(flown.time[[0, -1]], float(flown.row["keepout_radius_m"]), "r_min"),
            Line(x=flown.time, y=distance, label="flown", colour=Meaning.FLOWN),
            _crossings(times, crossed),
        ]

    return [
        _side_by_side(
            run, ["sim3"], figure_8, name="fig8", aspect=4.6, labels=("East [m]", "North [m]"),
            shown_after=100.0, columns=1,
            panel_height=0.2,
            caption=(
                "The paper's figure 8: over the ground. The UAV starts at a random place behind"
                " the ship. Diamonds: plume crossings after settling. The tracks end a hundred"
                " seconds after settling, with ship, plume and keep-out area as they are then."
            ),
        ),
        _side_by_side(
            run, ["sim3"], figure_9, name="fig9", labels=("Time [s]", "Distance to the vessel [m]"),
            shown_after=math.inf,
            caption="The paper's figure 9: "
            "distance between the vessel, at its stack, and the UAV; dashed the radius of the"
            " keep-out area.",
        ),
    ]  # fmt: skip


def coincidences(flown: Flown) -> Array:
    """Return the times at which phi_r = phi [s], linear between samples. Jumps by a turn do not
    count.
    """
    gap = flown.column("phi_r_rad") - flown.column("phi_rad")
    at = np.nonzero((gap[:-1] * gap[1:] < 0.0) & (np.abs(np.diff(gap)) < math.pi))[0]
    fraction = gap[at] / (gap[at] - gap[at + 1])
    return flown.time[at] + fraction * (flown.time[at + 1] - flown.time[at])


Lines = Callable[[dict[str, Flown]], list[Line]]


def _side_by_side(
    run: RunData,
    cases: list[str],
    lines: Lines,
    *,
    name: str,
    caption: str,
    labels: tuple[str, str],
    aspect: float = 0.0,
    shown_after: float = 20.0,
    columns: int = 2,
    panel_height: float = 0.27,
) -> Chart:
    """Return a panel for each vehicle that has flown every case, up to ``shown_after`` [s] after
    the last of them has settled.

    With an ``aspect``, width over height, they are maps.
    """
    found = {
        fidelity: {case: find_flight(run, f"{case}_{fidelity}") for case in cases}
        for fidelity in VEHICLES
    }
    pairs = {
        fidelity: {c: f for c, f in flights.items() if f is not None}
        for fidelity, flights in found.items()
    }
    pairs = {fidelity: flights for fidelity, flights in pairs.items() if len(flights) == len(cases)}
    settled = [
        float(f.row["settling_time_s"]) for flights in pairs.values() for f in flights.values()
    ]
    until = max((time for time in settled if not math.isnan(time)), default=math.inf) + shown_after
    drawn = {
        vehicle_name(run, key): lines({c: flown.until(until) for c, flown in flights.items()})
        for key, flights in pairs.items()
    }
    every = [line for curves in drawn.values() for line in curves]
    panels = [
        Panel(
            x_label=labels[0], y_label=labels[1], title=title[0].upper() + title[1:], lines=curves
        )
        for title, curves in drawn.items()
    ]
    if aspect:
        panels = [on_map(panel, north=0.0, shown=every, aspect=aspect) for panel in panels]
    elif drawn:
        x_range, y_range = _common_ranges(every)
        panels = [replace(panel, x_range=x_range, y_range=y_range) for panel in panels]
    return Chart(
        name=name, caption=caption, panels=panels, columns=columns, panel_height=panel_height
    )


def _common_ranges(lines: list[Line]) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return ranges that hold every curve, so that panels side by side compare at a glance."""
    x, y = (
        np.concatenate(curves) for curves in zip(*((line.x, line.y) for line in lines), strict=True)
    )
    across, up = 0.02 * float(np.ptp(x)), 0.05 * float(np.ptp(y))
    return (float(np.min(x)) - across, float(np.max(x)) + across), (
        float(np.min(y)) - up,
        float(np.max(y)) + up,
    )


def _figure_3(flights: dict[str, Flown]) -> list[Line]:
    flown = flights["sim1"]
    return [_path(flown, "", "flown"), _reference(flown), _starts([flown])]


def _figure_4(flights: dict[str, Flown]) -> list[Line]:
    flown = flights["sim1"]
    return [
        Line(x=flown.time, y=flown.column("phi_rad"), label="φ", colour=Meaning.FLOWN),
        Line(x=flown.time, y=flown.column("phi_r_rad"), label="φ_r", colour=Meaning.COMMANDED),
        *_coincidence_marks(flown, flown.column("phi_r_rad")),
    ]


def _figure_5(flights: dict[str, Flown]) -> list[Line]:
    flown = flights["sim1"]
    return [
        Line(x=flown.time, y=flown.distance, label="distance d", colour=Meaning.FLOWN),
        *_coincidence_marks(flown, flown.distance),
    ]


def _coincidence_marks(flown: Flown, curve: Array) -> list[Line]:
    """Return marks on a curve over time where phi_r = phi: saddle points of the distance apart from
    its peaks and troughs.
    """
    times = coincidences(flown)
    saddle = np.abs(np.interp(times, flown.time, flown.column("phi_rad"))) < _PHI_GONE
    marks = (
        (saddle, "φ_r = φ = 0, a saddle point of d", "plum"),
        (~saddle, "φ_r = φ ≠ 0, a peak or trough of d", "black"),
    )
    return [
        Line(
            x=times[which],
            y=np.interp(times[which], flown.time, curve),
            label=label,
            colour=colour,
            style="diamonds",
        )
        for which, label, colour in marks
        if which.any()
    ]


_UAVS = {
    "sim2_los": ("UAV 1, line of sight", "plum"),
    "sim2_delta": ("UAV 2, δ formulation", Meaning.FLOWN),
}


def _figure_6(flights: dict[str, Flown]) -> list[Line]:
    first = next(iter(flights.values()))
    tracks = [_path(flown, "", *_UAVS[case]) for case, flown in flights.items()]
    return [*tracks, _reference(first), _starts(list(flights.values()))]


def _figure_7(flights: dict[str, Flown]) -> list[Line]:
    commands = [
        Line(
            x=flown.time,
            y=flown.column("heading_rate_demand_rad_s"),
            label=_UAVS[case][0],
            colour=_UAVS[case][1],
        )
        for case, flown in flights.items()
    ]
    first = next(iter(flights.values()))
    limit = float(first.row["heading_rate_limit_rad_s"])
    return [*commands, *(across(first.time[[0, -1]], value, "±ω_max") for value in (limit, -limit))]


def _distances(flights: dict[str, Flown]) -> list[Line]:
    return [
        Line(x=flown.time, y=flown.distance, label=_UAVS[case][0], colour=_UAVS[case][1])
        for case, flown in flights.items()
    ]


def _path(
    flown: Flown, prefix: str, label: str, colour: str = Meaning.FLOWN, style: Style = "solid"
) -> Line:
    """Return where the UAV, or what a prefix names, went over the ground."""
    return Line(
        x=flown.column(f"{prefix}east_m"),
        y=flown.column(f"{prefix}north_m"),
        label=label,
        colour=colour,
        style=style,
    )


def _reference(flown: Flown) -> Line:
    """Return the circle of the reference, to be drawn over the tracks that come to lie on it."""
    return _path(flown, "reference_", "reference", Meaning.COMMANDED, "dash")


def _starts(flights: list[Flown]) -> Line:
    places = [
        (float(flown.column(east)[0]), float(flown.column(north)[0]))
        for flown in flights
        for east, north in (("east_m", "north_m"), ("reference_east_m", "reference_north_m"))
    ]
    x, y = np.array(places).T
    return Line(x=x, y=y, label="start", colour=Meaning.SHIP, style="ring")


def _crossings(x: Array, y: Array) -> Line:
    return Line(x=x, y=y, label="plume crossing", colour=Meaning.CROSSING, style="diamonds")


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
                # Simulation 3 has other figures.
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
