"""What a figure shows, said once; ``matplotlib_charts`` and ``plotly_charts`` draw it the same."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from reports.run.columns import Array

Style = Literal["solid", "dash", "dot", "points", "diamonds"]

COLOURS = {
    "blue": "#0072B2",
    "vermillion": "#D55E00",
    "green": "#009E73",
    "orange": "#E69F00",
    "sky": "#56B4E9",
    "purple": "#CC79A7",
    "black": "#222222",
    "grey": "#8a8a8a",
}
"""Okabe and Ito's palette, which colour-blind readers can tell apart."""

SCALE = "Cividis"
"""Colour scale of values, light for the least: of even steps for all eyes. Matplotlib writes it in small letters."""

FILL_OPACITY = 0.16
"""Of what a curve encloses: the grid still shows through."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One curve or set of points.

    Attributes
    ----------
    x, y : shape (n,) each, in the units of the panel's axes
    label : for the legend; the same label in several panels is one entry, and an empty one none
    colour : a key of ``COLOURS``
    style : how it is drawn
    error : half-height of error bars, shape (n,), or none
    fill : tint what the curve encloses
    values : of each point, shape (n,), shown by its colour on the chart's scale; or none. Points without a number are not shown
    """

    x: Array
    y: Array
    label: str
    colour: str
    style: Style = "solid"
    error: Array | None = None
    fill: bool = False
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
class Panel:
    """One pair of axes.

    Attributes
    ----------
    x_label, y_label : "Quantity [unit]"
    lines : what is drawn, from back to front
    title : above the panel
    equal : one metre is as long both ways
    log_x, log_y : logarithmic abscissa, ordinate
    x_range, y_range : limits, or by the data
    y_names : values that the ordinate marks, each by a name; none for figures
    notes : words among the curves; on linear axes only
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
    share_x : panels of a column share their abscissa
    scale_label : "Quantity [unit]" of the colour scale, for lines with values
    number : "Figure 3"; given when the report is put together
    """

    name: str
    caption: str
    panels: Sequence[Panel]
    columns: int = 1
    panel_height: float = 0.36
    share_x: bool = False
    scale_label: str = ""
    number: str = ""

    @property
    def rows(self) -> int:
        """Number of rows of panels."""
        return -(-len(self.panels) // self.columns)

    @property
    def scale(self) -> tuple[float, float] | None:
        """Ends of the colour scale, or None without values."""
        values = [line.values[np.isfinite(line.values)] for panel in self.panels for line in panel.lines if line.values is not None]
        known = np.concatenate(values) if values else np.empty(0)
        return (float(known.min()), float(known.max())) if len(known) else None


def circle(radius: float, points: int = 181) -> tuple[Array, Array]:
    """Return the outline of a circle about the origin."""
    angle = np.linspace(0.0, 2.0 * np.pi, points)
    return radius * np.cos(angle), radius * np.sin(angle)


def constant(x: Array, value: float) -> Array:
    """Return ``value`` at every x."""
    return np.full(len(x), value)
