"""The open loops of a design in Nichols' plane."""

import math

import numpy as np

from reports.design.data import Record, at_middle, loop_name
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
