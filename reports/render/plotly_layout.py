"""Where the panels of a chart lie on the screen, their axes and their words: the layout of a Plotly
figure, as plain data.

There are two: a wide one, and what of it changes on a narrow screen, where panels stand below each
other.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from reports.document.axes import about_values, log_axis, mark_text, with_one_abscissa, wrapped
from reports.document.chart import Chart, Panel
from reports.document.palette import BAND_OPACITY, COLOURS, INK

WIDTH, NARROW_WIDTH = 980, 460
"""Widths that the two layouts are made for [px]; figures shrink with the window."""

_BAR, _LEGEND_ROW, _BOTTOM = 32, 30, 55
"""Room for the mode bar, for each row of the legend above the panels, and for labels below them
[px].
"""

_MARGINS = 90
"""Room left and right of the panels [px]."""

_BESIDE, _TITLED = 0.09, 45.0
"""Room between panels that stand side by side, over the width of all [-], and of it what no names
of an ordinate may take [px].
"""

_BELOW, _BELOW_LABELS, _TITLE = 14, 62, 28
"""Room between panels that stand one below the other: with a shared abscissa, with labels between
them, and for a title [px].
"""

_TITLE_SIZE, _SMALL_TITLE_SIZE = 16, 12
"""Letters of the titles above panels, and above many side by side [px]."""

_SYMBOL, _CHARACTER = 46.0, 6.6
"""Width of an entry of the legend without its letters, its symbol and the room about it; and of a
name's letter [px].
"""

_NARROW, _BROAD, _OTHER = 4.5, 12.0, 8.0
"""Widths of the letters of an entry [px]: of narrow ones, of broad ones, and of all others."""

_WIDTHS = dict.fromkeys(" ,.'fijlrt", _NARROW) | dict.fromkeys("mwMW%", _BROAD)
"""Widths of letters by the letter: by their mean alone, "guard changed commands" is 26 px wider
than thought.
"""

_LETTER, _LABEL_LINE = 8.0, 17
"""Width of a letter of an axis' label, and height of each of its lines [px]."""

_ONE_BY_ONE = 3
"""Panels side by side of which each has a row of its own on a narrow screen; of more two stay side
by side.
"""

_HIGHEST = 0.6
"""Height of a row on a narrow screen at most, over its width, where the panels are no maps."""

_MAP, _UPRIGHT = 0.85, 1.1
"""Width of a map that is alone in its row on a narrow screen, and height of its row at most, over
that of the screen.
"""

_HALO = "rgba(255,255,255,0.7)"
"""Behind words among curves."""

_FEW = 8.0
"""Range of whole numbers from which Plotly marks whole numbers by itself."""

Data = dict[str, Any]


def layout(chart: Chart) -> Data:
    """Return the layout for a wide screen."""
    chart = with_one_abscissa(chart)
    place = _Place(chart, WIDTH)
    found: Data = {"annotations": _words(chart, place), "shapes": _bands(chart)}
    for i, panel in enumerate(chart.panels):
        number = _number(i)
        last = i + chart.columns >= len(chart.panels)
        x, y = _axes(panel, number, place.room(i), show_x=last or not chart.share_x)
        if chart.share_x and not last:
            # The lowest panel of the column, which need not be in the last row.
            x["matches"] = (
                f"x{i + chart.columns * ((len(chart.panels) - 1 - i) // chart.columns) + 1}"
            )
        x["domain"], y["domain"] = place.domains(i)
        found |= {f"xaxis{number}": x, f"yaxis{number}": y}
    return found | {
        "height": place.height,
        "margin": {"l": 70, "r": 20, "t": place.top, "b": place.bottom},
        "font": {"size": 13},
        "legend": {"orientation": "h", "yanchor": "bottom", "y": place.legend, "x": 0.0},
        "showlegend": len(chart.labels) > 1,
        "hovermode": "closest",
    }


def narrow(chart: Chart) -> Data:
    """Return what of the layout changes on a narrow screen: entries that take the place of, or are
    merged into, its own.
    """
    columns = 1 if chart.columns <= _ONE_BY_ONE else 2
    height = chart.panel_height * chart.columns / columns
    maps = [_upright(panel) for panel in chart.panels if panel.equal]
    height = (
        max(height, min(_UPRIGHT, _MAP * max(maps)))
        if maps
        else min(height, max(chart.panel_height, _HIGHEST))
    )
    chart = replace(chart, columns=columns, panel_height=height)
    place = _Place(chart, NARROW_WIDTH, below_labels=True)
    found: Data = {
        "height": place.height,
        "margin": {"t": place.top, "l": 60, "r": 10},
        "legend": {"y": place.legend},
    }
    if any(panel.title or panel.notes for panel in chart.panels):
        found["annotations"] = _words(chart, place)
    named = chart.panels[0]
    for i, panel in enumerate(chart.panels):
        x, y = place.domains(i)
        ordinate: Data = {"domain": y}
        if panel.y_names and columns == 1:
            # Names that a panel shared with the one to its left.
            named = panel if any(name for _, name in panel.y_names) else named
            ordinate |= {
                "ticktext": [name for _, name in named.y_names],
                "title": {"text": named.y_label, "standoff": 8},
            }
        elif len(lines := wrapped(panel.y_label, place.room(i)[1])) > 1:
            ordinate |= {"title": {"text": "<br>".join(lines), "standoff": 8}}
        found |= {
            f"xaxis{_number(i)}": {"domain": x, "showticklabels": True},
            f"yaxis{_number(i)}": ordinate,
        }
    return found


