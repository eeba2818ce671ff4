"""Charts as figures of Plotly, for the screen: what its library in the page is given, as plain data."""

import base64
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from reports.document.chart import COLOURS, FILL_OPACITY, SCALE, Chart, Line, Panel
from reports.run.columns import Array

WIDTH_PIXELS = 980
"""Width that heights are made for; figures shrink with the window."""

_TOP, _BOTTOM = 95, 55
"""Room above the panels for mode bar, legend and titles, and below them for labels [px]."""

_BESIDE = 0.09
"""Room between panels that stand side by side, over the width of all [-]."""

_BELOW, _BELOW_LABELS, _TITLE = 14, 62, 30
"""Room between panels that stand one below the other: with a shared abscissa, with labels between them, and for a title [px]."""

_MODES: dict[str, dict[str, Any]] = {
    "solid": {"mode": "lines", "line": {"dash": "solid", "width": 1.6}},
    "dash": {"mode": "lines", "line": {"dash": "dash", "width": 1.6}},
    "dot": {"mode": "lines", "line": {"dash": "dot", "width": 1.8}},
    "points": {"mode": "markers", "marker": {"size": 7}},
    "diamonds": {"mode": "markers", "marker": {"size": 7, "symbol": "diamond"}},
}

Data = dict[str, Any]


def draw(chart: Chart) -> Data:
    """Return the chart as ``data`` and ``layout`` of a Plotly figure."""
    height = round(WIDTH_PIXELS * chart.panel_height * chart.rows) + _TOP + _BOTTOM
    inner = height - _TOP - _BOTTOM
    titled = any(panel.title for panel in chart.panels)
    traces: list[Data] = []
    layout: Data = {"annotations": []}
    seen, scale, shaded = {""}, chart.scale, False
    for i, panel in enumerate(chart.panels):
        number = str(i + 1) if i else ""
        for line in panel.lines:
            trace = _trace(line, show=line.label not in seen) | {"xaxis": f"x{number}", "yaxis": f"y{number}"}
            if line.values is not None and scale:
                trace |= _shade(line.values, scale, "" if shaded else chart.scale_label)
                shaded = True
            traces.append(trace)
            seen.add(line.label)
        last = i + chart.columns >= len(chart.panels)
        x, y = _axes(panel, number, show_x=last or not chart.share_x)
        x["domain"], y["domain"] = _domains(chart, i, inner, titled=titled)
        if chart.share_x and not last:
            # The lowest panel of the column, which need not be in the last row.
            x["matches"] = f"x{i + chart.columns * ((len(chart.panels) - 1 - i) // chart.columns) + 1}"
        layout |= {f"xaxis{number}": x, f"yaxis{number}": y}
        layout["annotations"] += _words(panel, number, x["domain"], y["domain"])
    layout |= {
        "height": height,
        "margin": {"l": 70, "r": 20, "t": _TOP, "b": _BOTTOM},
        "font": {"size": 13},
        "legend": {"orientation": "h", "yanchor": "bottom", "y": 1.0 + (28 if titled else 8) / inner, "x": 0.0},
        "showlegend": len(seen) > 2,
        "hovermode": "closest",
    }
    return {"data": traces, "layout": layout}


def _domains(chart: Chart, index: int, inner: int, *, titled: bool) -> tuple[list[float], list[float]]:
    """Return where a panel lies, from left to right and from bottom to top, in shares of the room for all of them."""
    row, column = divmod(index, chart.columns)
    gap = (_BELOW if chart.share_x else _BELOW_LABELS + _TITLE * titled) / inner
    width, height = (1.0 - _BESIDE * (chart.columns - 1)) / chart.columns, (1.0 - gap * (chart.rows - 1)) / chart.rows
    left, bottom = column * (width + _BESIDE), (chart.rows - 1 - row) * (height + gap)
    return [left, min(1.0, left + width)], [bottom, min(1.0, bottom + height)]


def _trace(line: Line, *, show: bool) -> Data:
    style = {key: dict(value) if isinstance(value, Mapping) else value for key, value in _MODES[line.style].items()}
    style["line" if "line" in style else "marker"]["color"] = COLOURS[line.colour]
    if line.error is not None:
        style["error_y"] = {"type": "data", "array": _numbers(line.error), "thickness": 1}
    if line.fill:
        style |= {"fill": "toself", "fillcolor": _tint(COLOURS[line.colour])}
    names = {"name": line.label, "legendgroup": line.label, "showlegend": show}
    return {"type": "scatter", "x": _numbers(line.x), "y": _numbers(line.y), **names, **style}


