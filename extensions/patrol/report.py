"""The report of patrols: the number of ships served, the verdicts and their times, and the results
of an oracle.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from common.physics import wind_towards
from common.verdict import MET
from extensions.patrol import PHASES, SHIPS
from extensions.patrol.counts import PatrolCounts
from measurement.gases import MASS_PERCENT
from reports.design.section import design_words
from reports.document.axes import in_kilometres
from reports.document.blocks import Card, Findings, Fold, Heading, Section, Table, Text, Verdict
from reports.document.chart import Chart, Line, Note, Panel, Style
from reports.document.palette import Meaning
from reports.document.parameters import distribution, parameter_blocks
from reports.document.ship_map import on_map
from reports.document.state import state_words
from reports.document.tables import Cell, approach, rows_table, vehicle_flown
from reports.run.columns import column, least
from reports.run.run_data import RunData, read_table

_FOLDED = 11
"""Patrols whose map and ships the screen shows, beside the one that is printed."""

_ORACLE = (
    "The oracle knows how long each ship takes: as long as a flight beside it that knows where the"
    " plume is, or as the patrol's flight where that was shorter. It orders the ships as the patrol"
    " does, for the most verdicts within the endurance and then for the earliest end. Up to 8 ships"
    " it tries every order; of more it builds one by insertion. It never goes round a ship."
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Patrol:
    """A patrol: its number and name, its row of the summary, and its ships and phases, which are
    empty where it failed.
    """

    number: int
    name: str
    row: "pd.Series[Any]"
    ships: pd.DataFrame
    phases: pd.DataFrame

    @property
    def title(self) -> str:
        """Name in the report."""
        return f"Patrol {self.number}"

    def track(self, ship: "pd.Series[Any]") -> tuple[Any, Any]:
        """Return north and east of a ship at two times, shape (2,) each [m]: at the start, and when
        it was measured or the patrol ended.
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
            number=number,
            name=str(row["flight_id"]),
            row=row,
            ships=ships[ships["patrol"] == row["flight_id"]],
            phases=phases[phases["patrol"] == row["flight_id"]],
        )
        for number, (_, row) in enumerate(run.summary.iterrows())
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
    flown = sorted((patrol for patrol in patrols if len(patrol.phases)), key=_matters)
    first, others = flown[:1], sorted(flown[1:], key=lambda patrol: patrol.number)[:_FOLDED]
    folded = [
        block
        for patrol in others
        for block in (Heading(patrol.title), patrol_chart(patrol), ship_table(patrol))
    ]
    sampled = {
        draw["key"]: distribution(draw, "patrol")
        for draw in run.manifest["config"].get("draws", [])
    }
    patrol_words = "1 patrol" if len(patrols) == 1 else f"{len(patrols)} patrols"
    return Findings(
        flown=_FLOWN.format(
            patrols=patrol_words,
            vehicle=vehicle_flown(run),
            hours=counts.hours,
            served=counts.served,
            ships=counts.ships,
        ),
        verdict=Verdict(
            holds=counts.holds,
            complete=counts.met and run.verdict.exit_status == MET,
            headline=_headline(run, counts),
            detail=_DETAIL,
            failures=[
                f"{row['flight_id']}: {row['message']}"
                for _, row in run.summary.iterrows()
                if row["message"]
            ],
            figures=_figures(run, counts),
        ),
        picture=patrol_chart(first[0]) if first else None,
        sections=[
            Section(
                anchor="patrols",
                title="Patrols and the oracle",
                nav_title="Patrols",
                blocks=[Text(_ORACLE), oracle_table(patrols)],
            ),
            Section(
                anchor="ships",
                title="Ships",
                blocks=[
                    *map(ship_table, first),
                    *([Fold(title="The other patrols", blocks=folded)] if folded else []),
                ],
            ),
            Section(
                anchor="parameters",
                title="Parameters",
                blocks=[*parameter_blocks(run, sampled), *design_words(run)],
            ),
        ],
    )


_FLOWN = "{patrols} of {vehicle}, {hours:.1f} h in all: {served} of {ships} ships were served."

_DETAIL = (
    "The oracle knows every plume and how long each ship takes. A verdict is right where it agrees"
    " with the fuel."
)


