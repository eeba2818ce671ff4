"""Figures of what drives the flights of a Monte Carlo study: bars of the indices."""

from typing import Any

import numpy as np

from reports.document.chart import Chart, Line, Panel, upright
from reports.monte_carlo.names import input_name
from reports.run.columns import Array
from reports.run.run_data import RunData

INPUTS_MAX = 12
"""Inputs that have bars."""


def driver_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return bars of the sensitivity indices of each figure that has any, the largest delta
    first.
    """
    return [
        _bars(key, run.column(key).title, found)
        for key, found in statistics["sensitivity"].items()
        if found["inputs"]
    ]


def _bars(key: str, title: str, found: dict[str, Any]) -> Chart:
    inputs = found["inputs"][:INPUTS_MAX]
    more = len(found["inputs"]) - len(inputs)
    left_out = f" {more} inputs have a smaller δ." if more else ""
    of = f" of {found['known']:,}" if found["known"] > found["flights"] else ""
    names = [input_name(index["key"]) for index in inputs]
    return Chart(
        name=f"drivers-{key.replace('_', '')}",
        caption=f"{title}: {found['flights']:,} flights{of}.{left_out}",
        panels=[
            _index_panel(inputs, "delta", found["delta_floor"], "Borgonovo's δ [-]", names, title),
            _index_panel(
                inputs,
                "first_order",
                found["first_order_floor"],
                "First-order index S₁ [-]",
                [""] * len(names),
                "",
            ),
        ],
        columns=2,
        panel_height=0.12 + 0.025 * len(inputs),
    )


def _index_panel(
    inputs: list[dict[str, Any]],
    name: str,
    floor: float,
    x_label: str,
    names: list[str],
    title: str,
) -> Panel:
    value = np.array([index[name] for index in inputs])
    error = np.array([index[f"{name}_error"] for index in inputs])
    place = np.arange(len(inputs))[::-1].astype(np.float64)
    above = value - error > floor
    lines = [
        _bar_line(value[mask], place[mask], label, colour)
        for mask, label, colour in (
            (above, "above the noise floor", "blue"),
            (~above, "not above it", "grey"),
        )
        if mask.any()
    ]
    ends = np.column_stack([value - error, value + error, np.full(len(value), np.nan)]).ravel()
    reach = (-0.6, len(inputs) - 0.4)
    lines += [
        Line(x=ends, y=np.repeat(place, 3), label="interval", colour="black"),
        upright(floor, reach, "noise floor"),
    ]
    low, high = min(0.0, float((value - error).min())), max(floor, float((value + error).max()))
    return Panel(
        x_label=x_label,
        y_label="Input",
        title=title,
        lines=lines,
        x_range=(low - 0.02 * (high - low), high + 0.05 * (high - low)),
        y_range=reach,
        y_names=list(zip(place.tolist(), names, strict=True)),
    )


def _bar_line(values: Array, places: Array, label: str, colour: str) -> Line:
    """Return bars from 0, which one outline encloses: from bar to bar it runs along 0."""
    x = np.column_stack([np.zeros(len(values)), values, values, np.zeros(len(values))]).ravel()
    y = np.column_stack([places - 0.32, places - 0.32, places + 0.32, places + 0.32]).ravel()
    return Line(x=x, y=y, label=label, colour=colour, fill=True)
