"""Figures of the open loops of a design: Bode and Nichols."""

import math
from collections.abc import Sequence

import numpy as np

from reports.design.data import CONTROLS, Record, at_middle, loop_name, speed
from reports.design.loop_styles import LOOP_STYLES, OTHER_LOOP
from reports.document.axes import cut_words
from reports.document.chart import Chart, Line, Panel, circle
from reports.document.palette import Meaning
from reports.run.columns import Array

_NICHOLS_GAIN = (-30.0, 40.0)
"""Gains that a Nichols panel shows [dB]: far above and below them a loop cannot come near the
critical point.
"""

_CRITICAL = -180.0
"""Phase at which a gain of one makes the closed loop unstable [deg]; so does any whole turn from
there.
"""


_BODE = (
    "Open loops at {speed} in level flight, one opened at a time and all others closed, with"
    " servos, engine and computing delay. Dotted: gain 1 and −180 deg."
)
_NICHOLS = (
    "The loops in Nichols' plane. Each has to pass the critical point (gain 1, −180 deg) outside"
    " the tinted region, whose corners are the required margins of {gain:g} dB and {phase:g} deg;"
    " its disk margin is dashed."
)


def loop_charts(design: Record) -> list[Chart]:
    """Return the Bode and the Nichols figure of every loop of the record, or nothing where it has
    no loops.
    """
    return [_bode(design), _nichols(design)] if design["loops"] else []


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


def _bode(design: Record) -> Chart:
    groups = [
        ("Opened at a control", [loop for loop in design["loops"] if loop["loop"] in CONTROLS]),
        (
            "Opened at a measurement",
            [loop for loop in design["loops"] if loop["loop"] not in CONTROLS],
        ),
    ]
    groups = [group for group in groups if group[1]]
    panels = [
        *(_bode_panel(loops, title, "gain_db") for title, loops in groups),
        *(_bode_panel(loops, "", "phase_deg") for _, loops in groups),
    ]
    return Chart(
        name="bode",
        caption=_BODE.format(speed=speed(design["design_airspeed_mps"])) + cut_words(panels),
        panels=panels,
        columns=len(groups),
        share_x=True,
        panel_height=0.32,
    )


def _bode_panel(loops: Sequence[Record], title: str, key: str) -> Panel:
    gain = key == "gain_db"
    frequency = np.array(loops[0]["frequency_rad_s"])
    limits = (float(frequency[0]), float(frequency[-1]))
    lines = [
        _curve(
            loop, np.array(loop["frequency_rad_s"]), np.array(loop[key]) if gain else turned(loop)
        )
        for loop in loops
    ]
    level = 0.0 if gain else _CRITICAL
    lines.append(
        Line(x=np.array(limits), y=np.array([level, level]), label="", colour="black", style="dot")
    )
    lowest, highest = (
        min(float(line.y.min()) for line in lines),
        max(float(line.y.max()) for line in lines),
    )
    return Panel(
        x_label="Frequency [rad/s]",
        y_label="Gain [dB]" if gain else "Phase [deg]",
        lines=lines,
        title=title,
        log_x=True,
        x_range=limits,
        y_range=(-60.0, 60.0) if gain else (max(lowest - 15.0, -540.0), min(highest + 15.0, 180.0)),
    )


def _curve(loop: Record, x: Array, y: Array) -> Line:
    colour, style = LOOP_STYLES.get(loop["loop"], OTHER_LOOP)
    return Line(x=x, y=y, label=loop_name(loop), colour=colour, style=style)


def _nichols(design: Record) -> Chart:
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
