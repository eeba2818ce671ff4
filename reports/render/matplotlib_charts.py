"""Draw charts with matplotlib, for print."""

from functools import lru_cache
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.textpath import TextPath
from matplotlib.ticker import MaxNLocator, NullLocator

from reports.document.axes import about_values, log_axis, mark_text, with_one_abscissa, wrapped
from reports.document.chart import Chart, Line, Panel
from reports.document.palette import BAND_OPACITY, COLOURS, INK, SCALE
from reports.run.columns import Array

WIDTH_INCHES = 7.0
"""Width of a figure: the text width of an A4 page."""

_LEGEND_CHARACTERS = 118
"""What fits beside each other in a legend line of the figure's width."""

_TITLE_SIZE, _SMALL_TITLE_SIZE = 8.5, 7.0
"""Letters of the titles above panels, and above many side by side [pt]."""

_LEGEND_ROW = 0.16
"""Height of a row of a legend [inches]."""

_LABELS = 0.35
"""Height of a figure beyond its panels and the second row of its legend [inches]."""

_EDGE, _RIGHT, _TITLE, _TICKS, _LINE = 0.06, 0.14, 0.2, 0.28, 0.14
"""Room about a panel [inches]: where nothing is, to its right, for its title, for the marks of its
abscissa, and for a line of a label.
"""

_SCALE, _BAR = 0.75, 0.13
"""Room for a colour scale with its marks and label, and its width alone [inches]."""

_LETTER = 0.058
"""Width of a letter of a label [inches]."""

_MARKS = 0.45
"""Room of the marks of an axis and of its label, beside a panel and below it [inches]."""

_DEPTH = 2.0
"""Depth at which matplotlib draws lines: tints are drawn there, too, so that the lines of a panel
lie in their order.
"""

_STYLE: dict[Any, Any] = {
    "font.family": "DejaVu Sans",
    "font.size": 8.0,
    "axes.axisbelow": True,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.6,
    "axes.edgecolor": "#999999",
    "axes.spines.top": False,
    "axes.spines.right": False,
    # Nobody reads what has to be added to every mark.
    "axes.formatter.useoffset": False,
    "legend.frameon": False,
    # A dollar sign in a title is one.
    "text.parse_math": False,
}

_HALO = [withStroke(linewidth=1.6, foreground="white", alpha=0.8)]
"""About words among curves."""

_LINE_STYLES: dict[str, dict[str, Any]] = {
    "solid": {"linestyle": "-", "linewidth": 1.1},
    "thin": {"linestyle": "-", "linewidth": 0.6},
    "broad": {"linestyle": "-", "linewidth": 4.0, "solid_capstyle": "butt"},
    "dash": {"linestyle": "--", "linewidth": 1.1},
    "dot": {"linestyle": ":", "linewidth": 1.3},
    "points": {"linestyle": "none", "marker": "o", "markersize": 3.6},
    "dots": {"linestyle": "none", "marker": "o", "markersize": 1.8},
    "diamonds": {"linestyle": "none", "marker": "D", "markersize": 3.2},
    "ring": {
        "linestyle": "none",
        "marker": "o",
        "markersize": 6.0,
        "markerfacecolor": "none",
        "markeredgewidth": 1.2,
    },
    "square": {"linestyle": "none", "marker": "s", "markersize": 4.6},
    "cross": {
        "linestyle": "none",
        "marker": "X",
        "markersize": 6.0,
        "markeredgecolor": "white",
        "markeredgewidth": 0.5,
    },
}


Limits = tuple[float, float] | None


def draw(*charts: Chart) -> Figure:
    """Return a chart as a matplotlib figure; of several, each below the one before."""
    with rc_context(_STYLE):
        heights = [_height(chart) for chart in charts]
        figure = Figure(figsize=(WIDTH_INCHES, sum(heights)))
        top = sum(heights)
        for chart, height in zip(charts, heights, strict=True):
            _draw_on(figure, with_one_abscissa(chart), top, height)
            top -= height
        return figure


def _height(chart: Chart) -> float:
    """Return the height of a chart with its legend [inches]."""
    return WIDTH_INCHES * chart.height + _LABELS + _LEGEND_ROW * max(0, _legend_rows(chart) - 1)