class _Place:
    """Where everything is, for a width [px]; ``below_labels`` leaves room for labels below every
    panel.
    """

    def __init__(self, chart: Chart, width: int, *, below_labels: bool = False) -> None:
        self._chart = chart
        names = [
            name
            for i, panel in enumerate(chart.panels)
            if i % chart.columns
            for _, name in panel.y_names
        ]
        named = _TITLED + _CHARACTER * max(map(len, names)) if any(names) else 0.0
        self._beside = max(_BESIDE, named / (width - _MARGINS))
        self._titled = any(panel.title for panel in chart.panels)
        self._gap = (
            _BELOW_LABELS + _TITLE * self._titled if below_labels or not chart.share_x else _BELOW
        )
        rows = chart.rows + bool(chart.last_height)
        self._inner = round(width * chart.height) + (rows - 1) * (self._gap if below_labels else 0)
        first = [name for panel in chart.panels[:: chart.columns] for _, name in panel.y_names]
        self._width = width - _MARGINS - _CHARACTER * max(map(len, first), default=0)
        # Plotly has the legend as wide as the panels, which names of an ordinate leave less room.
        self.top = (
            _BAR + _LEGEND_ROW * _legend_rows(chart.labels, self._width) + _TITLE * self._titled + 6
        )
        lines = max(
            len(wrapped(panel.x_label, self.room(i)[0])) for i, panel in enumerate(chart.panels)
        )
        self.bottom = _BOTTOM + _LABEL_LINE * (lines - 1)
        self.height = self._inner + self.top + self.bottom
        self.legend = 1.0 + (_TITLE * self._titled + 6) / self._inner

    def room(self, index: int) -> tuple[float, float]:
        """Return how many letters of a label fit along the width and the height of a panel."""
        across, up = self.domains(index)
        return self._width * (across[1] - across[0]) / _LETTER, self._inner * (
            up[1] - up[0]
        ) / _LETTER

    def domains(self, index: int) -> tuple[list[float], list[float]]:
        """Return where a panel lies, from left to right and from bottom to top, in shares of the
        room for all of them.
        """
        chart, (row, column) = self._chart, divmod(index, self._chart.columns)
        gap = self._gap / self._inner
        rows = chart.rows + bool(chart.last_height)
        # What is left when the gaps are taken off goes to the rows by their heights.
        share = (1.0 - gap * (rows - 1)) / chart.height
        if chart.is_wide(index):
            return [0.0, 1.0], [0.0, share * chart.last_height]
        width, height = (
            (1.0 - self._beside * (chart.columns - 1)) / chart.columns,
            share * chart.panel_height,
        )
        left, top = column * (width + self._beside), 1.0 - row * (height + gap)
        return [left, min(1.0, left + width)], [max(0.0, top - height), top]


def _number(index: int) -> str:
    """Return how Plotly numbers a panel's axes: the first has no number."""
    return str(index + 1) if index else ""


def _legend_rows(labels: Sequence[str], width: float) -> int:
    """Return how many rows a legend takes in a width [px]; none where a single entry would say
    nothing.
    """
    if len(labels) < 2:
        return 0
    rows, used = 1, 0.0
    for label in labels:
        entry = _SYMBOL + sum(_WIDTHS.get(letter, _OTHER) for letter in label)
        if used and used + entry > width:
            rows, used = rows + 1, 0.0
        used += entry
    return rows


