"""Figures of the margins over the grid of a design."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.design.data import Record, bank_deg, loop_name, loops_of, worst
from reports.design.loop_styles import LOOP_STYLES, OTHER_LOOP
from reports.document.axes import cut_words
from reports.document.chart import Chart, Line, Panel, constant
from reports.document.palette import Meaning


@dataclass(frozen=True, slots=True, kw_only=True)
class _Margin:
    """A margin to draw: its field, its axis, what is required of it, and above what it no longer
    matters.
    """

    key: str
    label: str
    required: float | None
    ceiling: float


def margin_charts(design: Record) -> list[Chart]:
    """Return the disk margins and the classical margins over airspeed and over bank."""
    required = design["required"]
    disk = [
        _Margin(key="disk_gain_db", label="Disk gain [dB]", required=None, ceiling=25.0),
        _Margin(key="disk_phase_deg", label="Disk phase [deg]", required=None, ceiling=90.0),
    ]
    classical = [
        _Margin(
            key="gain_db", label="Gain margin [dB]", required=required["gain_db"], ceiling=40.0
        ),
        _Margin(
            key="phase_deg",
            label="Phase margin [deg]",
            required=required["phase_deg"],
            ceiling=120.0,
        ),
    ]
    return [
        _chart(
            design,
            "diskmargins",
            disk,
            "Disk margins of each loop: gain and phase may change together by so much. “All"
            " controls”: in every control at once, each for itself.",
        ),
        _chart(
            design,
            "classicalmargins",
            classical,
            "Classical margins: gain alone or phase alone, of one loop, all others closed. A loop"
            " without a curve has no such margin: no change of its gain, or of its phase, makes it"
            " unstable.",
        ),
    ]


def _chart(design: Record, name: str, margins: Sequence[_Margin], caption: str) -> Chart:
    rows = design["margins"]
    panels = [_panel(rows, margin, over_bank=False) for margin in margins]
    over_bank = len({bank_deg(row) for row in rows}) > 1
    if over_bank:
        panels += [_panel(rows, margin, over_bank=True) for margin in margins]
        caption += (
            " Above, the worst over bank at each airspeed; below, the worst over airspeed at each"
            " bank."
        )
    if any(row["between"] for row in rows):
        caption += (
            " Diamonds, and rings of dashed and dotted loops: at points between those of the grid"
            " and at the largest bank, for which nothing was designed."
        )
    return Chart(
        name=name, caption=caption + cut_words(panels), panels=panels, columns=2, panel_height=0.21
    )


def _panel(rows: Sequence[Record], margin: _Margin, *, over_bank: bool) -> Panel:
    at = np.array(sorted({_abscissa(row, over_bank=over_bank) for row in rows}))
    lines = []
    if margin.required is not None:
        lines.append(
            Line(
                x=at,
                y=constant(at, margin.required),
                label="required",
                colour=Meaning.LIMIT,
                style="dash",
            )
        )
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
    colour, style = LOOP_STYLES.get(rows[0]["loop"], OTHER_LOOP)
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
