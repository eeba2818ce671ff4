"""Charts for the screen: each panel a figure of Plotly's, as plain data. The page places the panels
beside or below each other, as its width allows, and writes the legend of all of them.
"""

import base64
import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from reports.document.axes import about_values, log_axis, mark_text, with_one_abscissa, wrapped
from reports.document.chart import Chart, Line, Panel
from reports.document.palette import BAND_OPACITY, COLOURS, INK, SCALE
from reports.run.columns import Array

_WIDTH, _LETTER = 980.0, 8.0
"""Width that labels are broken for, and width of a letter of theirs [px]."""

_LEFT, _RIGHT, _TOP, _BOTTOM, _TITLE, _LINE = 52, 14, 8, 46, 24, 17
"""Room about a panel, for its title, and for a line of a label [px]."""

_TITLE_SIZE, _SMALL_TITLE_SIZE = 16, 12
"""Letters of the titles above panels, and above many side by side [px]."""

_ONE_BY_ONE = 3
"""Panels side by side up to which each has a row on a narrow screen; of more, two stay side by
side.
"""

_HIGHEST, _MAP, _UPRIGHT = 0.6, 0.85, 1.1
"""On a narrow screen, over its width: height of a panel at most, width of a map, and its height at
most.
"""

_HALO = "rgba(255,255,255,0.7)"
"""Colour behind words among curves."""

_FEW = 8.0
"""Range of whole numbers from which Plotly marks whole numbers by itself."""

_MODES: dict[str, dict[str, Any]] = {
    "solid": {"mode": "lines", "line": {"dash": "solid", "width": 1.6}},
    "thin": {"mode": "lines", "line": {"dash": "solid", "width": 0.9}},
    "broad": {"mode": "lines", "line": {"dash": "solid", "width": 6}},
    "dash": {"mode": "lines", "line": {"dash": "dash", "width": 1.6}},
    "dot": {"mode": "lines", "line": {"dash": "dot", "width": 1.8}},
    "points": {"mode": "markers", "marker": {"size": 7}},
    "dots": {"mode": "markers", "marker": {"size": 4}},
    "diamonds": {"mode": "markers", "marker": {"size": 7, "symbol": "diamond"}},
    "ring": {
        "mode": "markers",
        "marker": {"size": 11, "symbol": "circle-open", "line": {"width": 2}},
    },
    "square": {"mode": "markers", "marker": {"size": 9, "symbol": "square"}},
    "cross": {
        "mode": "markers",
        "marker": {"size": 11, "symbol": "x", "line": {"width": 1, "color": "#fff"}},
    },
}

Data = dict[str, Any]


def draw(chart: Chart) -> Data:
    """Return a chart as the page reads it: its columns on a wide and on a narrow screen, the bands
    of its legend by their colour, and its panels, each with ``data`` and ``layout`` of Plotly's,
    its heights over the width of the page, and whether it is as wide as that.
    """
    chart = with_one_abscissa(chart)
    bands = {band.label: COLOURS[band.colour] for panel in chart.panels for band in panel.bands}
    return {
        "columns": [chart.columns, 1 if chart.columns <= _ONE_BY_ONE else 2],
        "bands": bands,
        "panels": [_panel(chart, i) for i in range(len(chart.panels))],
    }


def _panel(chart: Chart, index: int) -> Data:
    panel, wide = chart.panels[index], chart.is_wide(index)
    height = chart.last_height if wide else chart.panel_height
    shaded = [i for i, of in enumerate(chart.panels) if _is_shaded(of)]
    return {
        "data": [
            _trace(line, chart, scale=shaded[-1:] == [index] and line is panel.lines[0])
            for line in panel.lines
        ],
        "layout": _layout(chart, panel, 1 if wide else chart.columns, height),
        "wide": wide,
        "height": round(height, 4),
        "narrow": round(_narrow_height(chart, panel, height), 4),
    }


def _is_shaded(panel: Panel) -> bool:
    return any(line.values is not None for line in panel.lines)


def _narrow_height(chart: Chart, panel: Panel, height: float) -> float:
    """Return the height of a panel on a narrow screen, over its width."""
    beside = 1 if chart.columns <= _ONE_BY_ONE else 2
    alone = height * chart.columns / beside
    if panel.equal and panel.x_range and panel.y_range:
        upright = (panel.y_range[1] - panel.y_range[0]) / (panel.x_range[1] - panel.x_range[0])
        return max(alone, min(_UPRIGHT, _MAP * upright))
    return min(alone, max(height, _HIGHEST))


