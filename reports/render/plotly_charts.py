"""Draw charts with Plotly, for the screen."""

import math
from typing import Any

import numpy as np
import plotly.graph_objects as go
from plotly.subplots import make_subplots

from reports.document.chart import COLOURS, FILL_OPACITY, SCALE, Chart, Line, Panel
from reports.run.columns import Array

WIDTH_PIXELS = 980
"""Width that heights are made for; figures shrink with the window."""

_TOP, _BOTTOM = 95, 55
"""Room above the panels for mode bar, legend and titles, and below them for labels [px]."""

_MODES: dict[str, dict[str, Any]] = {
    "solid": {"mode": "lines", "line": {"dash": "solid", "width": 1.6}},
    "dash": {"mode": "lines", "line": {"dash": "dash", "width": 1.6}},
    "dot": {"mode": "lines", "line": {"dash": "dot", "width": 1.8}},
    "points": {"mode": "markers", "marker": {"size": 7}},
    "diamonds": {"mode": "markers", "marker": {"size": 7, "symbol": "diamond"}},
}


def draw(chart: Chart) -> go.Figure:
    """Return the chart as a Plotly figure."""
    height = round(WIDTH_PIXELS * chart.panel_height * chart.rows) + _TOP + _BOTTOM
    inner = height - _TOP - _BOTTOM
    titled = any(panel.title for panel in chart.panels)
    gap = 14 if chart.share_x else 62 + 30 * titled
    figure = make_subplots(
        rows=chart.rows,
        cols=chart.columns,
        shared_xaxes=chart.share_x,
        subplot_titles=[panel.title for panel in chart.panels] if titled else None,
        horizontal_spacing=0.09,
        vertical_spacing=gap / inner if chart.rows > 1 else 0.0,
    )
    seen, scale, shaded = {""}, chart.scale, False
    for i, panel in enumerate(chart.panels):
        row, column = i // chart.columns + 1, i % chart.columns + 1
        for line in panel.lines:
            trace = _trace(line, show=line.label not in seen)
            if line.values is not None and scale:
                _shade(trace, line.values, scale, chart.scale_label if not shaded else "")
                shaded = True
            figure.add_trace(trace, row=row, col=column)
            seen.add(line.label)
        _dress(figure, panel, row, column, show_x=not chart.share_x or i + chart.columns >= len(chart.panels))
    figure.update_layout(
        height=height,
        margin={"l": 70, "r": 20, "t": _TOP, "b": _BOTTOM},
        template="plotly_white",
        font={"size": 13},
        legend={"orientation": "h", "yanchor": "bottom", "y": 1.0 + (28 if titled else 8) / inner, "x": 0.0},
        showlegend=len(seen) > 2,
        hovermode="closest",
    )
    return figure


def _trace(line: Line, *, show: bool) -> go.Scatter:
    style = {key: dict(value) if isinstance(value, dict) else value for key, value in _MODES[line.style].items()}
    style["line" if "line" in style else "marker"]["color"] = COLOURS[line.colour]
    if line.error is not None:
        style["error_y"] = {"type": "data", "array": line.error.astype(np.float32), "thickness": 1}
    if line.fill:
        style |= {"fill": "toself", "fillcolor": _tint(COLOURS[line.colour])}
    return go.Scatter(
        x=line.x.astype(np.float32), y=line.y.astype(np.float32), name=line.label, legendgroup=line.label, showlegend=show, **style
    )


def _shade(trace: go.Scatter, values: Array, scale: tuple[float, float], label: str) -> None:
    """Give the points of a trace the colours of their values, and, with a label, a colour scale."""
    bar = {"title": {"text": label, "side": "right"}, "thickness": 14, "outlinewidth": 0}
    trace.update(
        mode="markers",
        showlegend=False,
        marker={
            "color": values.astype(np.float32), "colorscale": SCALE, "reversescale": True, "cmin": scale[0], "cmax": scale[1],
            "size": 4, "showscale": bool(label), "colorbar": bar if label else None,
        },
    )  # fmt: skip


def _tint(colour: str) -> str:
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{FILL_OPACITY})"


def _dress(figure: go.Figure, panel: Panel, row: int, column: int, *, show_x: bool) -> None:
    x_options: dict[str, Any] = {"title": {"text": panel.x_label, "standoff": 6} if show_x else None, "showticklabels": show_x}
    # Figures of four digits and names are wide: the title stays clear of them only at a given distance.
    y_options: dict[str, Any] = {"title": {"text": panel.y_label, "standoff": 8}}
    if panel.log_x:
        x_options["type"] = "log"
    if panel.log_y:
        # Ticks at powers of ten alone: figures in between would crowd an axis of many decades.
        y_options |= {"type": "log", "dtick": 1}
    if panel.x_range:
        x_options["range"] = _limits(panel.x_range, log=panel.log_x)
    if panel.y_range:
        y_options["range"] = _limits(panel.y_range, log=panel.log_y)
    if panel.y_names:
        y_options |= {"tickvals": [value for value, _ in panel.y_names], "ticktext": [name for _, name in panel.y_names]}
    # Plotly would write 20k and 50µ, before a unit that has a prefix of its own. Decades are too many for plain figures.
    x_options["exponentformat"] = "power" if panel.log_x else "none"
    y_options["exponentformat"] = "power" if panel.log_y else "none"
    figure.update_xaxes(**x_options, row=row, col=column)
    figure.update_yaxes(**y_options, row=row, col=column)
    for note in panel.notes:
        figure.add_annotation(
            x=note.x, y=note.y, text=note.text, xanchor=note.align, showarrow=False,
            font={"size": 11, "color": COLOURS["grey"]}, row=row, col=column,
        )  # fmt: skip
    if panel.equal:
        free_x, free_y = _equal_ranges(panel)
        x_range, y_range = list(panel.x_range or free_x), list(panel.y_range or free_y)
        figure.update_xaxes(range=x_range, row=row, col=column)
        figure.update_yaxes(range=y_range, row=row, col=column)
        axis = next(figure.select_xaxes(row=row, col=column)).plotly_name.replace("axis", "")
        figure.update_yaxes(scaleanchor=axis, scaleratio=1, constrain="domain", row=row, col=column)
        figure.update_xaxes(constrain="domain", row=row, col=column)


def _limits(limits: tuple[float, float], *, log: bool) -> list[float]:
    """Return limits of an axis as Plotly wants them: of a logarithmic one, their powers of ten."""
    return [math.log10(limit) for limit in limits] if log else list(limits)


def _equal_ranges(panel: Panel) -> tuple[list[float], list[float]]:
    """Return ranges that hold every curve with a little to spare, and are not much narrower one way than the other."""
    x, y = (np.concatenate(curves) for curves in zip(*((line.x, line.y) for line in panel.lines), strict=True))
    (x_middle, x_half), (y_middle, y_half) = (
        (float(np.nanmin(v) + np.nanmax(v)) / 2.0, 0.54 * float(np.nanmax(v) - np.nanmin(v))) for v in (x, y)
    )
    x_half, y_half = max(x_half, 0.4 * y_half), max(y_half, 0.4 * x_half)
    return [x_middle - x_half, x_middle + x_half], [y_middle - y_half, y_middle + y_half]
