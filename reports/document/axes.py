"""Units, limits and marks that suit an axis, the same on the screen and in print."""

import itertools
import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from reports.document.chart import Chart, Panel
from reports.run.columns import Array

_FAR = 10_000.0
"""Distances from which axes are in kilometres [m]."""

_MANTISSAS: tuple[tuple[float, ...], ...] = (
    (1,),
    (1, 3),
    (1, 2, 5),
    (1, 2, 3, 4, 5, 6, 7, 8, 9),
    tuple(tenth / 10.0 for tenth in range(10, 100)),
)
"""Figures at which a logarithmic axis is marked, the fewest first."""

_MARKS_MIN, _MARKS_MAX = 3, 8
"""Marks of a logarithmic axis."""

_TINY, _ABOUT = 1e-3, 0.05
"""Range of values, over the largest, below which an axis would mark their last digits; and how far
it then reaches about them.
"""

_LINES = 2
"""Lines of a label at most."""

_SPARE = 0.04
"""Room on both sides of the data, over their range."""


def in_kilometres(panel: Panel) -> Panel:
    """Return a panel with kilometres where metres would have five digits: on both axes if they are
    equally long.

    A logarithmic axis stays in metres: its least marks are small.
    """
    x = _reach([np.array(panel.x_range)] if panel.x_range else [line.x for line in panel.lines])
    y = _reach([np.array(panel.y_range)] if panel.y_range else [line.y for line in panel.lines])
    if panel.equal:
        x = y = max(x, y)
    for axis, reach, log in (("x", x, panel.log_x), ("y", y, panel.log_y)):
        label, limits = getattr(panel, f"{axis}_label"), getattr(panel, f"{axis}_range")
        if reach >= _FAR and not log and label.endswith("[m]"):
            lines = [replace(of, **{axis: getattr(of, axis) / 1000.0}) for of in panel.lines]
            notes = [replace(of, **{axis: getattr(of, axis) / 1000.0}) for of in panel.notes]
            new: dict[str, Any] = {
                f"{axis}_label": label.replace("[m]", "[km]"),
                f"{axis}_range": limits and (limits[0] / 1000.0, limits[1] / 1000.0),
            }
            panel = replace(panel, lines=lines, notes=notes, **new)
    return panel


def with_one_abscissa(chart: Chart) -> Chart:
    """Return a chart whose panels share their abscissa with the same limits, in every column, for
    all of the same quantity.

    Limits that a panel has are kept.
    """
    if not chart.share_x:
        return chart
    limits: dict[str, tuple[float, float]] = {}
    for panel in chart.panels:
        known = np.concatenate([line.x for line in panel.lines] or [np.empty(0)])
        known = known[np.isfinite(known)]
        if len(known) and not panel.log_x:
            low, high = limits.get(panel.x_label, (math.inf, -math.inf))
            limits[panel.x_label] = min(low, float(known.min())), max(high, float(known.max()))
    panels = [
        replace(panel, x_range=panel.x_range or limits.get(panel.x_label)) for panel in chart.panels
    ]
    return replace(chart, panels=panels)


def log_axis(
    limits: tuple[float, float] | None, curves: Sequence[Array]
) -> tuple[tuple[float, float], list[float]]:
    """Return limits of a logarithmic axis, by its curves if none are given, and the values at which
    it is marked.

    Marks are powers of ten where there are three of them at least, and figures in between where
    there are not.
    """
    known = np.concatenate([curve[curve > 0.0] for curve in curves] or [np.empty(0)])
    if limits is None:
        low, high = (float(known.min()), float(known.max())) if len(known) else (1.0, 10.0)
        spare = _SPARE * math.log10(high / low) or 0.1
        limits = low / 10.0**spare, high * 10.0**spare
    decades = range(math.floor(math.log10(limits[0]) + 1e-9), math.ceil(math.log10(limits[1])) + 1)
    marks: list[float] = []
    for mantissas in _MANTISSAS:
        every = (
            mantissa * 10.0**decade for decade, mantissa in itertools.product(decades, mantissas)
        )
        marks = [
            mark for mark in every if limits[0] * (1.0 - 1e-9) <= mark <= limits[1] * (1.0 + 1e-9)
        ]
        if len(marks) >= _MARKS_MIN:
            break
    return limits, marks[:: -(-len(marks) // _MARKS_MAX) or 1]


def about_values(curves: Sequence[Array]) -> tuple[float, float] | None:
    """Return limits of a linear axis whose values are the same or nearly so, so that its marks have
    few digits; none for others.
    """
    known = np.concatenate(
        [np.asarray(curve, dtype=np.float64) for curve in curves] or [np.empty(0)]
    )
    known = known[np.isfinite(known)]
    largest = float(np.max(np.abs(known), initial=0.0))
    if not len(known) or float(np.ptp(known)) >= _TINY * largest:
        return None
    middle, spare = 0.5 * float(known.min() + known.max()), _ABOUT * largest
    return middle - spare, middle + spare


def wrapped(label: str, room: float) -> list[str]:
    """Return the lines of an axis' label: two of about the same length where it has more letters
    than there is room for.
    """
    # A line does not end within the brackets of a unit.
    words = re.split(r" (?![^\[]*\])", label)
    if len(label) <= room or len(words) < _LINES:
        return [label]
    halves = [(" ".join(words[:cut]), " ".join(words[cut:])) for cut in range(1, len(words))]
    return list(min(halves, key=lambda lines: max(map(len, lines))))


def mark_text(value: float) -> str:
    """Return a mark of a logarithmic axis in digits, or as a power of ten where it would have
    many.
    """
    if 1e-4 < value < 1e5:
        return f"{value:g}"
    mantissa, _, exponent = f"{value:.0e}".partition("e")
    power = f"10{str(int(exponent)).translate(_RAISED)}"
    return power if mantissa == "1" else f"{mantissa}·{power}"


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def cut_words(panels: Sequence[Panel]) -> str:
    """Return which curves leave their panels above or below, as a sentence with a space before it;
    no word where none does.
    """
    cut: dict[str, None] = {}
    for panel in panels:
        values = np.concatenate([line.y for line in panel.lines] or [np.empty(0)])
        known, (low, high) = values[np.isfinite(values)], panel.y_range or (-math.inf, math.inf)
        quantity, _, unit = panel.y_label.partition(" [")
        for beyond, limit, side in ((known > high, high, "above"), (known < low, low, "below")):
            if np.any(beyond):
                cut[
                    f"{quantity.lower()} {side} {limit:g} {unit.removesuffix(']')}".replace(
                        "-", "−"
                    )
                ] = None
    return f" Beyond the scale: {', '.join(cut)}." if cut else ""


def _reach(curves: list[Array]) -> float:
    known = [np.abs(curve[np.isfinite(curve)]) for curve in curves]
    return max((float(curve.max()) for curve in known if len(curve)), default=0.0)