def _matters(patrol: Patrol) -> tuple[bool, float, float, float]:
    """Return the sort key of a patrol: first events that must not happen, then wrong and open
    verdicts, and then the closest approach.
    """
    row = patrol.row
    nearest = row[["min_distance_m", "others_distance_min_m"]].min()
    return (bool(row["criteria_met"]), -row["wrong"], -row["open"], nearest)


_ANSWER = (
    "{per_hour:.1f} ships served per hour; verdicts: {correct} right, {wrong} wrong, {open} open,"
    " of the {oracle} that an oracle reaches"
)
_NONE_SERVED = "No ship was served; an oracle reaches {oracle} right verdicts"


def _headline(run: RunData, counts: PatrolCounts) -> str:
    """Return the state, how many ships were served in an hour, and the verdicts."""
    state = state_words(
        "patrols",
        counts.done,
        counts.planned,
        is_done=run.verdict.is_done,
        interrupted=run.verdict.interrupted,
    )
    answer = _ANSWER if counts.served else _NONE_SERVED
    words = answer.format(
        per_hour=counts.per_hour,
        correct=counts.correct,
        wrong=counts.wrong,
        open=counts.open,
        oracle=counts.oracle,
    )
    if counts.violations:
        state.append(f"{counts.violations} keep-out violations")
    return ". ".join([*state, words])


def _figures(run: RunData, counts: PatrolCounts) -> list[Card]:
    """Return the criteria on which the verdict rests. If nothing was flown or judged for a
    criterion, it is left out: nothing would meet it.
    """
    enough = f"≥ {100.0 * counts.oracle_share_min:g} % of the oracle's {counts.oracle}"
    right = f"≤ {100.0 * counts.wrong_share_max:g} % of {counts.verdicts}"
    kept_out = counts.served > 0 and not counts.violations
    lost = [Card("Aircraft lost", f"{gone}", "0", met=False)] if (gone := _lost(run)) else []
    return [
        Card("Ships served per hour", f"{counts.per_hour:.1f}", "> 0", counts.served > 0),
        Card(
            "Right verdicts",
            f"{counts.correct}",
            *((enough, counts.enough) if counts.oracle else ()),
        ),
        Card(
            "Wrong verdicts", f"{counts.wrong}", *((right, counts.right) if counts.verdicts else ())
        ),
        *lost,
        Card("Keep-out violations", f"{counts.violations}", "0", kept_out),
        _closest(run, "a ship that was served", "min_distance_m"),
        _closest(run, "any other ship", "others_distance_min_m"),
    ]


def _lost(run: RunData) -> int:
    lost = run.summary.get("aircraft_lost")
    return 0 if lost is None else int(lost.fillna(value=False).astype(bool).sum())


def _closest(run: RunData, ship: str, figure: str) -> Card:
    """Return the closest approach to any ship, with the keep-out radius, which also holds for ships
    that were not served at that time.
    """
    name, nearest = f"Closest approach to {ship}", least(column(run.summary, figure))
    if nearest is None:
        return Card(name, "–")
    radius = float(run.manifest["config"]["keepout"]["radius_m"])
    return Card(name, f"{approach(nearest, radius)} m", f"≥ {radius:g} m", nearest >= radius)


def oracle_table(patrols: Sequence[Patrol]) -> Table:
    """Return the results of each patrol, compared with the oracle."""
    cells = [
        Cell("Patrol", "number", "{:.0f}", 0.7),
        Cell("Ships", "ships", "{:.0f}", 0.6),
        Cell("Served", "served", "{:.0f}", 0.7),
        Cell("Right", "correct", "{:.0f}", 0.7),
        Cell("Wrong", "wrong", "{:.0f}", 0.7),
        Cell("Open", "open", "{:.0f}", 0.6),
        Cell("Oracle's", "oracle_verdicts", "{:.0f}", 0.8),
        Cell("Served per hour", "served_per_hour", "{:.1f}", 0.8),
        Cell("Duration [min]", lambda row: _minutes(row.get("duration_s")), "{:.0f}", 0.8),
        Cell("In transit [min]", lambda row: _minutes(row.get("transit_s")), "{:.0f}", 0.8),
        Cell("Wind [m/s]", "wind_speed_mps", "{:.1f}", 0.7),
        Cell("Served ship [m]", "min_distance_m", "{:.0f}", 0.8),
        Cell("Other ships [m]", "others_distance_min_m", "{:.0f}", 0.8),
        Cell("Keep-out violations", "keepout_violations", "{:.0f}", 0.9),
    ]
    return rows_table(
        [{**patrol.row, "number": patrol.number} for patrol in patrols],
        cells,
        caption="Each patrol, and how many verdicts the oracle reaches. Distances are the least to"
        " the ship that was served, and to any other. Patrols are counted from 0, as in the names"
        " of flights.",
        print_size_pt=6.4,
        breakable=True,
    )


