"""Figures of the margins over the grid of a design."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from reports.design.data import Record, bank_deg, loop_name, loops_of, worst
from reports.document.axes import cut_words
from reports.document.chart import Chart, Line, Panel, Style, constant
from reports.document.palette import Meaning

_LOOP_STYLES: dict[str, tuple[str, Style]] = {
    "elevator": ("blue", "solid"),
    "aileron": ("orange", "solid"),
    "throttle": ("green", "thin"),
    "rudder": ("plum", "solid"),
    "altitude": ("blue", "dash"),
    "heading_rate": ("orange", "dash"),
    "airspeed": ("green", "dot"),
    "sideslip": ("plum", "dash"),
    "all controls": ("black", "solid"),
}
"""Colour and style by loop: a measurement has the colour of the control that mostly regulates it,
dashed or dotted. Blue and green, which are alike in grey, have other styles."""

_OTHER_LOOP: tuple[str, Style] = ("grey", "solid")
"""Of a loop that the table does not know."""


class _Margin(NamedTuple):
    """A margin to draw: its field, its axis, what is required of it, and above what it no longer
    matters.
    """

    key: str
    label: str
    required: float
    ceiling: float


def margin_chart(design: Record) -> Chart:
    """Return the classical margins over airspeed and over bank."""
    rows, required = design["margins"], design["required"]
    margins = [
        _Margin("gain_db", "Gain margin [dB]", required["gain_db"], 40.0),
        _Margin("phase_deg", "Phase margin [deg]", required["phase_deg"], 120.0),
    ]
    panels = [_panel(rows, margin, over_bank=False) for margin in margins]
    if len({bank_deg(row) for row in rows}) > 1:
        panels += [_panel(rows, margin, over_bank=True) for margin in margins]
    return Chart(
        name="classicalmargins",
        caption=_CAPTION + cut_words(panels),
        panels=panels,
        columns=2,
        panel_height=0.21,
    )


_CAPTION = (
    "Classical margins: gain alone or phase alone, of one loop, all others closed; the worst over"
    " bank at each airspeed, and over airspeed at each bank. A loop without a curve has no such"
    " margin. Diamonds, and rings of dashed and dotted loops: at points between those of the grid"
    " and at the largest bank, for which nothing was designed."
)


def _panel(rows: Sequence[Record], margin: _Margin, *, over_bank: bool) -> Panel:
    at = np.array(sorted({_abscissa(row, over_bank=over_bank) for row in rows}))
    required = constant(at, margin.required)
    lines = [Line(x=at, y=required, label="required", colour=Meaning.LIMIT, style="dash")]
    for loop in loops_of(rows):
        own = [row for row in rows if row["loop"] == loop]
        lines += _curve(
            [row for row in own if not row["between"]],
            margin.key,
            over_bank=over_bank,
            between=False,
        )
        lines += _curve(
            [row for row in own if row["between"]], margin.key, over_bank=over_bank, between=True
        )
    largest = max((float(line.y.max()) for line in lines), default=margin.ceiling)
    return Panel(
        x_label="Bank [deg]" if over_bank else "Airspeed [m/s]",
        y_label=margin.label,
        lines=lines,
        y_range=(0.0, min(1.08 * largest, margin.ceiling)),
    )


def _curve(rows: Sequence[Record], key: str, *, over_bank: bool, between: bool) -> list[Line]:
    """Return the curve of one loop's worst margin, or none where it has no such margin."""
    groups: dict[float, list[Record]] = {}
    for row in rows:
        groups.setdefault(_abscissa(row, over_bank=over_bank), []).append(row)
    least = {
        at: found[key] for at in sorted(groups) if (found := worst(groups[at], key)) is not None
    }
    if not least:
        return []
    colour, style = _LOOP_STYLES.get(rows[0]["loop"], _OTHER_LOOP)
    return [
        Line(
            x=np.array(list(least)),
            y=np.array(list(least.values()), dtype=np.float64),
            label="" if between else loop_name(rows[0]),
            colour=colour,
            # Of two loops of one colour one is dashed or dotted, and has the open marker.
            style=style if not between else "diamonds" if style in ("solid", "thin") else "ring",
        )
    ]


def _abscissa(row: Record, *, over_bank: bool) -> float:
    return bank_deg(row) if over_bank else float(row["airspeed_mps"])
