"""Charts as figures of Plotly, for the screen: what its library in the page is given, as plain
data.
"""

import base64
from collections.abc import Mapping
from typing import Any

import numpy as np

from reports.document.chart import Chart, Line
from reports.document.palette import COLOURS, SCALE
from reports.render.plotly_layout import layout, narrow
from reports.run.columns import Array

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
    """Return the chart as ``data`` and ``layout`` of a Plotly figure; ``narrow`` is what the layout
    becomes on a narrow screen.
    """
    traces: list[Data] = []
    seen, scale, shaded = {""}, chart.scale, False
    for i, panel in enumerate(chart.panels):
        number = str(i + 1) if i else ""
        for line in panel.lines:
            trace = _trace(line, show=line.label not in seen) | {
                "xaxis": f"x{number}",
                "yaxis": f"y{number}",
            }
            if line.values is not None and scale:
                trace |= _shade(line.values, scale, "" if shaded else chart.scale_label)
                shaded = True
            traces.append(trace)
            seen.add(line.label)
    return {"data": traces, "layout": layout(chart), "narrow": narrow(chart)}


def _trace(line: Line, *, show: bool) -> Data:
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
    names = {"name": line.label, "legendgroup": line.label, "showlegend": show}
    return {"type": "scatter", "x": _numbers(line.x), "y": _numbers(line.y), **names, **style}


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
    return {"mode": "markers", "showlegend": False, "marker": marker}


def _tint(colour: str, opacity: float) -> str:
    red, green, blue = (int(colour[i : i + 2], 16) for i in (1, 3, 5))
    return f"rgba({red},{green},{blue},{opacity})"
