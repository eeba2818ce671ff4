"""Figures of a design: equilibria, margins, loop shapes and step responses."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from reports.design.data import (
    Record,
    at_middle,
    bank_deg,
    control_axis,
    grid_trims,
    is_effect,
    loop_name,
    loops_of,
    responses_of,
    speed,
    worst,
)
from reports.document.axes import cut_words
from reports.document.chart import Chart, Line, Panel, Style, circle, constant
from reports.document.palette import Meaning, series_colour
from reports.document.tables import minus
from reports.run.columns import Array

RESPONSE_STYLES: dict[str, tuple[str, str, Style]] = {
    "model": ("reference model", "black", "dot"),
    "predicted": ("linear design", "orange", "dash"),
    "flown": ("flown in JSBSim", "blue", "solid"),
}
"""Label, colour and style by the kind of a response."""

_CHANNELS: dict[str, tuple[str, float]] = {
    "heading_rate": ("Heading rate [rad/s]", 1.0),
    "roll": ("Bank [deg]", math.degrees(1.0)),
    "altitude": ("Altitude [m]", 1.0),
    "airspeed": ("Airspeed [m/s]", 1.0),
}
"""Axis and scale by channel."""

_FIRST = (
    ("heading_rate", "heading_rate", "Turn"),
    ("heading_rate", "roll", "Turn"),
    ("airspeed", "airspeed", "Airspeed step"),
    ("altitude", "altitude", "Altitude step"),
)
"""Command, channel and title of each panel of page 1."""


def first_chart(design: Record) -> Chart | None:
    """Return what page 1 shows: a turn, and steps of airspeed and altitude; None of a design
    without step responses.
    """
    steps = [(responses_of(design, command), channel, title) for command, channel, title in _FIRST]
    panels = [
        _panel(responses, channel, title)
        for responses, channel, title in steps
        if any(channel in response["channels"] for response in responses)
    ]
    if not panels:
        return None
    caption = (
        "Steps of heading rate, airspeed and altitude from level flight at"
        f" {speed(design['design_airspeed_mps'])}: as the linear design predicts them, and as"
        " flown in JSBSim."
    )
    return Chart(name="first", caption=caption, panels=panels, columns=2)


def _panel(responses: Sequence[Record], channel: str, title: str) -> Panel:
    axis, scale = _CHANNELS[channel]
    lines = []
    for response in responses:
        if channel in response["channels"]:
            label, colour, style = RESPONSE_STYLES[response["kind"]]
            x, y = np.array(response["time_s"]), scale * np.array(response["channels"][channel])
            lines.append(Line(x=x, y=y, label=label, colour=colour, style=style))
    return Panel(x_label="Time [s]", y_label=axis, lines=lines, title=title)


_CONTROLS = ("elevator", "throttle", "aileron", "rudder")

_EQUILIBRIA = (
    "Equilibria over airspeed, a curve per bank; to the left dashed, to the right solid. Diamonds:"
    " an equilibrium at a limit of a control."
)
_EFFECT = (
    " The effect of a surface is proportional to its moment: 0 at the command 0, and 2 from stop to"
    " stop."
)


def trim_map(design: Record) -> Chart:
    """Return the equilibria over airspeed, a curve for each bank."""
    trims = grid_trims(design)
    controls = [name for name in _CONTROLS if name in trims[0]]
    panels = [
        _trim_panel(trims, "alpha_rad", "Angle of attack [deg]", math.degrees(1.0)),
        *(_trim_panel(trims, name, control_axis(design, name)) for name in controls),
        _trim_panel(trims, "sideslip_rad", "Sideslip [deg]", math.degrees(1.0)),
    ]
    effect = _EFFECT * any(is_effect(design, name) for name in controls)
    return Chart(
        name="trims", caption=_EQUILIBRIA + effect, panels=panels, columns=3, panel_height=0.24
    )


def _trim_panel(trims: Sequence[Record], key: str, label: str, scale: float = 1.0) -> Panel:
    banks = sorted({bank_deg(trim) for trim in trims}, key=lambda bank: (abs(bank), -bank))
    sizes = sorted({abs(bank) for bank in banks})

    def line(rows: Sequence[Record], name: str, colour: str, style: Style) -> Line:
        x, y = (np.array([float(row[of]) for row in rows]) for of in ("airspeed_mps", key))
        return Line(x=x, y=scale * y, label=name, colour=colour, style=style)

    lines = [
        line(
            [trim for trim in trims if bank_deg(trim) == bank],
            minus(f"bank {bank:+g}°") if bank else "level",
            series_colour(sizes.index(abs(bank))),
            "solid" if bank >= 0.0 else "dash",
        )
        for bank in banks
    ]
    if at_limit := [trim for trim in trims if trim.get("limits")]:
        lines.append(line(at_limit, "at a limit", Meaning.LIMIT, "diamonds"))
    return Panel(x_label="Airspeed [m/s]", y_label=label, lines=lines)


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
"""Colour and style of a loop that the table does not know."""


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
    panels = [_margin_panel(rows, margin, over_bank=False) for margin in margins]
    if len({bank_deg(row) for row in rows}) > 1:
        panels += [_margin_panel(rows, margin, over_bank=True) for margin in margins]
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


def _margin_panel(rows: Sequence[Record], margin: _Margin, *, over_bank: bool) -> Panel:
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
            # Where two loops have one colour, one is dashed or dotted, and has the open marker.
            style=style if not between else "diamonds" if style in ("solid", "thin") else "ring",
        )
    ]


def _abscissa(row: Record, *, over_bank: bool) -> float:
    return bank_deg(row) if over_bank else float(row["airspeed_mps"])


_NICHOLS_GAIN = (-30.0, 40.0)
"""Gains that a Nichols panel shows [dB]: far above and below them a loop cannot come near the
critical point.
"""

_CRITICAL = -180.0
"""Phase at which a gain of one makes the closed loop unstable [deg]; so does any whole turn from
there.
"""


_NICHOLS = (
    "The loops in Nichols' plane. Each has to pass the critical point (gain 1, −180 deg) outside"
    " the tinted region, whose corners are the required margins of {gain:g} dB and {phase:g} deg;"
    " its disk margin is dashed."
)


def turned(loop: Record) -> Array:
    """Return a loop's phase [deg] by whole turns such that it is in (-360, 0] where the gain is
    nearest to one.
    """
    gain, phase = np.array(loop["gain_db"]), np.array(loop["phase_deg"])
    middle = float(phase[np.argmin(np.abs(gain))])
    shifted: Array = phase - 360.0 * math.ceil(middle / 360.0)
    return shifted


def disk_region(gain_margin_db: float) -> tuple[Array, Array]:
    """Return phase [deg] and gain [dB] of the outline of the region that a disk margin keeps an
    open loop out of.

    Factors (1 + c d)/(1 - c d) with abs(d) <= 1 are those that the loop bears; c follows from the
    largest real one, which is the disk's gain margin. The loop is unstable with a factor f where it
    is -1/f (Seiler, Packard and Gahinet, An introduction to disk margins, IEEE Control Systems
    Magazine, 2020).
    """
    largest = 10.0 ** (gain_margin_db / 20.0)
    real, imaginary = circle((largest - 1.0) / (largest + 1.0))
    change = real + 1j * imaginary
    factor = (1.0 - change) / (1.0 + change)
    return _CRITICAL + np.degrees(np.angle(factor)), 20.0 * np.log10(np.abs(factor))


def nichols_chart(design: Record) -> Chart | None:
    """Return the open loops in Nichols' plane, or nothing where the record has no loops."""
    if not design["loops"]:
        return None
    disks = {
        row["loop"]: row["disk_gain_db"]
        for row in at_middle(design, design["margins"])
        if not row["between"]
    }
    gain, phase = design["required"]["gain_db"], design["required"]["phase_deg"]
    panels = [
        _nichols_panel(loop, disks.get(loop["loop"]), gain, phase) for loop in design["loops"]
    ]
    return Chart(
        name="nichols",
        caption=_NICHOLS.format(gain=gain, phase=phase) + cut_words(panels),
        panels=panels,
        # No gap after the last, where that can be.
        columns=4 if len(design["loops"]) % 3 else 3,
        panel_height=0.25,
    )


