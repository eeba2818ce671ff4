"""Draw charts with matplotlib, for print."""

from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.ticker import NullLocator

from reports.document.chart import COLOURS, FILL_OPACITY, SCALE, Chart, Line, Panel
from reports.run.columns import Array

WIDTH_INCHES = 7.0
"""Width of a figure: the text width of an A4 page."""

_LEGEND_CHARACTERS = 105
"""What fits beside each other in a legend line of the figure's width."""

_DECADES = 1e3
"""Ratio of the ends of a logarithmic axis from which it marks powers of ten alone."""

_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.edgecolor": "#999999",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "svg.fonttype": "path",
    "svg.hashsalt": "report",
}

_LINE_STYLES: dict[str, dict[str, Any]] = {
    "solid": {"linestyle": "-", "linewidth": 1.1},
    "dash": {"linestyle": "--", "linewidth": 1.1},
    "dot": {"linestyle": ":", "linewidth": 1.3},
    "points": {"linestyle": "none", "marker": "o", "markersize": 3.6},
    "diamonds": {"linestyle": "none", "marker": "D", "markersize": 3.2},
}


def draw(chart: Chart) -> Figure:
    """Return the chart as a matplotlib figure."""
    with rc_context(_STYLE):
        height = WIDTH_INCHES * chart.panel_height * chart.rows + 0.35
        figure = Figure(figsize=(WIDTH_INCHES, height), layout="constrained")
        axes = figure.subplots(
            chart.rows,
            chart.columns,
            squeeze=False,
            sharex="col" if chart.share_x else "none",
        )
        handles: dict[str, Any] = {}
        scale, shaded = chart.scale, None
        for i, panel in enumerate(chart.panels):
            ax = axes[i // chart.columns][i % chart.columns]
            for line in panel.lines:
                if line.values is not None and scale:
                    shaded = _draw_shaded(ax, line, line.values, scale)
                    continue
                handle = _draw_line(ax, line)
                if line.label:
                    handles.setdefault(line.label, handle)
            _dress(ax, panel, last_row=i + chart.columns >= len(chart.panels) or not chart.share_x)
        for ax in axes.flat[len(chart.panels) :]:
            ax.set_axis_off()
        for ax in axes.flat[max(0, len(chart.panels) - chart.columns) : len(chart.panels)]:
            # The last of a column may not be in the last row, where figures are written beside a shared axis.
            ax.tick_params(labelbottom=True)
        if shaded is not None:
            figure.colorbar(shaded, ax=list(axes.flat), label=chart.scale_label, shrink=0.85, pad=0.015)
        if len(handles) > 1:
            columns = max(1, min(len(handles), _LEGEND_CHARACTERS // (max(len(label) for label in handles) + 6)))
            figure.legend(list(handles.values()), list(handles), loc="outside upper center", ncols=columns, fontsize=7.5)
        return figure


def _draw_line(ax: Any, line: Line) -> Any:
    style = _LINE_STYLES[line.style]
    colour = COLOURS[line.colour]
    if line.fill:
        ax.fill(line.x, line.y, color=colour, alpha=FILL_OPACITY, linewidth=0.0)
    if line.error is not None:
        return ax.errorbar(line.x, line.y, yerr=line.error, color=colour, capsize=2, elinewidth=0.8, **style)
    return ax.plot(line.x, line.y, color=colour, rasterized=len(line.x) > 4000, **style)[0]


def _draw_shaded(ax: Any, line: Line, values: Array, scale: tuple[float, float]) -> Any:
    """Draw points with the colours of their values, the largest last, and return what a colour scale is made for."""
    order = np.argsort(values)
    order = order[np.isfinite(values[order])]
    colours = {"c": values[order], "cmap": f"{SCALE.lower()}_r", "vmin": scale[0], "vmax": scale[1]}
    return ax.scatter(line.x[order], line.y[order], s=4.0, linewidths=0.0, **colours)


def _dress(ax: Any, panel: Panel, *, last_row: bool) -> None:
    if last_row:
        ax.set_xlabel(panel.x_label)
    ax.set_ylabel(panel.y_label)
    if panel.title:
        ax.set_title(panel.title)
    if panel.log_x:
        ax.set_xscale("log")
    if panel.log_y:
        ax.set_yscale("log")
        if panel.y_range and panel.y_range[1] > _DECADES * panel.y_range[0]:
            # Ticks between powers of ten would crowd the axis, and take most of the time to draw it.
            ax.yaxis.set_minor_locator(NullLocator())
    for note in panel.notes:
        ax.text(note.x, note.y, note.text, color=COLOURS["grey"], fontsize=7.0, ha=note.align, va="center", clip_on=True)
    if panel.y_names:
        ax.set_yticks([value for value, _ in panel.y_names], [name for _, name in panel.y_names])
    if panel.x_range:
        ax.set_xlim(*panel.x_range)
    if panel.y_range:
        ax.set_ylim(*panel.y_range)
    if panel.equal:
        ax.set_aspect("equal", adjustable="box" if panel.x_range and panel.y_range else "datalim")
