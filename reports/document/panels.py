"""Panels with a marker per flight, or of the flights counted."""

import math
from collections.abc import Sequence

import numpy as np

from reports.document.chart import Line, Panel, across, upright
from reports.document.palette import Meaning
from reports.document.tables import limit
from reports.run.columns import Array, Mask

Group = tuple[Mask, str, str]
"""Which flights have markers of a name and a colour."""

COUNTED_MIN = 5
"""Flights that are counted at least: fewer are seen one by one in a table."""

_BINS = 24
"""Bars of a histogram at most; of few flights there are twice as many as the root of their number.
"""

_SPREAD = 0.32
"""Half-width of a row of markers that would hide each other, in rows."""

_OUTLIERS = 1.6
"""Largest ordinate that is shown, over the limit or twice the median, whichever is larger."""

_NAMED = 3
"""Values beyond a panel that its legend names one by one."""

_SPARE = 1.15
"""Largest ordinate that is shown, over the highest marker, where none is cut."""


def points(x: Array, y: Array, groups: Sequence[Group]) -> list[Line]:
    """Return markers in groups of a name and a colour each; none for a group without any."""
    known = np.isfinite(x) & np.isfinite(y)
    return [
        Line(x=x[known & mask], y=y[known & mask], label=label, colour=colour, style="points")
        for mask, label, colour in groups
        if (known & mask).any()
    ]


def capped(
    x: Array, y: Array, groups: Sequence[Group], limit: float, unit: str = "", what: str = ""
) -> tuple[list[Line], float]:
    """Return markers as ``points`` does, those far above all others on the upper edge with their
    values, and where that is.

    Panels of several figures share a legend, in which ``what`` tells whose values these are.
    """
    known = y[np.isfinite(y)]
    least = 0.0 if math.isnan(limit) else limit
    highest = _SPARE * max([*known, least]) or 1.0
    # Where most are 0, as the time of a guard that seldom intervenes, the median says nothing.
    typical = (
        2.0 * float(np.median(known)) or float(np.quantile(known, 0.95)) if len(known) else 0.0
    )
    top = min(_OUTLIERS * max(typical, least) or highest, highest)
    beyond = y > top
    lines = points(np.where(beyond, np.nan, x), y, groups)
    if beyond.any():
        edge = np.full(int(np.count_nonzero(beyond)), 0.97 * top)
        lines.append(
            Line(
                x=x[beyond],
                y=edge,
                label=beyond_label(y[beyond], unit, what),
                colour="black",
                style="diamonds",
            )
        )
    return lines, top


def beyond_label(values: Array, unit: str, what: str = "") -> str:
    """Return what the legend says of values that a panel has no room for: each of a few, else how
    far they reach.
    """
    shown = (
        ", ".join(map(limit, np.sort(values)))
        if len(values) <= _NAMED
        else f"up to {limit(float(np.max(values)))}"
    )
    return f"{what} beyond the panel: {shown} {unit}".strip()


def level(x: Array, value: float, label: str, colour: str = Meaning.LIMIT) -> Line:
    """Return a dashed line across a panel whose abscissae are ``x``."""
    return across(np.array(around(x) or (0.0, 1.0)), value, label, colour)


def around(x: Array) -> tuple[float, float] | None:
    """Return limits of an axis with room to spare on both sides, also about a single value; None
    without any.
    """
    known = x[np.isfinite(x)]
    if not len(known):
        return None
    low, high = float(known.min()), float(known.max())
    spare = 0.04 * (high - low) or 0.1 * abs(low) or 0.1
    return low - spare, high + spare


def histogram(
    series: Sequence[tuple[Array, str, str]],
    x_label: str,
    marked: Sequence[tuple[float, str]] = (),
    marked_colour: str = Meaning.LIMIT,
) -> Panel | None:
    """Return a panel that counts flights by a figure, or None if fewer than ``COUNTED_MIN`` have
    it.

    Parameters
    ----------
    series : figures of the same flights, name and colour
    x_label : of the figure
    marked, marked_colour : values to be marked, by name, and their colour
    """
    known = [values[np.isfinite(values)] for values, _, _ in series]
    if max(map(len, known), default=0) < COUNTED_MIN:
        return None
    every = np.concatenate(known)
    edges = np.histogram_bin_edges(every, bins=min(_BINS, math.ceil(2.0 * math.sqrt(len(every)))))
    lines, most = [], 1
    for values, label, colour in series:
        counts, _ = np.histogram(values[np.isfinite(values)], edges)
        most = max(most, int(counts.max()))
        outline = np.concatenate([[0.0], np.repeat(counts, 2), [0.0]])
        lines.append(Line(x=np.repeat(edges, 2), y=outline, label=label, colour=colour, fill=True))
    lines += [upright(value, (0.0, 1.05 * most), label, marked_colour) for value, label in marked]
    x_range, y_range = around(np.append(edges, [value for value, _ in marked])), (0.0, 1.08 * most)
    return Panel(
        x_label=x_label,
        y_label="Flights",
        lines=lines,
        x_range=x_range,
        y_range=y_range,
        y_whole=True,
    )


def strips(
    values: Array,
    kinds: Sequence[str],
    x_label: str,
    y_label: str,
    groups: Sequence[Group],
    marked: Sequence[tuple[float, str]],
    *,
    named: bool,
) -> Panel:
    """Return a panel with a row of markers per kind.

    Parameters
    ----------
    values, kinds : of each flight
    x_label, y_label : of the figure, and of the kinds where these are named
    groups : as in ``points``
    marked : values to be marked, by name
    named : whether the rows have their names, which a panel to the right of one that has needs not
    """
    rows = list(dict.fromkeys(kinds))
    place = np.array([len(rows) - 1.0 - rows.index(kind) for kind in kinds])
    for row in np.unique(place):
        members = np.flatnonzero(place == row)
        place[members] += np.linspace(-_SPREAD, _SPREAD, len(members)) if len(members) > 1 else 0.0
    lines = points(values, place, groups)
    reach = (-0.6, len(rows) - 0.4)
    lines += [upright(value, reach, label) for value, label in marked]
    names = [(len(rows) - 1.0 - i, row if named else "") for i, row in enumerate(rows)]
    return Panel(
        x_label=x_label,
        y_label=y_label if named else "",
        lines=lines,
        x_range=around(np.append(values, [value for value, _ in marked])),
        y_range=reach,
        y_names=names,
    )