def _minutes(seconds: float | None) -> float | None:
    return None if seconds is None else seconds / _MINUTE


def ship_table(patrol: Patrol) -> Table:
    """Return the verdict on each ship of a patrol, by its number, and the time of the verdict."""
    cells = [
        Cell("Ship", "ship", "{:.0f}", 0.5),
        Cell("Speed [m/s]", "vessel_speed_mps", "{:.1f}", 0.7),
        Cell("ν", "nu", "{:.2f}", 0.6),
        Cell("Stack [m]", "plume_source_height_m", "{:.0f}", 0.6),
        Cell(f"Sulphur, true [{MASS_PERCENT}]", "fsc_fuel_percent", "{:.2f}", 0.8),
        Cell(f"measured [{MASS_PERCENT}]", "fsc_percent", "{:.3f}", 0.8),
        Cell("Verdict", _verdict, width=1.5),
        Cell("Reached [min]", lambda ship: _minutes(ship["reached_s"]), "{:.0f}", 0.8),
        Cell("Time to find [s]", "time_to_find_s", "{:.0f}", 0.8),
        Cell("Beside it [s]", lambda ship: ship["ended_s"] - ship["reached_s"], "{:.0f}", 0.8),
        Cell("known axis [s]", "known_axis_service_s", "{:.0f}", 0.7),
        Cell("Turn", "position", "{:.0f}", 0.5),
        Cell("Oracle's turn", "oracle_position", "{:.0f}", 0.7),
    ]
    return rows_table(
        patrol.ships.to_dict("records"),
        cells,
        caption=f"{patrol.title}: the verdict on each ship, and when it came. Ships, and their"
        " turns in the order, are counted from 0.",
        print_size_pt=6.4,
        breakable=True,
    )


def _verdict(ship: Mapping[Any, Any]) -> str:
    if pd.isna(ship["position"]):
        return "not served"
    if ship["verdict"] == "open":
        return "open"
    return f"{ship['verdict']}: {'right' if ship['verdict'] == ship['truth'] else 'wrong'}"


def patrol_chart(patrol: Patrol) -> Chart:
    """Return the map of a patrol, and a chart of the phases beside each ship over time."""
    count, done = len(patrol.ships), patrol.ships[patrol.ships["oracle_ended_s"].notna()]
    x, y = column(done, "oracle_ended_s") / _MINUTE, count - column(done, "ship")
    oracle = Line(x=x, y=y, label="done by the oracle", colour=Meaning.SHIP, style="diamonds")
    times = _time_panel(patrol.phases, count, [oracle])
    return Chart(
        name=patrol.name,
        caption=f"{patrol.title}. Map: where ships went, numbered where they began and until they"
        " were measured, and the UAV, which began at the ring. Time line: what it did beside or on"
        " the way to which ship. A diamond is when an oracle would be done with it.",
        panels=[in_kilometres(_map(patrol)), times],
        columns=2,
        panel_height=0.5,
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


def _time_panel(phases: pd.DataFrame, count: int, marks: list[Line]) -> Panel:
    """Return bars over time, with a row for each ship and a curve with gaps for each phase."""
    lines = []
    for phase, colour in _PHASES.items():
        rows = phases[phases["phase"] == phase].assign(row=count - phases["ship"], gap=np.nan)
        time, row = (
            rows[names].to_numpy(np.float64).ravel()
            for names in (["begins_s", "ends_s", "gap"], ["row", "row", "gap"])
        )
        lines.append(Line(x=time / _MINUTE, y=row, label=phase, colour=colour, style="broad"))
    return Panel(
        x_label="Time since the start [min]",
        y_label="Ship",
        title="Time line",
        lines=[*lines, *marks],
        y_range=(1.0 - _EDGE, count + _EDGE),
        y_names=[(float(count - i), str(i)) for i in range(count)],
        y_whole=True,
    )
