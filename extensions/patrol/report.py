"""The report of patrols: how many ships were served, with what verdicts, when, and what an oracle
would have done.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from common.physics import wind_towards
from common.verdict import MET
from extensions.patrol import PHASES, SHIPS
from extensions.patrol.counts import PatrolCounts
from measurement.gases import MASS_PERCENT
from reports.design.section import innerloop_section
from reports.document.axes import in_kilometres
from reports.document.blocks import Card, Findings, Heading, Section, Table, Text, Verdict
from reports.document.chart import Chart, Line, Note, Panel, Style
from reports.document.map_marks import on_map
from reports.document.palette import Meaning
from reports.document.tables import number, parameter_blocks, vehicle_flown
from reports.flights.parameter_tables import distribution
from reports.run.columns import column, least
from reports.run.run_data import RunData
from reports.run.table_file import read_table

_SHOWN = 12
"""Patrols of which map and ships are shown."""

_ORACLE = (
    "The oracle knows how long each ship takes: as long as a flight beside it that knows where"
    " its plume is, or as the patrol's own where that took less. It orders the ships for the most"
    " verdicts within the endurance, and then for the earliest end, as the patrol does: of few"
    " ships it tries all orders, of many it finds a good one by insertion. It never goes round a"
    " ship."
)

_PHASES = {
    "transit": "blue",
    "approach": "orange",
    "searching": "sky",
    "measuring": "green",
    "leaving": "grey",
}
"""What the UAV does, in its order, and the colour of it."""

_SHIP_STYLES: dict[bool, Style] = {True: "dots", False: "cross"}
"""Marks of ships that were served, and of others."""

_MINUTE = 60.0

_EDGE, _ABOVE = 0.7, 0.03
"""Room beyond the first and the last row of a time line, in rows; how far above a ship its number
stands, over the map's height.
"""


class _Column(NamedTuple):
    """A column of a table: its head, the name or the function of its value, the pattern of a number
    and its relative width in print.
    """

    head: str
    value: str | Callable[[Any], object]
    pattern: str
    width: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Patrol:
    """A patrol: its name, its row of the summary, and its ships and phases, which are empty where
    it failed.
    """

    name: str
    row: "pd.Series[Any]"
    ships: pd.DataFrame
    phases: pd.DataFrame

    def track(self, ship: "pd.Series[Any]") -> tuple[Any, Any]:
        """Return north and east of a ship at the start, and when it was measured or the patrol
        ended, shape (2,) each [m].
        """
        ends = float(
            ship["ended_s"]
            if pd.notna(ship["ended_s"])
            else np.max(column(self.phases, "ends_s"), initial=0.0)
        )
        course, way = (
            math.radians(float(ship["vessel_course_deg"])),
            float(ship["vessel_speed_mps"]) * np.array([0.0, ends]),
        )
        return float(ship["north_m"]) + way * math.cos(course), float(
            ship["east_m"]
        ) + way * math.sin(course)


def read_patrols(run: RunData) -> list[Patrol]:
    """Return the patrols of a run."""
    ships, phases = (
        read_table(run.path / name, run.columns.get(name), empty=("patrol",))
        for name in (SHIPS, PHASES)
    )
    return [
        Patrol(
            name=str(row["flight_id"]),
            row=row,
            ships=ships[ships["patrol"] == row["flight_id"]],
            phases=phases[phases["patrol"] == row["flight_id"]],
        )
        for _, row in run.summary.iterrows()
    ]


def counts_of(run: RunData) -> PatrolCounts:
    """Return the sums over the patrols of a run, and how they are judged."""
    limits = {
        name: float(run.manifest["config"]["patrol"][name])
        for name in ("oracle_share_min", "wrong_share_max")
    }
    return PatrolCounts.of(
        run.summary.to_dict("records"), planned=int(run.manifest["flights_planned"]), **limits
    )


def patrol_content(run: RunData) -> Findings:
    """Return the findings of patrols."""
    patrols, counts = read_patrols(run), counts_of(run)
    flown = [(i, patrol) for i, patrol in enumerate(patrols) if len(patrol.phases)]
    charts = [patrol_chart(patrol) for _, patrol in flown[:_SHOWN]]
    shown = [
        (Heading(f"Patrol {i}"), chart, ship_table(patrol, i))
        for (i, patrol), chart in zip(flown, charts, strict=False)
    ]
    lines = [time_lines(patrols)] if len(flown) > 1 else []
    sampled = {
        draw["key"]: distribution(draw, "patrol")
        for draw in run.manifest["config"].get("draws", [])
    }
    served = f"{counts.served} of {counts.ships} ships were served"
    return Findings(
        flown=f"{len(patrols)} patrol{'s' * (len(patrols) != 1)} of {vehicle_flown(run)},"
        f" {counts.hours:.1f} h in all: {served}.",
        verdict=Verdict(
            holds=counts.holds,
            complete=counts.met and run.verdict.exit_status == MET,
            headline=_headline(counts),
            detail=f"{served} in {counts.hours:.1f} h, {counts.per_hour:.1f} an hour;"
            f" {counts.violations} keep-out violation{'s' * (counts.violations != 1)}.",
            failures=[
                f"{row['flight_id']}: {row['message']}"
                for _, row in run.summary.iterrows()
                if row["message"]
            ],
            figures=_figures(run, counts),
        ),
        picture=charts[0] if charts else None,
        sections=[
            Section(
                anchor="patrols",
                title="Patrols and the oracle",
                nav_title="Patrols",
                blocks=[Text(_ORACLE), oracle_table(patrols), *lines],
            ),
            Section(
                anchor="ships",
                title="Ships",
                blocks=[block for blocks in shown for block in blocks],
            ),
            *([innerloop_section(run.innerloop)] if run.innerloop else []),
            Section(anchor="parameters", title="Parameters", blocks=parameter_blocks(run, sampled)),
        ],
    )


def _figures(run: RunData, counts: PatrolCounts) -> list[Card]:
    """Return what the verdict rests on. What nothing was flown or judged for has no criterion:
    nothing would meet it.
    """
    served, verdicts, oracle = counts.served, counts.verdicts, counts.oracle
    enough, right = (
        f"≥ {100.0 * counts.oracle_share_min:g} %",
        f"≤ {100.0 * counts.wrong_share_max:g} %",
    )
    through = ("all", counts.through == counts.done) if served else ()
    return [
        Card(
            "Correct verdicts, over the oracle's",
            f"{counts.correct} of {oracle}",
            *((enough, counts.enough) if oracle else ()),
        ),
        Card(
            "Wrong verdicts",
            f"{counts.wrong} of {verdicts}",
            *((right, counts.right) if verdicts else ()),
        ),
        Card(
            "Keep-out violations", f"{counts.violations}", "0", served > 0 and not counts.violations
        ),
        Card("Ships served", f"{served} of {counts.ships}", "≥ 1", served > 0),
        _closest(run, "a ship that was served", "min_distance_m"),
        _closest(run, "any other ship", "others_distance_min_m"),
        Card("Ships served an hour", f"{counts.per_hour:.1f}"),
        Card("Flights beside ships without a verdict", f"{counts.open}"),
        Card(
            "Patrols that kept out, with their aircraft",
            f"{counts.through} of {counts.done}",
            *through,
        ),
    ]


def _headline(counts: PatrolCounts) -> str:
    """Return how many verdicts there are, beside the oracle's."""
    correct, oracle = counts.correct, counts.oracle
    if not counts.served:
        return (
            f"No ship was served, and an oracle has {oracle or 'no'} correct"
            f" verdict{'s' * (oracle > 1)}"
        )
    share = f"{100.0 * correct / oracle:.0f} % of an oracle's" if oracle else "an oracle has none"
    return f"{correct} correct verdict{'s' * (correct != 1)}, {share}, {counts.wrong} wrong"


