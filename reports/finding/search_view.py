"""One flight that searched for its plume: what was believed, and what was so, in the plume's
cross-section.
"""

import math
from typing import Any

import numpy as np
import pandas as pd

from measurement.errors import MeasurementError
from measurement.plume.fluctuating_plume import passes
from measurement.sniffer.spec import sensor_of
from reports.document.chart import Band
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
