"""Figures of patrols: a map with a time line of one, and the time lines of all."""

import numpy as np
import pandas as pd

from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Note, Panel, Style
from reports.document.map_marks import on_map
from reports.document.palette import Meaning
from reports.patrol.data import Patrol, Patrols
from reports.run.columns import column

_PHASES = {
    "transit": "blue",
    "approach": "orange",
    "searching": "sky",
    "measuring": "green",
    "leaving": "grey",
}
"""What the UAV does, in its order, and the colour of it."""

_MINUTE = 60.0

_EDGE = 0.7
"""Room beyond the first and the last row of a time line, in rows."""


_ABOVE = 0.03
"""How far above a ship her number stands, over the height of the map."""


def patrol_chart(patrol: Patrol) -> Chart:
    """Return the map of a patrol, and what was done beside which ship when."""
    return Chart(
        name=patrol.name,
        caption="Map: where ships went, numbered where they began and until they were measured, and the UAV, which began at the"
        " ring. Time line: what it did beside or on the way to which ship. A diamond is when an oracle would be done with her.",
        panels=[in_kilometres(_map(patrol)), _ship_times(patrol)],
        columns=2,
        panel_height=0.5,
    )


def time_lines(patrols: Patrols) -> Chart:
    """Return the time lines of all patrols, a row each."""
    count = len(patrols.patrols)
    numbered = [
        rows.assign(row=count - i)
        for i, rows in enumerate(patrol.phases for patrol in patrols.patrols)
    ]
    panel = Panel(
        x_label="Time since the start of the patrol [min]",
        y_label="Patrol",
        lines=_bars(pd.concat(numbered)),
        y_range=(1.0 - _EDGE, count + _EDGE),
        y_names=[(float(count - i), str(i)) for i in range(count)],
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
        style: Style = "dots" if served else "cross"
        ships.append(Line(x=east, y=north, label="ship", colour=Meaning.SHIP, style="thin"))
        label = "" if served else "not served"
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
    flown.append(Line(x=x, y=y, label="measured", colour=Meaning.CROSSING, style="square"))
    # Ships that are not served may go far beyond the page.
    shown = [*starts, *flown]
    room = _ABOVE * float(np.ptp(np.concatenate([line.y for line in shown])))
    notes = [
        Note(x=float(line.x[0]), y=float(line.y[0]) + room, text=str(number))
        for number, line in zip(patrol.ships["ship"], starts, strict=True)
    ]
    panel = Panel(
        x_label="East [m]", y_label="North [m]", title="Map", lines=[*ships, *shown], notes=notes
    )
    return on_map(panel, north=0.0, wind=patrol.wind, shown=shown)


def _ship_times(patrol: Patrol) -> Panel:
    count = len(patrol.ships)
    done = patrol.ships[patrol.ships["oracle_ended_s"].notna()]
    oracle = Line(
        x=column(done, "oracle_ended_s") / _MINUTE,
        y=count - column(done, "ship"),
        label="done by the oracle",
        colour=Meaning.SHIP,
        style="diamonds",
    )
    return Panel(
        x_label="Time since the start [min]",
        y_label="Ship",
        title="Time line",
        lines=[*_bars(patrol.phases.assign(row=count - patrol.phases["ship"])), oracle],
        y_range=(1.0 - _EDGE, count + _EDGE),
        y_names=[(float(count - i), str(i)) for i in range(count)],
    )


def _bars(phases: pd.DataFrame) -> list[Line]:
    """Return a bar for each stretch, at its ``row``; one curve a phase, with gaps."""
    lines = []
    for phase, colour in _PHASES.items():
        rows = phases[phases["phase"] == phase]
        gap = np.full(len(rows), np.nan)
        time = (
            np.column_stack([column(rows, "begins_s"), column(rows, "ends_s"), gap]).ravel()
            / _MINUTE
        )
        row = np.column_stack([column(rows, "row"), column(rows, "row"), gap]).ravel()
        lines.append(Line(x=time, y=row, label=phase, colour=colour, style="broad"))
    return lines