def _closest(run: RunData, ship: str, figure: str) -> Card:
    """Return how near any ship came, with the keep-out radius, which holds for one that was not
    served just then, too.
    """
    name, nearest = f"Closest approach to {ship}", least(column(run.summary, figure))
    if nearest is None:
        return Card(name, "–")
    radius = float(run.manifest["config"]["keepout"]["radius_m"])
    # Rounded down: none is shown larger than it was.
    return Card(
        name, f"{math.floor(10.0 * nearest) / 10.0:.1f} m", f"≥ {radius:g} m", nearest >= radius
    )


def oracle_table(patrols: Sequence[Patrol]) -> Table:
    """Return what each patrol achieved, beside the oracle."""
    columns = [
        _Column("Patrol", "number", "{}", 0.7),
        _Column("Ships", "ships", "{:.0f}", 0.6),
        _Column("Served", "served", "{:.0f}", 0.7),
        _Column("Correct", "correct", "{:.0f}", 0.7),
        _Column("Wrong", "wrong", "{:.0f}", 0.7),
        _Column("Open", "open", "{:.0f}", 0.6),
        _Column("Oracle's", "oracle_verdicts", "{:.0f}", 0.8),
        _Column("Served an hour", "served_per_hour", "{:.1f}", 0.8),
        _Column(
            "Duration [min]", lambda row: row.get("duration_s", math.nan) / _MINUTE, "{:.0f}", 0.8
        ),
        _Column(
            "In transit [%]",
            lambda row: (
                100.0 * row["transit_s"] / row["duration_s"] if row.get("duration_s") else None
            ),
            "{:.0f}",
            0.8,
        ),
        _Column("Wind [m/s]", "wind_speed_mps", "{:.1f}", 0.7),
        _Column("Served ship [m]", "min_distance_m", "{:.0f}", 0.8),
        _Column("Other ships [m]", "others_distance_min_m", "{:.0f}", 0.8),
        _Column("Keep-out violations", "keepout_violations", "{:.0f}", 0.9),
    ]
    caption = (
        "Each patrol, and the verdicts of an oracle that knows every plume and how long each ship"
        " takes. Distances are the least to the ship that was served, and to any other. Patrols"
        " are counted from 0, as in the names of flights."
    )
    rows = [{**patrol.row, "number": str(i)} for i, patrol in enumerate(patrols)]
    return _table(rows, columns, caption=caption)


