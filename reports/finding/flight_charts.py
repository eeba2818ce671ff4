"""Figures of one flight that searched for its plume."""

import numpy as np

from measurement.estimate.verdict import COVERAGE
from reports.document.chart import Chart, Line, Panel, between, circle
from reports.document.palette import Meaning
from reports.finding.search_view import ESTIMATED, Ellipse, SearchView
from reports.run.columns import column

_POINTS_MAX = 1500
"""Points of a curve at most."""

_READINGS_MAX = 3000
"""Readings in the cross-section at most."""

_REACH = 5.0
"""Half the width of the cross-section, over the plume's spread across [-]."""


def height_chart(view: SearchView, name: str) -> Chart:
    """Return the height of the plume's axis as it was believed and as it was, and the altitude that
    was flown.
    """
    step = max(1, -(-len(view.time) // _POINTS_MAX))
    rows = view.history.iloc[::step]
    time, height, deviation = (
        column(rows, of) for of in ("time_s", ESTIMATED, "axis_height_deviation_m")
    )
    known = np.isfinite(height)
    time, height, reach = time[known], height[known], COVERAGE * deviation[known]
    crossed = view.time[view.crossings], view.axis_height[view.crossings]
    lines = [
        between(time, height - reach, height + reach, "believed, 95 %", "black"),
        Line(
            x=column(rows, "time_s"),
            y=column(rows, "altitude_m"),
            label="flown",
            colour=Meaning.FLOWN,
        ),
        Line(x=time, y=height, label="believed, mean", colour="black", style="dash"),
        Line(
            x=crossed[0],
            y=crossed[1],
            label="plume's mean axis, where it was crossed",
            colour=Meaning.PLUME,
            style="diamonds",
        ),
    ]
    panel = Panel(
        x_label="Time [s]", y_label="Height above the sea [m]", lines=lines, bands=view.modes()
    )
    caption = (
        "Height of the plume's axis as it was believed after each pass, with its 95 % interval, and"
        " as it was; the altitude that"
        " was flown. Tinted: what the guidance was doing; untinted it had found the plume, was on"
        " its way to the orbit, or was in a"
        " mode without a part in the search."
    )
    return Chart(name=f"search-height-{name}", caption=caption, panels=[panel], panel_height=0.42)


def section_chart(view: SearchView, name: str) -> Chart | None:
    """Return the readings in the plume's cross-section, with the plume as it was and as it was
    believed; none without a pass.
    """
    true, believed = view.true_plume(), view.estimated_plume()
    if true is None or believed is None:
        return None
    reach = _REACH * true[2]
    right, height, co2 = view.readings()
    near = np.flatnonzero(np.abs(right - true[0]) <= reach)[
        :: max(1, -(-len(right) // _READINGS_MAX))
    ]
    # Those with the plume in them lie over the others.
    shown = near[np.argsort(co2[near], kind="stable")]
    lines = [
        Line(
            x=right[shown],
            y=height[shown],
            label="",
            colour=Meaning.FLOWN,
            style="points",
            values=co2[shown],
        ),
        *_outline(true, "plume, ±σ", Meaning.PLUME, dashed=False),
        *_outline(believed, "believed, ±σ", "black", dashed=True),
    ]
    panel = Panel(
        x_label="Across the plume, seen from the ship [m]",
        y_label="Height above the sea [m]",
        lines=lines,
        x_range=(true[0] - reach, true[0] + reach),
    )
    caption = (
        "Readings in the plume's cross-section, seen from the ship along the apparent wind, each"
        " where its air was taken in:"
        " earlier by the sensor's delay and mean lag. Ellipses: the mean axis where it was crossed"
        " last and the spread of the plume"
        " at one moment, and what was believed of both at the end."
    )
    return Chart(
        name=f"search-section-{name}",
        caption=caption,
        panels=[panel],
        panel_height=0.46,
        scale_label="CO2 read [ppm]",
    )


def _outline(ellipse: Ellipse, label: str, colour: str, *, dashed: bool) -> list[Line]:
    """Return an ellipse and its centre."""
    x, y, across, up = ellipse
    cos_a, sin_a = circle(1.0)
    return [
        Line(
            x=x + across * cos_a,
            y=y + up * sin_a,
            label=label,
            colour=colour,
            style="dash" if dashed else "solid",
        ),
        Line(x=np.array([x]), y=np.array([y]), label="", colour=colour, style="cross"),
    ]