def _numbers(values: Array) -> Data | list[float]:
    """Return numbers as Plotly reads them fastest, in single precision: a picture needs no more."""
    if not len(values):
        return []
    return {"dtype": "f4", "bdata": base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii")}


def _shade(values: Array, scale: tuple[float, float], label: str) -> Data:
    """Return what gives the points of a trace the colours of their values, and, with a label, a colour scale."""
    marker: Data = {"color": _numbers(values), "colorscale": SCALE, "reversescale": True, "size": 4}
    marker |= {"cmin": scale[0], "cmax": scale[1]}
    if label:
        bar = {"title": {"text": label, "side": "right"}, "thickness": 14, "outlinewidth": 0}
        marker |= {"showscale": True, "colorbar": bar}
    return {"mode": "markers", "showlegend": False, "marker": marker}


def _tint(colour: str) -> str:
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{FILL_OPACITY})"


def _axes(panel: Panel, number: str, *, show_x: bool) -> tuple[Data, Data]:
    """Return abscissa and ordinate of a panel."""
    x: Data = {"anchor": f"y{number}", "showticklabels": show_x}
    if show_x:
        x["title"] = {"text": panel.x_label, "standoff": 6}
    # Figures of four digits and names are wide: the title stays clear of them only at a given distance.
    y: Data = {"anchor": f"x{number}", "title": {"text": panel.y_label, "standoff": 8}}
    if panel.log_x:
        x["type"] = "log"
    if panel.log_y:
        # Ticks at powers of ten alone: figures in between would crowd an axis of many decades.
        y |= {"type": "log", "dtick": 1}
    x_range, y_range = panel.x_range, panel.y_range
    if panel.equal:
        free_x, free_y = _equal_ranges(panel)
        x_range, y_range = x_range or free_x, y_range or free_y
        x["constrain"] = "domain"
        y |= {"scaleanchor": f"x{number}", "scaleratio": 1, "constrain": "domain"}
    if x_range:
        x["range"] = _limits(x_range, log=panel.log_x)
    if y_range:
        y["range"] = _limits(y_range, log=panel.log_y)
    if panel.y_names:
        y |= {"tickvals": [value for value, _ in panel.y_names], "ticktext": [name for _, name in panel.y_names]}
    # Plotly would write 20k and 50µ, before a unit that has a prefix of its own. Decades are too many for plain figures.
    x["exponentformat"] = "power" if panel.log_x else "none"
    y["exponentformat"] = "power" if panel.log_y else "none"
    return x, y


def _words(panel: Panel, number: str, across: list[float], up: list[float]) -> list[Data]:
    """Return the title above a panel, and the words among its curves."""
    words: list[Data] = []
    if panel.title:
        place = {"x": sum(across) / 2.0, "y": up[1], "xref": "paper", "yref": "paper", "xanchor": "center", "yanchor": "bottom"}
        words.append({"text": panel.title, "font": {"size": 16}, "showarrow": False, **place})
    for note in panel.notes:
        place = {"x": note.x, "y": note.y, "xref": f"x{number}", "yref": f"y{number}", "xanchor": note.align}
        words.append({"text": note.text, "font": {"size": 11, "color": COLOURS["grey"]}, "showarrow": False, **place})
    return words


def _limits(limits: tuple[float, float], *, log: bool) -> list[float]:
    """Return limits of an axis as Plotly wants them: of a logarithmic one, their powers of ten."""
    return [math.log10(limit) for limit in limits] if log else list(limits)


def _equal_ranges(panel: Panel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return ranges that hold every curve with a little to spare, and are not much narrower one way than the other."""
    x, y = (np.concatenate(curves) for curves in zip(*((line.x, line.y) for line in panel.lines), strict=True))
    (x_middle, x_half), (y_middle, y_half) = (
        (float(np.nanmin(v) + np.nanmax(v)) / 2.0, 0.54 * float(np.nanmax(v) - np.nanmin(v))) for v in (x, y)
    )
    x_half, y_half = max(x_half, 0.4 * y_half), max(y_half, 0.4 * x_half)
    return (x_middle - x_half, x_middle + x_half), (y_middle - y_half, y_middle + y_half)