def ship_table(patrol: Patrol, index: int) -> Table:
    """Return the verdict on each ship of a patrol, by its number, and when it came."""
    columns = [
        _Column("Ship", lambda ship: str(ship["ship"]), "", 0.5),
        _Column("Speed [m/s]", "vessel_speed_mps", "{:.1f}", 0.7),
        _Column("ν", "nu", "{:.2f}", 0.6),
        _Column("Stack [m]", "plume_source_height_m", "{:.0f}", 0.6),
        _Column(f"Sulphur, true [{MASS_PERCENT}]", "fsc_fuel_percent", "{:.2f}", 0.8),
        _Column(f"measured [{MASS_PERCENT}]", "fsc_percent", "{:.3f}", 0.8),
        _Column("Verdict", _verdict, "", 1.5),
        _Column("Reached [min]", lambda ship: ship["reached_s"] / _MINUTE, "{:.0f}", 0.8),
        _Column("Time to find [s]", "time_to_find_s", "{:.0f}", 0.8),
        _Column("Beside it [s]", lambda ship: ship["ended_s"] - ship["reached_s"], "{:.0f}", 0.8),
        _Column("known axis [s]", "known_axis_service_s", "{:.0f}", 0.7),
        _Column("Turn", "position", "{:.0f}", 0.5),
        _Column("Oracle's turn", "oracle_position", "{:.0f}", 0.7),
    ]
    caption = (
        f"Ships of patrol {index}: verdicts, and when they came. Ships, and their turns in the"
        " order, are counted from 0."
    )
    ships = patrol.ships.to_dict("records")
    return _table(ships, columns, caption=caption)


def _table(rows: Iterable[Mapping[Any, Any]], columns: Sequence[_Column], *, caption: str) -> Table:
    """Return a table of rows: text as it is, a dash for what is missing."""

    def cell(row: Mapping[Any, Any], column: _Column) -> str:
        of = column.value
        found = of(row) if callable(of) else row.get(of)
        return found if isinstance(found, str) else number(found, column.pattern)

    return Table(
        caption=caption,
        head=[column.head for column in columns],
        rows=[[cell(row, column) for column in columns] for row in rows],
        widths=[column.width for column in columns],
        print_size_pt=6.4,
        breakable=True,
    )


def _verdict(ship: Mapping[Any, Any]) -> str:
    if pd.isna(ship["position"]):
        return "not served"
    if ship["verdict"] == "open":
        return "open"
    return f"{ship['verdict']}: {'correct' if ship['verdict'] == ship['truth'] else 'wrong'}"


