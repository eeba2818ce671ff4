"""The equilibria of a design over airspeed and bank."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reports.design.data import (
    Record,
    bank_deg,
    control_axis,
    grid_trims,
    is_effect,
)
from reports.document.chart import Chart, Line, Panel, Style, across, upright
from reports.document.palette import Meaning, series_colour
from reports.document.tables import minus

_NEAR_LIMIT = 0.4
"""Fraction of a control's travel from which its limit is drawn: nearer to neutral it would only
flatten the curves.
"""

_LIMIT, _FLIGHT_IDLE = "limit of a control", "flight idle"
_STYLES: dict[str, Style] = {_LIMIT: "dash", _FLIGHT_IDLE: "dot"}
"""Labels of the lines at limits, and how they are drawn."""


@dataclass(frozen=True, slots=True, kw_only=True)
class _Quantity:
    """A quantity of an equilibrium: its field, its axis, the unit that it is shown in, its limits
    and what they are.
    """

    key: str
    label: str
    scale: float = 1.0
    limits: tuple[tuple[float, str], ...] = ()


_ALPHA = _Quantity(key="alpha_rad", label="Angle of attack [deg]", scale=math.degrees(1.0))
_SIDESLIP = _Quantity(key="sideslip_rad", label="Sideslip [deg]", scale=math.degrees(1.0))
_YAW_RATE = _Quantity(key="yaw_rate_rad_s", label="Yaw rate [rad/s]")


def _control(design: Record, name: str) -> _Quantity:
    """Return a control, between the limits that the autopilot has for it: its throttle stops at
    flight idle.
    """
    limits = [
        (
            (row["lower"], _FLIGHT_IDLE if name == "throttle" and row["lower"] > 0.0 else _LIMIT),
            (row["upper"], _LIMIT),
        )
        for row in design["inputs"]
        if row["name"] == name
    ]
    return _Quantity(key=name, label=control_axis(design, name), limits=limits[0] if limits else ())


def trim_map(design: Record) -> Chart:
    """Return the equilibria over airspeed, a curve for each bank."""
    trims = grid_trims(design)
    elevator, throttle, aileron, rudder = (
        _control(design, name) for name in ("elevator", "throttle", "aileron", "rudder")
    )
    # Without a rudder its place goes to the yaw rate, so that no panel is empty.
    quantities = (
        _ALPHA,
        elevator,
        throttle,
        aileron,
        rudder if rudder.key in trims[0] else _YAW_RATE,
        _SIDESLIP,
    )
    caption = (
        "Equilibria over airspeed, a curve per bank; to the left dashed, to the right solid."
        " Upright lines: the limits of the commanded airspeed, and the stall where it is near."
    )
    if any(is_effect(design, quantity.key) for quantity in quantities):
        caption += (
            " The effect of a surface is proportional to its moment: 0 at the command 0, and 2"
            " from stop to stop."
        )
    if any(t.get("limits") for t in trims):
        caption += " Diamonds: equilibria at a limit, which the table names."
    return Chart(
        name="trims",
        caption=caption,
        panels=[_map_panel(design, trims, quantity) for quantity in quantities],
        columns=3,
        panel_height=0.24,
    )


def _map_panel(design: Record, trims: Sequence[Record], quantity: _Quantity) -> Panel:
    banks = sorted({bank_deg(t) for t in trims}, key=lambda bank: (abs(bank), -bank))
    sizes = sorted({abs(bank) for bank in banks})
    lines = []
    for bank in banks:
        rows = [t for t in trims if bank_deg(t) == bank]
        style: Style = "solid" if bank >= 0.0 else "dash"
        label = minus(f"bank {bank:+g}°") if bank else "level"
        lines.append(_line(rows, quantity, label, series_colour(sizes.index(abs(bank))), style))
    at_limit = [t for t in trims if t.get("limits")]
    if at_limit:
        lines.append(_line(at_limit, quantity, "at a limit", Meaning.LIMIT, "diamonds"))
    y_range = _limits_of(lines, quantity)
    airspeeds = [float(t["airspeed_mps"]) for t in trims]
    lines += _limit_lines(quantity, y_range, (min(airspeeds), max(airspeeds)))
    lines += _envelope_lines(design["envelope"], y_range, (min(airspeeds), max(airspeeds)))
    x = np.concatenate([line.x for line in lines])
    room = 0.03 * float(x.max() - x.min())
    x_range = (float(x.min()) - room, float(x.max()) + room)
    return Panel(
        x_label="Airspeed [m/s]",
        y_label=quantity.label,
        lines=lines,
        x_range=x_range,
        y_range=y_range,
    )


def _line(
    rows: Sequence[Record], quantity: _Quantity, label: str, colour: str, style: Style
) -> Line:
    x = np.array([float(row["airspeed_mps"]) for row in rows])
    y = quantity.scale * np.array([float(row[quantity.key]) for row in rows])
    return Line(x=x, y=y, label=label, colour=colour, style=style)


def _limits_of(lines: Sequence[Line], quantity: _Quantity) -> tuple[float, float]:
    """Return the range of an axis: what is drawn, and the limits that it comes near to."""
    values = np.concatenate([line.y for line in lines])
    lowest, highest = float(np.nanmin(values)), float(np.nanmax(values))
    if quantity.limits:
        (lower, _), (upper, _) = quantity.limits
        lowest = min(lowest, lower) if lower >= 0.0 or lowest < _NEAR_LIMIT * lower else lowest
        highest = max(highest, upper) if highest > _NEAR_LIMIT * upper else highest
    # A curve without any height still needs an axis with some.
    room = max(0.08 * (highest - lowest), 0.01)
    return lowest - room, highest + room


def _limit_lines(
    quantity: _Quantity, y_range: tuple[float, float], x_range: tuple[float, float]
) -> list[Line]:
    shown = [limit for limit in quantity.limits if y_range[0] < limit[0] < y_range[1]]
    ends = np.array(x_range)
    return [across(ends, at, label, style=_STYLES[label]) for at, label in shown]


def _envelope_lines(
    envelope: Record, y_range: tuple[float, float], x_range: tuple[float, float]
) -> list[Line]:
    marks: list[tuple[float | None, str, Style]] = [
        (envelope["airspeed_min_mps"], "envelope", "solid"),
        (envelope["airspeed_max_mps"], "envelope", "solid"),
        (envelope["stall_airspeed_mps"], "stall", "dot"),
    ]
    # A stall far below the grid would push the curves to the edge.
    reach = x_range[0] - 0.5 * (x_range[1] - x_range[0])
    return [
        upright(at, y_range, label, "grey", style)
        for at, label, style in marks
        if at is not None and at >= reach
    ]
