"""Figures of how the flights of a Monte Carlo study are spread. Thousands of flights become some
hundred points.
"""

from typing import Any

import numpy as np

from common.columns import Column
from common.intervals import percent
from reports.document.chart import Chart, Line, Panel, upright
from reports.document.palette import Meaning
from reports.document.panels import histogram
from reports.run.columns import Array, clearance
from reports.run.run_data import RunData

CURVE_POINTS = 400
"""Points of a cumulative curve at most."""

_FARTHEST = 0.005
"""Fraction of flights, the farthest, that go into the last bar of a histogram."""

_NEARER = 0.9
"""Fraction of flights that the curve of the nearest goes up to."""


_KEPT = (
    "Flights by their closest approach beyond r_min, the farthest half per cent in the last bar;"
    " and the share that came as near, log scale, with intervals of its quantiles, cut at {nearer}."
    " The farthest came to {farthest:.0f} m."
)


def spread_charts(run: RunData, statistics: dict[str, Any]) -> list[Chart]:
    """Return how the clearances of the flights are spread."""
    rows = run.summary
    near = clearance(rows)
    counted_near = histogram(
        [(_gathered(near), "flights", Meaning.FLOWN)],
        run.column("clearance_m").label,
        [(0.0, "r_min")],
    )
    if counted_near is None:
        return []
    kept = Chart(
        name="clearance",
        caption=_KEPT.format(nearer=percent(_NEARER), farthest=np.nanmax(near)),
        panels=[counted_near, _tail(near, statistics, run.column("clearance_m"))],
        columns=2,
        panel_height=0.4,
    )
    return [kept]


def _gathered(values: Array) -> Array:
    """Return known values with the farthest few moved to where the others end."""
    known = values[np.isfinite(values)]
    return np.minimum(known, np.quantile(known, 1.0 - _FARTHEST)) if len(known) else known


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
            upright(0.0, (0.7 * least, 100.0), "r_min"),
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
