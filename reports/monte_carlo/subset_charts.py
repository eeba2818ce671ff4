"""Figures of a subset simulation: the probability over the closest approach, and the inputs near a
violation.
"""

from typing import Any

import numpy as np

from common.columns import Column
from reports.document.chart import Chart, Line, Panel
from reports.document.palette import Meaning
from reports.monte_carlo.driver_charts import INPUTS_MAX, bar_line, not_shown
from reports.monte_carlo.names import Units, input_label, input_name
from reports.run.columns import Array

SHOWN = 4
"""Inputs whose distributions are shown."""


def curve_chart(statistics: dict[str, Any], clearance: Column) -> list[Chart]:
    """Return the probability of coming closer than a distance, over that distance; none if no
    distance was reached by all.
    """
    points = statistics["curve"]
    if len(points) < 2:
        return []
    x, estimate, low, high = (
        _column(points, name) for name in ("clearance_m", "estimate", "low", "high")
    )
    floor = 0.5 * float(low.min())
    panel = Panel(
        x_label=clearance.label,
        y_label="Probability of a flight that comes closer [-]",
        lines=[
            Line(
                x=np.concatenate([x, x[::-1]]),
                y=np.concatenate([low, high[::-1]]),
                label="interval",
                colour="sky",
                fill=True,
            ),
            Line(x=x, y=estimate, label="estimate", colour="blue"),
            Line(
                x=np.zeros(2),
                y=np.array([floor, 1.5]),
                label="r_min",
                colour=Meaning.LIMIT,
                style="dash",
            ),
        ],
        log_y=True,
        y_range=(floor, 1.5),
    )
    caption = (
        "Probability that the closest approach of a flight lies below a distance beyond r_min, from all levels, with its two-sided"
        " interval at each distance. The curve ends where a simulation has nothing nearer."
    )
    return [Chart(name="rare-curve", caption=caption, panels=[panel], panel_height=0.42)]


def distance_chart(statistics: dict[str, Any]) -> list[Chart]:
    """Return bars of the distances of the inputs, the largest first."""
    inputs, floor = statistics["inputs"][:INPUTS_MAX], statistics["noise_floor"]
    if not inputs:
        return []
    value = _column(inputs, "distance")
    place = np.arange(len(inputs))[::-1].astype(np.float64)
    above = value > floor
    reach = np.array([-0.6, len(inputs) - 0.4])
    lines = [
        bar_line(value[mask], place[mask], label, colour)
        for mask, label, colour in (
            (above, "above the noise floor", "blue"),
            (~above, "not above it", "grey"),
        )
        if mask.any()
    ]
    lines.append(
        Line(x=np.full(2, floor), y=reach, label="noise floor", colour=Meaning.LIMIT, style="dash")
    )
    panel = Panel(
        x_label="Distance of the distributions [-]",
        y_label="Input",
        lines=lines,
        x_range=(0.0, 1.05 * max(floor, float(value.max()))),
        y_range=(float(reach[0]), float(reach[1])),
        y_names=list(
            zip(place.tolist(), [input_name(entry["key"]) for entry in inputs], strict=True)
        ),
    )
    more = len(statistics["inputs"]) - len(inputs)
    caption = "What sets the nearest flights apart." + not_shown(more, "distance")
    return [
        Chart(
            name="rare-inputs",
            caption=caption,
            panels=[panel],
            panel_height=0.12 + 0.025 * len(inputs),
        )
    ]


def input_charts(statistics: dict[str, Any], units: Units) -> list[Chart]:
    """Return how the inputs with the largest distances are distributed, declared and near the
    event; words are in the table.
    """
    numbers = [entry for entry in statistics["inputs"] if entry["edges"]][:SHOWN]
    if not numbers:
        return []
    near = (
        "flights with a violation"
        if statistics["violation"]["reached"]
        else "flights of the last level"
    )
    panels = [_distribution(entry, near, units) for entry in numbers]
    caption = (
        f"Inputs with the largest distances: fraction in each class, of {near} and as declared."
    )
    return [
        Chart(
            name="rare-distributions",
            caption=caption,
            panels=panels,
            columns=min(2, len(panels)),
            panel_height=0.3,
        )
    ]


def _distribution(entry: dict[str, Any], near: str, units: Units) -> Panel:
    edges = np.repeat(np.array(entry["edges"]), 2)
    outlines = {
        which: np.concatenate([[0.0], np.repeat(100.0 * np.array(entry[which]), 2), [0.0]])
        for which in ("declared", "near")
    }
    lines = [
        Line(x=edges, y=outlines["declared"], label="as declared", colour="grey", fill=True),
        Line(x=edges, y=outlines["near"], label=near, colour="plum", fill=True),
    ]
    most = 100.0 * max(*entry["declared"], *entry["near"])
    return Panel(
        x_label=input_label(entry["key"], units),
        y_label="Fraction [%]",
        lines=lines,
        y_range=(0.0, 1.08 * most),
    )


def _column(entries: list[dict[str, Any]], name: str) -> Array:
    return np.array([entry[name] for entry in entries], dtype=np.float64)
