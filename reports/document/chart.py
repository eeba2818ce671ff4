"""What a figure shows, said once; ``matplotlib_charts`` and ``plotly_charts`` draw it the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from reports.document.palette import FILL_OPACITY, Meaning
from reports.run.columns import Array

Style = Literal[
    "solid", "thin", "broad", "dash", "dot", "points", "dots", "diamonds", "ring", "square", "cross"
]
"""Lines: thin ones over a track, broad ones below it. Marks: small dots, a ring where something
begins, a square where it ends.
"""

VARIANT_STYLES: tuple[Style, ...] = ("dash", "dot", "solid")
"""Styles of comparisons, in their order: with their colours, curves differ in grey. That of the
study is solid.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One curve or set of points.

    Attributes
    ----------
    x, y : shape (n,) each, in the units of the panel's axes
    label : for the legend; the same label in several panels is one entry, and an empty one none
    colour : a key of ``palette.COLOURS``
    style : how it is drawn
    error : half-height of error bars, shape (n,), or their lengths below and above, shape (2, n);
        or none
    fill : tint what the curve encloses
    opacity : of the tint
    values : of each point, shape (n,), shown by its colour on the chart's scale; or none. Points
        without a number are not shown
    """

    x: Array
    y: Array
    label: str
    colour: str
    style: Style = "solid"
    error: Array | None = None
    fill: bool = False
    opacity: float = FILL_OPACITY
    values: Array | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Note:
    """A word or two beside a curve, where a legend would be too far away.

    Attributes
    ----------
    x, y : where, in the units of the panel's axes
    text : what it says
    align : which end of the text stands at ``x``
    """

    x: float
    y: float
    text: str
    align: Literal["left", "center", "right"] = "center"


@dataclass(frozen=True, slots=True, kw_only=True)
class Band:
    """A tinted stretch of the abscissa, over the whole height of its panel.

    Attributes
    ----------
    start, end : in the unit of the abscissa
    label : for the legend, like that of a line
    colour : a key of ``palette.COLOURS``
    """

    start: float
    end: float
    label: str
    colour: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    x_label, y_label : "Quantity [unit]"; the quantity alone where there is no unit, such as of
        names and counts
    lines : what is drawn, from back to front
    title : above the panel
    equal : one metre is as long both ways
    log_x, log_y : logarithmic abscissa, ordinate
    x_range, y_range : limits, or by the data
    y_names : values that the ordinate marks, each by a name; none for figures
    notes : words among the curves; on linear axes only
    bands : tinted stretches, below the lines
    x_whole, y_whole : marked at whole numbers alone, as counts are
    """

    x_label: str
    y_label: str
    lines: Sequence[Line]
    title: str = ""
    equal: bool = False
    log_x: bool = False
    log_y: bool = False
    x_range: tuple[float, float] | None = None
    y_range: tuple[float, float] | None = None
    y_names: Sequence[tuple[float, str]] = ()
    notes: Sequence[Note] = ()
    bands: Sequence[Band] = ()
    x_whole: bool = False
    y_whole: bool = False


_CROWDED = 4
"""Panels side by side whose titles would touch."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Chart:
    """A figure of one or more panels.

    Attributes
    ----------
    name : for file names and anchors
    caption : what to see in it, in a sentence or two
    panels : in reading order
    columns : panels side by side
    panel_height : of each row, relative to a full text width of 1
    last_height : of the last panel where that is alone in its row and as wide as the page, as
        ``panel_height``; 0 where it is not
    share_x : panels of a column share their abscissa
    scale_label : "Quantity [unit]" of the colour scale, for lines with values
    number : "Figure 3"; given when the report is put together
    """

    name: str
    caption: str
    panels: Sequence[Panel]
    columns: int = 1
    panel_height: float = 0.36
    last_height: float = 0.0
    share_x: bool = False
    scale_label: str = ""
    number: str = ""

    @property
    def rows(self) -> int:
        """Number of rows of panels, without that of a last one which is as wide as the page."""
        return -(-(len(self.panels) - bool(self.last_height)) // self.columns)

    @property
    def height(self) -> float:
        """Height of all rows, relative to a full text width of 1."""
        return self.panel_height * self.rows + self.last_height

    def is_wide(self, index: int) -> bool:
        """Return whether a panel, by its place, is the one that is as wide as the page."""
        return bool(self.last_height) and index == len(self.panels) - 1

    @property
    def crowded(self) -> bool:
        """Whether so many panels stand side by side that their titles are in small letters."""
        return self.columns >= _CROWDED

    @property
    def labels(self) -> list[str]:
        """Entries of the legend, each once."""
        lines = [line.label for panel in self.panels for line in panel.lines]
        bands = [band.label for panel in self.panels for band in panel.bands]
        return list(dict.fromkeys(label for label in (*lines, *bands) if label))

    @property
    def scale(self) -> tuple[float, float] | None:
        """Ends of the colour scale, or None without values."""
        values = [
            line.values[np.isfinite(line.values)]
            for panel in self.panels
            for line in panel.lines
            if line.values is not None
        ]
        known = np.concatenate(values) if values else np.empty(0)
        return (float(known.min()), float(known.max())) if len(known) else None


def circle(radius: float) -> tuple[Array, Array]:
    """Return the outline of a circle about the origin."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return radius * np.cos(angle), radius * np.sin(angle)


def constant(x: Array, value: float) -> Array:
    """Return ``value`` at every x."""
    return np.full(len(x), value)


def across(
    ends: Array, value: float, label: str, colour: str = Meaning.LIMIT, style: Style = "dash"
) -> Line:
    """Return a level line between two abscissae."""
    return Line(x=ends, y=np.full(2, value), label=label, colour=colour, style=style)


def upright(
    value: float,
    ends: Sequence[float],
    label: str,
    colour: str = Meaning.LIMIT,
    style: Style = "dash",
) -> Line:
    """Return an upright line between two ordinates."""
    y = np.asarray(ends, dtype=np.float64)
    return Line(x=np.full(2, value), y=y, label=label, colour=colour, style=style)


def between(
    x: Array,
    low: Array,
    high: Array,
    label: str,
    colour: str,
    style: Style = "thin",
    *,
    opacity: float = FILL_OPACITY,
) -> Line:
    """Return what lies between two curves, tinted."""
    return Line(
        x=np.append(x, x[::-1]),
        y=np.append(low, high[::-1]),
        label=label,
        colour=colour,
        style=style,
        fill=True,
        opacity=opacity,
    )