def _draw_on(figure: Figure, chart: Chart, top: float, height: float) -> None:
    """Draw a chart on the stretch of a figure that begins at ``top`` above its foot [inches]."""
    axes = _axes(figure, chart)
    handles: dict[str, Any] = {}
    shaded = None
    for i, panel in enumerate(chart.panels):
        shaded = _draw_marks(axes[i], panel, handles, chart.scale) or shaded
        _dress(axes[i], panel)
        _label(axes[i], chart, i)
    scale = _SCALE if shaded is not None else 0.0
    legend = _EDGE + _LEGEND_ROW * _legend_rows(chart)
    # The marks of an axis depend on its length, and the room for them on the marks.
    for _ in range(2):
        below = _place(figure, axes, chart, (top - legend, height - legend), WIDTH_INCHES - scale)
    if shaded is not None:
        bar = (WIDTH_INCHES - scale + _EDGE, below + 0.1 * height, _BAR, 0.8 * (height - legend))
        figure.colorbar(shaded, cax=figure.add_axes(_shares(figure, *bar)), label=chart.scale_label)
    if len(handles) > 1:
        figure.legend(
            list(handles.values()),
            list(handles),
            loc="upper center",
            bbox_to_anchor=(0.5, top / figure.get_figheight()),
            borderaxespad=0.2,
            ncols=_legend_columns(list(handles)),
            fontsize=7.5,
        )


def _axes(figure: Figure, chart: Chart) -> list[Any]:
    """Return the axes of the panels, in their order; those of a column may share the abscissa."""
    axes: list[Any] = []
    for i in range(len(chart.panels)):
        above = axes[i % chart.columns] if chart.share_x and i >= chart.columns else None
        axes.append(figure.add_axes((0.1, 0.1, 1.0 / chart.columns, 0.2), sharex=above))
    return axes


def _place(
    figure: Figure, axes: list[Any], chart: Chart, down: tuple[float, float], width: float
) -> float:
    """Give each panel its place, with room for titles, marks and labels about it; return where the
    lowest begins [inches].

    Parameters
    ----------
    figure, axes, chart : what is drawn
    down : where the panels begin above the foot of the figure, and the height for all [inches]
    width : for all [inches]
    """
    top, height = down
    rows = [
        axes[first : first + chart.columns]
        for first in range(0, len(axes) - bool(chart.last_height), chart.columns)
    ]
    shares = [chart.panel_height] * len(rows)
    if chart.last_height:
        rows, shares = [*rows, axes[-1:]], [*shares, chart.last_height]
    lefts = [max(map(_beside, axes[i :: chart.columns]), default=0.0) for i in range(chart.columns)]
    wide = (width - sum(lefts) - chart.columns * _RIGHT) / chart.columns
    above, below = ([max(map(room, row)) for row in rows] for room in (_above, _below))
    scale = (height - sum(above) - sum(below)) / sum(shares)
    for row, share, title, labels in zip(rows, shares, above, below, strict=True):
        top -= title + scale * share
        left = 0.0
        for ax, margin in zip(row, lefts, strict=False):
            alone = width - margin - _RIGHT if chart.last_height and ax is axes[-1] else wide
            ax.set_position(_shares(figure, left + margin, top, alone, scale * share))
            left += margin + wide + _RIGHT
        top -= labels
    return top


def _shares(
    figure: Figure, left: float, bottom: float, width: float, height: float
) -> tuple[float, float, float, float]:
    """Return a rectangle in shares of a figure, given in inches."""
    wide, high = figure.get_size_inches()
    return left / wide, bottom / high, width / wide, height / high


def _beside(ax: Any) -> float:
    """Return the room for the marks and the label of an ordinate [inches]."""
    low, high = sorted(ax.get_ylim())
    marks = [mark for mark in ax.yaxis.get_majorticklocs() if low <= mark <= high]
    words = ax.yaxis.get_major_formatter().format_ticks(marks)
    lines = ax.get_ylabel().count("\n") + 1 if ax.get_ylabel() else 0
    return 3.0 * _EDGE + max(map(_wide, words), default=0.0) + _LINE * lines


def _above(ax: Any) -> float:
    return _TITLE if ax.get_title() else _EDGE


def _below(ax: Any) -> float:
    """Return the room for the marks and the label of an abscissa [inches]."""
    if not ax.xaxis.get_tick_params()["labelbottom"]:
        return _EDGE
    return _TICKS + (_LINE * (ax.get_xlabel().count("\n") + 1) if ax.get_xlabel() else 0.0)


@lru_cache(maxsize=1024)
def _wide(words: str) -> float:
    """Return the width of words in the letters of marks [inches]."""
    if not words.strip():
        return 0.0
    return float(TextPath((0.0, 0.0), words, size=_STYLE["font.size"]).get_extents().width) / 72.0


