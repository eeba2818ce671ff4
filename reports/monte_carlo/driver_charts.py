"""Figures of what drives the flights of a Monte Carlo study: bars of the indices, and the clearance
over the first inputs.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pandas as pd

from reports.document.chart import Chart, Line, Panel
from reports.document.palette import Meaning
from reports.document.panels import Group, beyond_label, capped, level, strips
from reports.monte_carlo.names import (
    Units,
    documented_units,
    input_label,
    input_name,
)
from reports.run.columns import Array, beside_vessel, clearance, violated
from reports.run.run_data import RunData

SCATTER_MAX = 2000
"""Flights of a scatter at most."""

NEAREST = 200
"""Flights of a scatter that are the nearest of all, whatever else is left out."""

INPUTS_MAX = 12
"""Inputs that have bars."""

SCATTERED = 4
"""Inputs that the clearance is shown over."""


def driver_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return bars of the sensitivity indices of each figure that has any, the largest delta first."""
    return [
        _bars(key, run.column(key).title, found)
        for key, found in statistics["sensitivity"].items()
        if found["inputs"]
    ]


def not_shown(more: int, measure: str) -> str:
    """Return how many inputs a figure leaves out, whose measure is smaller than that of the others;
    empty if none.
    """
    return (
        f" {more} {'input' if more == 1 else 'inputs'} with a smaller {measure} {'is' if more == 1 else 'are'} not shown."
        if more
        else ""
    )


def _bars(key: str, title: str, found: dict[str, Any]) -> Chart:
    inputs = found["inputs"][:INPUTS_MAX]
    more = len(found["inputs"]) - len(inputs)
    of = f" of {found['known']:,}" if found["known"] > found["flights"] else ""
    names = [input_name(index["key"]) for index in inputs]
    return Chart(
        name=f"drivers-{key.replace('_', '')}",
        caption=f"{title}: {found['flights']:,} flights{of}." + not_shown(more, "δ"),
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
        bar_line(value[mask], place[mask], label, colour)
        for mask, label, colour in (
            (above, "above the noise floor", "blue"),
            (~above, "not above it", "grey"),
        )
        if mask.any()
    ]
    ends = np.column_stack([value - error, value + error, np.full(len(value), np.nan)]).ravel()
    reach = np.array([-0.6, len(inputs) - 0.4])
    lines += [
        Line(x=ends, y=np.repeat(place, 3), label="interval", colour="black"),
        Line(x=np.full(2, floor), y=reach, label="noise floor", colour=Meaning.LIMIT, style="dash"),
    ]
    low, high = min(0.0, float((value - error).min())), max(floor, float((value + error).max()))
    return Panel(
        x_label=x_label,
        y_label="Input",
        title=title,
        lines=lines,
        x_range=(low - 0.02 * (high - low), high + 0.05 * (high - low)),
        y_range=(float(reach[0]), float(reach[1])),
        y_names=list(zip(place.tolist(), names, strict=True)),
    )


def bar_line(values: Array, places: Array, label: str, colour: str) -> Line:
    """Return bars from 0, which one outline encloses: from bar to bar it runs along 0."""
    x = np.column_stack([np.zeros(len(values)), values, values, np.zeros(len(values))]).ravel()
    y = np.column_stack([places - 0.32, places - 0.32, places + 0.32, places + 0.32]).ravel()
    return Line(x=x, y=y, label=label, colour=colour, fill=True)


def scatter_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return the clearance over the inputs that drive it the most, words apart from figures; none
    if no input is known to.
    """
    keys = [
        index["key"] for index in statistics["sensitivity"]["clearance_m"]["inputs"][:SCATTERED]
    ]
    measured = beside_vessel(run.summary)
    shown = measured.iloc[thinned(clearance(measured))]
    sampled = run.draws.set_index("flight_id").reindex(shown["flight_id"])
    near, inside = clearance(shown), violated(shown)
    groups = [
        (~inside, "flight", Meaning.FLOWN),
        (inside, "flight with a keep-out violation", Meaning.LIMIT),
    ]
    caption = "Closest approach of each flight beyond r_min, over the inputs with the largest δ."
    if len(shown) < len(measured):
        caption += f" {len(shown):,} of {len(measured):,} flights are shown, the {NEAREST} nearest among them."
    units, label = documented_units(run.manifest), run.column("clearance_m").label
    figures = [
        _scatter(sampled[key], near, groups, units, label)
        for key in keys
        if pd.api.types.is_numeric_dtype(sampled[key])
    ]
    # Words beside an axis are wide: below each other, not beside, these panels have room for them.
    words = [
        _strips(sampled[key], near, groups, label)
        for key in keys
        if not pd.api.types.is_numeric_dtype(sampled[key])
    ]
    charts = [
        Chart(
            name="over-figures",
            caption=caption,
            panels=figures,
            columns=min(2, len(figures)),
            panel_height=0.36,
        ),
        Chart(name="over-words", caption=caption, panels=words, panel_height=0.3),
    ]
    return [chart for chart in charts if chart.panels]


def _scatter(
    values: "pd.Series[Any]", near: Array, groups: Sequence[Group], units: Units, y_label: str
) -> Panel:
    x = values.to_numpy(dtype=np.float64)
    lines, top = capped(x, near, groups, float("nan"), unit="m")
    bottom = min(0.0, float(near.min()))
    lines.append(level(x, 0.0, "r_min"))
    y_range = (bottom - 0.05 * (top - bottom), top)
    return Panel(
        x_label=input_label(str(values.name), units),
        y_label=y_label,
        lines=lines,
        y_range=y_range,
    )


def _strips(values: "pd.Series[Any]", near: Array, groups: Sequence[Group], x_label: str) -> Panel:
    """Return a row of flights for each word, those far above all others at the edge."""
    _, top = capped(near, near, groups, float("nan"))
    beyond = near > top
    shown = [
        *((mask & ~beyond, name, colour) for mask, name, colour in groups),
        *([(beyond, beyond_label(near[beyond], "m"), "black")] if beyond.any() else []),
    ]
    words, label = [str(value).replace("_", " ") for value in values], input_name(str(values.name))
    return strips(np.minimum(near, top), words, x_label, label, shown, [(0.0, "r_min")], named=True)


def thinned(near: Array) -> npt.NDArray[np.int64]:
    """Return which flights a scatter shows, in their order: the nearest, and of the others about
    one in so many, always the same.

    Parameters
    ----------
    near : clearance of each flight, shape (n,) [m]

    Returns
    -------
    chosen : their places, shape (``SCATTER_MAX``,) at most
    """
    order = np.argsort(near, kind="stable")
    others = np.sort(order[NEAREST:])
    places = (
        np.linspace(0.0, len(others) - 1.0, min(len(others), SCATTER_MAX - NEAREST))
        .round()
        .astype(np.int64)
    )
    chosen: npt.NDArray[np.int64] = np.sort(np.concatenate([order[:NEAREST], others[places]]))
    return chosen
