"""The equilibria of a design over airspeed and bank."""

import math
from collections.abc import Sequence

import numpy as np

from reports.design.data import Record, bank_deg, control_axis, grid_trims, is_effect
from reports.document.chart import Chart, Line, Panel, Style
from reports.document.palette import Meaning, series_colour
from reports.document.tables import minus

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
        _panel(trims, "alpha_rad", "Angle of attack [deg]", math.degrees(1.0)),
        *(_panel(trims, name, control_axis(design, name)) for name in controls),
        _panel(trims, "sideslip_rad", "Sideslip [deg]", math.degrees(1.0)),
    ]
    effect = _EFFECT * any(is_effect(design, name) for name in controls)
    return Chart(
        name="trims", caption=_EQUILIBRIA + effect, panels=panels, columns=3, panel_height=0.24
    )


def _panel(trims: Sequence[Record], key: str, label: str, scale: float = 1.0) -> Panel:
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