def _nichols_panel(
    loop: Record, disk_gain_db: float | None, gain_db: float, phase_deg: float
) -> Panel:
    gain, phase = np.array(loop["gain_db"]), turned(loop)
    shown = (gain >= _NICHOLS_GAIN[0]) & (gain <= _NICHOLS_GAIN[1])
    reach = phase[shown] if shown.any() else phase
    x_range = (
        max(min(float(reach.min()) - 15.0, -270.0), -600.0),
        min(max(float(reach.max()) + 15.0, -80.0), 240.0),
    )
    lines: list[Line] = []
    for critical in (_CRITICAL - 360.0, _CRITICAL, _CRITICAL + 360.0):
        if x_range[0] < critical + phase_deg and critical - phase_deg < x_range[1]:
            lines += _regions(critical, disk_gain_db, gain_db, phase_deg)
    lines.append(Line(x=phase, y=gain, label="open loop", colour="blue"))
    return Panel(
        x_label="Phase [deg]",
        y_label="Gain [dB]",
        lines=lines,
        title=loop_name(loop),
        x_range=x_range,
        y_range=_NICHOLS_GAIN,
    )


def _regions(
    critical: float, disk_gain_db: float | None, gain_db: float, phase_deg: float
) -> list[Line]:
    """Return what a loop has to stay out of, what it does stay out of, and the critical point in
    both.
    """
    corners = np.array(
        [(-phase_deg, 0.0), (0.0, gain_db), (phase_deg, 0.0), (0.0, -gain_db), (-phase_deg, 0.0)]
    )
    label = f"excluded: {gain_db:g} dB, {phase_deg:g} deg"
    lines = [
        Line(
            x=critical + corners[:, 0],
            y=corners[:, 1],
            label=label,
            colour=Meaning.LIMIT,
            fill=True,
        )
    ]
    if disk_gain_db is not None:
        phase, gain = disk_region(disk_gain_db)
        lines.append(
            Line(
                x=phase - _CRITICAL + critical,
                y=gain,
                label="its disk margin",
                colour="orange",
                style="dash",
            )
        )
    point = np.array([critical])
    return [
        *lines,
        Line(x=point, y=np.zeros(1), label="critical point", colour="black", style="points"),
    ]
