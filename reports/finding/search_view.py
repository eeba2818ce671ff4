"""One flight that searched for its plume: what was believed, and what was so, in the plume's
cross-section.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.estimate.verdict import COVERAGE
from measurement.plume.fluctuating_plume import passes
from measurement.sniffer.spec import sensor_of
from reports.document.chart import Band, Chart, Line, Panel, between, circle
from reports.document.palette import Meaning
from reports.run.columns import Array, column
from reports.run.flight_config import flight_config
from reports.run.run_data import RunData
from reports.run.surroundings import Surroundings, surroundings
from reports.run.time_history import about_the_plume

ESTIMATED = "axis_height_estimated_m"
"""Column of the time history that a flight has if it searched."""

_MODES = {
    "searching": "orange",
    "lost again": "plum",
    "sensor failed": "black",
    "departing": "green",
    "holding off": "grey",
}
"""Modes of a search other than that it has found the plume, and their colours: categories, and none
that of the flight.
"""

Ellipse = tuple[float, float, float, float]
"""Centre to the right and above the sea, and one spread across and up [m]."""


class SearchView:
    """The part of a flight in which it searched.

    Attributes
    ----------
    history : its samples from the first that has an estimate on
    time : of these [s]
    crossings : samples nearest to the mean axis, one per pass
    """

    def __init__(self, run: RunData, row: "pd.Series[Any]", history: pd.DataFrame) -> None:
        self._run, self._row = run, row
        self._config = flight_config(run, row)
        self.history = history.iloc[int(np.argmax(np.isfinite(column(history, ESTIMATED)))) :]
        self.time = column(self.history, "time_s")
        across = column(self.history, "plume_across_m")
        self.crossings = np.array(
            [at.start + int(np.nanargmin(np.abs(across[at]))) for at in passes(across)],
            dtype=np.intp,
        )

    @property
    def axis_height(self) -> Array:
        """Height of the mean axis where the flight was at each sample [m]."""
        return column(self.history, "altitude_m") - column(self.history, "plume_above_m")

    def modes(self) -> list[Band]:
        """Return the stretches of time of each mode of the search."""
        number, names = column(self.history, "mode").astype(int), list(self._run.manifest["modes"])
        starts = np.concatenate([[0], np.flatnonzero(np.diff(number)) + 1])
        ends = np.append(starts[1:], len(number) - 1)
        return [
            Band(
                start=float(self.time[start]),
                end=float(self.time[end]),
                label=name,
                colour=_MODES[name],
            )
            for start, end in zip(starts, ends, strict=True)
            if (name := str(names[number[start]])) in _MODES
        ]

    def readings(self) -> tuple[Array, Array, Array]:
        """Return the place of each reading to the right of the ship's axis and above the sea [m],
        and its CO2 [ppm].

        A reading stands where its air was taken in: earlier by the sensor's delay and its mean lag,
        as its data sheet has them.
        """
        right, _ = about_the_plume(self.history)
        taken = self.time - self._delay()
        known = taken >= self.time[0]
        places = (
            np.interp(taken[known], self.time, of)
            for of in (right, column(self.history, "altitude_m"))
        )
        across, height = places
        return across, height, column(self.history, "co2_reading_ppm")[known]

    def true_plume(self) -> Ellipse | None:
        """Return the plume's mean axis at the last pass and the spread of one realisation; none of
        a flight without a pass.
        """
        if not len(self.crossings):
            return None
        last = int(self.crossings[-1])
        right, along = about_the_plume(self.history)
        shape = self._about().plume
        distance = math.hypot(right[last], along[last])
        across, up = (
            float(np.interp(distance, shape.distance, of))
            for of in (shape.spread_across, shape.spread_up)
        )
        return (
            float(right[last] - column(self.history, "plume_across_m")[last]),
            float(self.axis_height[last]),
            across,
            up,
        )

    def estimated_plume(self) -> Ellipse | None:
        """Return what was believed after the last pass; none of a flight without a pass.

        The estimate is relative to the axis that the estimated wind lets expect, which is turned
        against the true one.
        """
        if not len(self.crossings):
            return None
        rows = self.history.iloc[[-1]]
        estimate = (
            float(column(rows, f"axis_{of}_estimated_m")[0])
            for of in ("offset", "height", "spread_across", "spread")
        )
        offset, height, across, up = estimate
        _, along = about_the_plume(self.history)
        east, north = (
            float(column(rows, f"wind_{of}_mps")[0] - column(rows, f"vessel_velocity_{of}_mps")[0])
            for of in ("east", "north")
        )
        expected = math.atan2(east, north)
        turned = expected - float(column(rows, "plume_axis_rad")[0])
        return offset + float(along[self.crossings[-1]]) * math.sin(turned), height, across, up

    def _about(self) -> Surroundings:
        return surroundings(self._config, self._row, self.history)

    def _delay(self) -> float:
        """Return how much later the sensor reads than its air was taken in [s]; 0 of one that is
        not known.
        """
        try:
            channel = sensor_of(
                self._config.get("payload", {}).get("sensor") or str(self._row.get("sensor"))
            ).channel("co2")
        except MeasurementError:
            return 0.0
        return channel.delay_s + channel.t90_s / math.log(10.0) if channel is not None else 0.0


def search_view(run: RunData, row: "pd.Series[Any]") -> SearchView | None:
    """Return the search of a flight, given its row; none if it has no time history or never
    searched.
    """
    history = run.history(str(row["flight_id"]))
    if history is None or not np.isfinite(column(history, ESTIMATED)).any():
        return None
    return SearchView(run, row, history)


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