def patrol_chart(patrol: Patrol) -> Chart:
    """Return the map of a patrol, and what was done beside which ship when."""
    count, done = len(patrol.ships), patrol.ships[patrol.ships["oracle_ended_s"].notna()]
    x, y = column(done, "oracle_ended_s") / _MINUTE, count - column(done, "ship")
    oracle = Line(x=x, y=y, label="done by the oracle", colour=Meaning.SHIP, style="diamonds")
    stretches = patrol.phases.assign(row=count - patrol.phases["ship"])
    times = _time_panel(
        stretches,
        count,
        [oracle],
        x_label="Time since the start [min]",
        y_label="Ship",
        title="Time line",
    )
    return Chart(
        name=patrol.name,
        caption="Map: where ships went, numbered where they began and until they were measured,"
        " and the UAV, which began at the ring. Time line: what it did beside or on the way to"
        " which ship. A diamond is when an oracle would be done with it.",
        panels=[in_kilometres(_map(patrol)), times],
        columns=2,
        panel_height=0.5,
    )


def time_lines(patrols: Sequence[Patrol]) -> Chart:
    """Return the time lines of all patrols, a row each."""
    count = len(patrols)
    stretches = pd.concat([patrol.phases.assign(row=count - i) for i, patrol in enumerate(patrols)])
    panel = _time_panel(
        stretches, count, [], x_label="Time since the start of the patrol [min]", y_label="Patrol"
    )
    caption = "What the UAV did when, a row for each patrol."
    return Chart(
        name="time_lines", caption=caption, panels=[panel], panel_height=0.12 + 0.035 * count
    )


def _map(patrol: Patrol) -> Panel:
    ships, starts = [], []
    for _, ship in patrol.ships.iterrows():
        north, east = patrol.track(ship)
        served = pd.notna(ship["position"])
        label, style = "" if served else "not served", _SHIP_STYLES[served]
        ships.append(Line(x=east, y=north, label="ship", colour=Meaning.SHIP, style="thin"))
        starts.append(Line(x=east[:1], y=north[:1], label=label, colour=Meaning.SHIP, style=style))
    flown = [Line(x=np.zeros(1), y=np.zeros(1), label="start", colour=Meaning.FLOWN, style="ring")]
    for _, leg in patrol.phases.iterrows():
        x, y = (
            np.array([leg[f"from_{axis}_m"], leg[f"to_{axis}_m"]], dtype=np.float64)
            for axis in ("east", "north")
        )
        flown.append(Line(x=x, y=y, label="flown", colour=Meaning.FLOWN))
    measured = patrol.phases[patrol.phases["phase"] == "measuring"]
    x, y = column(measured, "to_east_m"), column(measured, "to_north_m")
    # Ships that are not served may go far beyond the page.
    shown = [
        *starts,
        *flown,
        Line(x=x, y=y, label="measured", colour=Meaning.CROSSING, style="square"),
    ]
    room = _ABOVE * float(np.ptp(np.concatenate([line.y for line in shown])))
    notes = [
        Note(x=float(line.x[0]), y=float(line.y[0]) + room, text=str(number))
        for number, line in zip(patrol.ships["ship"], starts, strict=True)
    ]
    panel = Panel(
        x_label="East [m]", y_label="North [m]", title="Map", lines=[*ships, *shown], notes=notes
    )
    wind = float(patrol.row["wind_speed_mps"]), wind_towards(float(patrol.row["wind_from_deg"]))
    return on_map(panel, north=0.0, wind=wind, shown=shown)


def _time_panel(stretches: pd.DataFrame, count: int, marks: list[Line], **labels: str) -> Panel:
    """Return bars over time, one for each stretch at its ``row``: one curve a phase, with gaps."""
    lines = []
    for phase, colour in _PHASES.items():
        rows = stretches[stretches["phase"] == phase].assign(gap=np.nan)
        time, row = (
            rows[names].to_numpy(np.float64).ravel()
            for names in (["begins_s", "ends_s", "gap"], ["row", "row", "gap"])
        )
        lines.append(Line(x=time / _MINUTE, y=row, label=phase, colour=colour, style="broad"))
    names = [(float(count - i), str(i)) for i in range(count)]
    shown: Any = labels
    return Panel(
        lines=[*lines, *marks], y_range=(1.0 - _EDGE, count + _EDGE), y_names=names, **shown
    )
