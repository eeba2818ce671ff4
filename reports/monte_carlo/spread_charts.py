"""Figures of how the flights of a Monte Carlo study are spread. Thousands of flights become some
hundred points.
"""

from typing import Any

import numpy as np

from common.columns import Column
from common.intervals import percent
from reports.document.chart import Chart, Line, Panel
from reports.document.palette import Meaning
from reports.document.panels import histogram
from reports.document.tables import number
from reports.monte_carlo.names import FROM_THE_CENTRE
from reports.run.columns import Array, clearance, figure, radii_differ
from reports.run.run_data import RunData

CURVE_POINTS = 400
"""Points of a cumulative curve at most."""

_SHOWN = 0.005
"""Fraction of flights at an end that go into the outermost bars of a histogram."""

_NEARER = 0.9
"""Fraction of flights that the curve of the nearest goes up to."""


def spread_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return how the clearance and the other figures of the flights are spread."""
    rows = run.summary
    near = clearance(rows)
    counted_near = histogram(
        [(_within(near, lowest=0.0), "flights", Meaning.FLOWN)],
        run.column("clearance_m").label,
        [(0.0, "r_min")],
    )
    if counted_near is None:
        return []
    kept = Chart(
        name="clearance",
        caption="Closest approach of each flight beyond r_min: flights counted, the farthest half per cent in the last bar;"
        " and the fraction of flights that came as near or nearer, with the intervals of its quantiles. The latter's ordinate is"
        f" logarithmic to show the few nearest, and its abscissa ends at the nearest {percent(_NEARER)} of the flights:"
        f" the farthest came to {number(np.nanmax(near), '{:.0f} m')}.",
        panels=[counted_near, _tail(near, statistics, run.column("clearance_m"))],
        columns=2,
        panel_height=0.4,
    )
    without = FROM_THE_CENTRE if radii_differ(rows) else ("min_distance_m", "crossing_clearance_m")
    counted = [
        _counted(run.column(name), figure(rows, name), found["quantiles"])
        for name, found in statistics["figures"].items()
        if name not in (*without, "clearance_m")
    ]
    panels = [panel for panel in counted if panel is not None]
    others = Chart(
        name="spread",
        caption="Flights counted by their other figures, of those that have them. The lowest and the highest half per cent are"
        " in the outermost bars.",
        panels=panels,
        columns=2,
        panel_height=0.34,
    )
    return [kept, *([others] if panels else [])]


def _within(values: Array, lowest: float = _SHOWN) -> Array:
    """Return known values, a fraction of the ``lowest`` and ``_SHOWN`` of the highest moved to
    where the others end.
    """
    known = values[np.isfinite(values)]
    return np.clip(known, *np.quantile(known, [lowest, 1.0 - _SHOWN])) if len(known) else known


def _counted(of: Column, values: Array, quantiles: list[dict[str, Any]]) -> Panel | None:
    label = "quantiles 5 %, 50 %, 95 %"
    marks = [
        (of.scale * q["value"], label)
        for q in quantiles
        if q["probability"] in (0.05, 0.5, 0.95) and q["value"] is not None
    ]
    return histogram(
        [(of.scale * _within(values), "flights", Meaning.FLOWN)],
        of.label,
        marks,
        upright_colour="black",
    )


def _tail(near: Array, statistics: dict[str, Any], of: Column) -> Panel:
    x, fraction = cumulative(near)
    every = statistics["figures"]["clearance_m"]["quantiles"]
    quantiles = [q for q in every if q["probability"] <= 0.5 and None not in (q["low"], q["high"])]
    gap = np.nan
    ends = np.array([end for q in quantiles for end in (q["low"], q["high"], gap)])
    heights = np.array(
        [
            height
            for q in quantiles
            for height in (100.0 * q["probability"], 100.0 * q["probability"], gap)
        ]
    )
    least = 100.0 * float(fraction[0])
    far = float(np.quantile(near[np.isfinite(near)], _NEARER))
    nearest = min(0.0, float(x[0]))
    return Panel(
        x_label=of.label,
        y_label="Flights as near or nearer [%]",
        lines=[
            Line(x=x, y=100.0 * fraction, label="flights", colour=Meaning.FLOWN),
            Line(x=ends, y=heights, label="interval of a quantile", colour="black"),
            Line(
                x=np.zeros(2),
                y=np.array([0.7 * least, 100.0]),
                label="r_min",
                colour=Meaning.LIMIT,
                style="dash",
            ),
        ],
        log_y=True,
        x_range=(nearest - 0.04 * (far - nearest), far),
        y_range=(0.7 * least, 130.0),
    )


def cumulative(values: Array) -> tuple[Array, Array]:
    """Return rising values, all of the lowest and ever fewer of the others, and the fraction of all
    known up to each.
    """
    known = np.sort(values[np.isfinite(values)])
    ranks = np.unique(np.geomspace(1.0, len(known), CURVE_POINTS).round().astype(np.int64))
    return known[ranks - 1], ranks / len(known)
