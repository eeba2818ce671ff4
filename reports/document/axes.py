"""The unit that suits an axis."""

from dataclasses import replace

import numpy as np

from reports.document.chart import Panel
from reports.run.columns import Array

_FAR = 10_000.0
"""Distances from which axes are in kilometres [m]."""


def in_kilometres(panel: Panel) -> Panel:
    """Return a panel with kilometres where metres would have five digits: on both axes if they are equally long."""
    x = _reach([np.array(panel.x_range)] if panel.x_range else [line.x for line in panel.lines])
    y = _reach([np.array(panel.y_range)] if panel.y_range else [line.y for line in panel.lines])
    if panel.equal:
        x = y = max(x, y)
    if x >= _FAR and panel.x_label.endswith("[m]"):
        lines = [replace(line, x=line.x / 1000.0) for line in panel.lines]
        panel = replace(panel, lines=lines, x_label=panel.x_label.replace("[m]", "[km]"), x_range=_thousandth(panel.x_range))
    if y >= _FAR and panel.y_label.endswith("[m]"):
        lines = [replace(line, y=line.y / 1000.0) for line in panel.lines]
        panel = replace(panel, lines=lines, y_label=panel.y_label.replace("[m]", "[km]"), y_range=_thousandth(panel.y_range))
    return panel


def _reach(curves: list[Array]) -> float:
    known = [np.abs(curve[np.isfinite(curve)]) for curve in curves]
    return max((float(curve.max()) for curve in known if len(curve)), default=0.0)


def _thousandth(limits: tuple[float, float] | None) -> tuple[float, float] | None:
    return (limits[0] / 1000.0, limits[1] / 1000.0) if limits else None