def _trace(line: Line, chart: Chart, *, scale: bool) -> Data:
    style = {
        key: dict(value) if isinstance(value, Mapping) else value
        for key, value in _MODES[line.style].items()
    }
    style["line" if "line" in style else "marker"]["color"] = COLOURS[line.colour]
    if line.error is not None:
        below, above = map(_numbers, np.broadcast_to(line.error, (2, len(line.x))))
        style["error_y"] = {
            "type": "data",
            "symmetric": False,
            "array": above,
            "arrayminus": below,
            "thickness": 1,
        }
    if line.fill:
        style |= {"fill": "toself", "fillcolor": _tint(COLOURS[line.colour], line.opacity)}
    if line.values is not None and chart.scale:
        style |= _shade(line.values, chart.scale, chart.scale_label if scale else "")
    places = {"x": _numbers(line.x), "y": _numbers(line.y)}
    return {"type": "scatter", "name": line.label, **places, **style}


def _numbers(values: Array) -> Data | list[float]:
    """Return numbers as Plotly reads them fastest, in single precision: a picture needs no more."""
    if not len(values):
        return []
    return {
        "dtype": "f4",
        "bdata": base64.b64encode(np.asarray(values, dtype="<f4").tobytes()).decode("ascii"),
    }


def _shade(values: Array, scale: tuple[float, float], label: str) -> Data:
    """Return what gives the points of a trace the colours of their values, and, with a label, a
    colour scale.
    """
    marker: Data = {"color": _numbers(values), "colorscale": SCALE, "reversescale": True, "size": 4}
    marker |= {"cmin": scale[0], "cmax": scale[1]}
    if label:
        bar = {"title": {"text": label, "side": "right"}, "thickness": 14, "outlinewidth": 0}
        marker |= {"showscale": True, "colorbar": bar}
    return {"mode": "markers", "marker": marker}


def _tint(colour: str, opacity: float) -> str:
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"


def _layout(chart: Chart, panel: Panel, columns: int, height: float) -> Data:
    """Return the layout of a panel, given how many stand side by side and the height of each."""
    across = (_WIDTH / columns - _LEFT - _RIGHT) / _LETTER
    x_lines, y_lines = wrapped(panel.x_label, across), wrapped(panel.y_label, _WIDTH * height / 8)
    x = _marks(
        [line.x for line in panel.lines], panel.x_range, log=panel.log_x, whole=panel.x_whole
    )
    y = _marks(
        [line.y for line in panel.lines], panel.y_range, log=panel.log_y, whole=panel.y_whole
    )
    x["title"] = {"text": "<br>".join(x_lines), "standoff": 6}
    y["title"] = {"text": "<br>".join(y_lines), "standoff": 8}
    if panel.equal:
        x["constrain"] = "domain"
        y |= {"scaleanchor": "x", "scaleratio": 1, "constrain": "domain"}
    if panel.y_names:
        values, names = zip(*panel.y_names, strict=True)
        y |= {"tickvals": list(values), "ticktext": list(names)}
    size = _SMALL_TITLE_SIZE if chart.crowded else _TITLE_SIZE
    return {
        "title": {"text": panel.title, "font": {"size": size}, "y": 0.99, "yanchor": "top"},
        "xaxis": x,
        "yaxis": y | {"automargin": True},
        "annotations": [_note(note.x, note.y, note.text, note.align) for note in panel.notes],
        "shapes": [_band(band.start, band.end, COLOURS[band.colour]) for band in panel.bands],
        "margin": {
            "l": _LEFT + _LINE * (len(y_lines) - 1),
            "r": _RIGHT,
            "t": _TOP + _TITLE * bool(panel.title),
            "b": _BOTTOM + _LINE * (len(x_lines) - 1),
        },
        "font": {"size": 13},
        "showlegend": False,
        "hovermode": "closest",
    }


def _marks(
    curves: Sequence[Array], limits: tuple[float, float] | None, *, log: bool, whole: bool
) -> Data:
    """Return type, limits and marks of an axis."""
    if log:
        limits, marks = log_axis(limits, curves)
        words = [mark_text(mark) for mark in marks]
        ends = [math.log10(limit) for limit in limits]
        return {"type": "log", "tickvals": marks, "ticktext": words, "range": ends}
    # Plotly would write 20k and 50µ, before a unit that has a prefix already.
    axis: Data = {"exponentformat": "none"}
    limits = limits or about_values(curves)
    if whole:
        known = np.concatenate([*curves, np.array(limits or ())])
        known = known[np.isfinite(known)]
        axis |= {"dtick": 1, "tick0": 0} if len(known) and float(np.ptp(known)) < _FEW else {}
    return axis | ({"range": list(limits)} if limits else {})


def _note(x: float, y: float, text: str, align: str) -> Data:
    return {
        "x": x,
        "y": y,
        "text": text,
        "xanchor": align,
        "font": {"size": 11, "color": INK},
        "bgcolor": _HALO,
        "showarrow": False,
    }


def _band(start: float, end: float, colour: str) -> Data:
    return {
        "type": "rect",
        "yref": "y domain",
        "x0": start,
        "x1": end,
        "y0": 0,
        "y1": 1,
        "fillcolor": colour,
        "opacity": BAND_OPACITY,
        "line": {"width": 0},
        "layer": "below",
    }