def _draw_marks(ax: Any, panel: Panel, handles: dict[str, Any], scale: Limits) -> Any:
    """Draw lines and bands, add what the legend has of them, and return what a colour scale is made
    for, if there is anything.
    """
    shaded = None
    for line in panel.lines:
        if line.values is not None and scale:
            shaded = _draw_shaded(ax, line, line.values, scale)
            continue
        handle = _draw_line(ax, line)
        if line.label:
            handles.setdefault(line.label, handle)
    for band in panel.bands:
        tint = {"color": COLOURS[band.colour], "alpha": BAND_OPACITY, "linewidth": 0.0}
        handles.setdefault(band.label, ax.axvspan(band.start, band.end, **tint))
    return shaded


def _legend_columns(labels: list[str]) -> int:
    return max(1, min(len(labels), _LEGEND_CHARACTERS // (max(len(label) for label in labels) + 6)))


def _legend_rows(chart: Chart) -> int:
    """Return how many rows a legend has; none where a single entry would say nothing."""
    labels = chart.labels
    return -(-len(labels) // _legend_columns(labels)) if len(labels) > 1 else 0


def _draw_line(ax: Any, line: Line) -> Any:
    style = _LINE_STYLES[line.style]
    colour = COLOURS[line.colour]
    if line.fill:
        ax.fill(line.x, line.y, color=colour, alpha=line.opacity, linewidth=0.0, zorder=_DEPTH)
    if line.error is not None:
        return ax.errorbar(
            line.x, line.y, yerr=line.error, color=colour, capsize=2, elinewidth=0.8, **style
        )
    return ax.plot(line.x, line.y, color=colour, rasterized=len(line.x) > 4000, **style)[0]


def _draw_shaded(ax: Any, line: Line, values: Array, scale: tuple[float, float]) -> Any:
    """Draw points with the colours of their values, the largest last, and return what a colour
    scale is made for.
    """
    order = np.argsort(values)
    order = order[np.isfinite(values[order])]
    colours = {"c": values[order], "cmap": f"{SCALE.lower()}_r", "vmin": scale[0], "vmax": scale[1]}
    return ax.scatter(line.x[order], line.y[order], s=4.0, linewidths=0.0, **colours)


def _label(ax: Any, chart: Chart, index: int) -> None:
    """Write title and labels of a panel; labels that are longer than the panel have two lines."""
    panel = chart.panels[index]
    if panel.title:
        ax.set_title(panel.title, fontsize=_SMALL_TITLE_SIZE if chart.crowded else _TITLE_SIZE)
    names = max((len(name) for shown in chart.panels for _, name in shown.y_names), default=0)
    wide = chart.is_wide(index)
    width = WIDTH_INCHES / (1 if wide else chart.columns) - _MARKS - _LETTER * names / chart.columns
    height = WIDTH_INCHES * (chart.last_height if wide else chart.panel_height) - _MARKS / (
        chart.rows if chart.share_x else 1
    )
    lowest = index + chart.columns >= len(chart.panels) or not chart.share_x
    ax.tick_params(labelbottom=lowest)
    if lowest:
        ax.set_xlabel("\n".join(wrapped(panel.x_label, width / _LETTER)))
    ax.set_ylabel("\n".join(wrapped(panel.y_label, height / _LETTER)))


def _dress(ax: Any, panel: Panel) -> None:
    x_range = _mark(
        ax,
        "x",
        [line.x for line in panel.lines],
        panel.x_range,
        log=panel.log_x,
        whole=panel.x_whole,
    )
    y_range = _mark(
        ax,
        "y",
        [line.y for line in panel.lines],
        panel.y_range,
        log=panel.log_y,
        whole=panel.y_whole,
    )
    for note in panel.notes:
        ax.text(
            note.x,
            note.y,
            note.text,
            color=INK,
            fontsize=7.0,
            ha=note.align,
            va="center",
            clip_on=True,
            path_effects=_HALO,
        )
    if panel.y_names:
        ax.set_yticks([value for value, _ in panel.y_names], [name for _, name in panel.y_names])
    if x_range:
        ax.set_xlim(*x_range)
    if y_range:
        ax.set_ylim(*y_range)
    if panel.equal:
        ax.set_aspect("equal", adjustable="box" if panel.x_range and panel.y_range else "datalim")


def _mark(
    ax: Any, name: str, curves: list[Array], limits: Limits, *, log: bool, whole: bool
) -> Limits:
    """Set scale and marks of an axis, "x" or "y", and return its limits."""
    axis = ax.xaxis if name == "x" else ax.yaxis
    if log:
        limits, marks = log_axis(limits, curves)
        ax.set(**{f"{name}scale": "log"})
        axis.set_ticks(marks, [mark_text(mark) for mark in marks])
        # Ticks between those would crowd the axis, and take most of the time to draw it.
        axis.set_minor_locator(NullLocator())
    else:
        limits = limits or about_values(curves)
    if whole:
        axis.set_major_locator(MaxNLocator(nbins=6, integer=True))
    return limits