def _axes(
    panel: Panel, number: str, room: tuple[float, float], *, show_x: bool
) -> tuple[Data, Data]:
    """Return abscissa and ordinate of a panel, given room for how many letters each has."""
    x_label, y_label = (
        "<br>".join(wrapped(*of)) for of in zip((panel.x_label, panel.y_label), room, strict=True)
    )
    x: Data = {"anchor": f"y{number}", "showticklabels": show_x}
    if show_x:
        x["title"] = {"text": x_label, "standoff": 6}
    # Figures of four digits and names are wide: the title stays clear of them only at a given
    # distance.
    y: Data = {"anchor": f"x{number}", "title": {"text": y_label, "standoff": 8}}
    x_range, y_range = panel.x_range, panel.y_range
    if panel.equal:
        free_x, free_y = _equal_ranges(panel)
        x_range, y_range = x_range or free_x, y_range or free_y
        x["constrain"] = "domain"
        y |= {"scaleanchor": f"x{number}", "scaleratio": 1, "constrain": "domain"}
    x |= _marks([line.x for line in panel.lines], x_range, log=panel.log_x, whole=panel.x_whole)
    y |= _marks([line.y for line in panel.lines], y_range, log=panel.log_y, whole=panel.y_whole)
    if panel.y_names:
        y |= {
            "tickvals": [value for value, _ in panel.y_names],
            "ticktext": [name for _, name in panel.y_names],
        }
    return x, y


def _marks(
    curves: Sequence[np.ndarray[Any, Any]],
    limits: tuple[float, float] | None,
    *,
    log: bool,
    whole: bool,
) -> Data:
    """Return type, limits and marks of an axis."""
    if log:
        limits, marks = log_axis(limits, curves)
        axis: Data = {
            "type": "log",
            "tickvals": marks,
            "ticktext": [mark_text(mark) for mark in marks],
        }
        return axis | {"range": [math.log10(limit) for limit in limits]}
    # Plotly would write 20k and 50µ, before a unit that has a prefix of its own.
    axis, limits = {"exponentformat": "none"}, limits or about_values(curves)
    if whole:
        known = np.concatenate([*curves, np.array(limits or ())])
        known = known[np.isfinite(known)]
        axis |= {"dtick": 1, "tick0": 0} if len(known) and float(np.ptp(known)) < _FEW else {}
    return axis | ({"range": list(limits)} if limits else {})


def _words(chart: Chart, place: _Place) -> list[Data]:
    """Return the titles above the panels, and the words among their curves."""
    words: list[Data] = []
    for i, panel in enumerate(chart.panels):
        across, up = place.domains(i)
        if panel.title:
            at = {
                "x": sum(across) / 2.0,
                "y": up[1],
                "xref": "paper",
                "yref": "paper",
                "xanchor": "center",
                "yanchor": "bottom",
            }
            font = {"size": _SMALL_TITLE_SIZE if chart.crowded else _TITLE_SIZE}
            words.append({"text": panel.title, "font": font, "showarrow": False, **at})
        for note in panel.notes:
            at = {
                "x": note.x,
                "y": note.y,
                "xref": f"x{_number(i)}",
                "yref": f"y{_number(i)}",
                "xanchor": note.align,
            }
            words.append(
                {
                    "text": note.text,
                    "font": {"size": 11, "color": INK},
                    "bgcolor": _HALO,
                    "showarrow": False,
                    **at,
                }
            )
    return words


def _upright(panel: Panel) -> float:
    """Return the height of a map over its width; 0 if it has no limits."""
    if not (panel.x_range and panel.y_range):
        return 0.0
    return (panel.y_range[1] - panel.y_range[0]) / (panel.x_range[1] - panel.x_range[0])


def _bands(chart: Chart) -> list[Data]:
    """Return the tinted stretches; the first of a label is its entry in the legend."""
    shapes: list[Data] = []
    seen: set[str] = set()
    for i, panel in enumerate(chart.panels):
        for band in panel.bands:
            place = {
                "xref": f"x{_number(i)}",
                "yref": f"y{_number(i)} domain",
                "x0": band.start,
                "x1": band.end,
                "y0": 0,
                "y1": 1,
            }
            look = {
                "fillcolor": COLOURS[band.colour],
                "opacity": BAND_OPACITY,
                "line": {"width": 0},
                "layer": "below",
            }
            legend = {"name": band.label, "showlegend": True} if band.label not in seen else {}
            seen.add(band.label)
            shapes.append({"type": "rect", **place, **look, **legend})
    return shapes


def _equal_ranges(panel: Panel) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return ranges that hold every curve with a little to spare, and are not much narrower one way
    than the other.
    """
    x, y = (
        np.concatenate(curves)
        for curves in zip(*((line.x, line.y) for line in panel.lines), strict=True)
    )
    (x_middle, x_half), (y_middle, y_half) = (
        (float(np.nanmin(v) + np.nanmax(v)) / 2.0, 0.54 * float(np.nanmax(v) - np.nanmin(v)))
        for v in (x, y)
    )
    x_half, y_half = max(x_half, 0.4 * y_half), max(y_half, 0.4 * x_half)
    return (x_middle - x_half, x_middle + x_half), (y_middle - y_half, y_middle + y_half)
