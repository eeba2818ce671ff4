"""One flight, thinned to what figures show of it: its samples, marks and what was about it."""

import itertools
import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from reports.document.chart import Band, Line, Style
from reports.document.palette import Meaning
from reports.run.columns import Array, column
from reports.run.time_history import flight_points, guard_stretches, keepout_distance
from reports.run.trials import Trial

GUARD, GUARD_LOST = "guard changed commands", "guard lost its radius"
"""What stretches of the keep-out guard are called."""

_GUARDED_MAX = 400
"""Points of all the guard's stretches on a track at most."""

_DIAMONDS_MAX, _DIAMONDS_FAR = 60, 12
"""Crossings that are marked by diamonds, more by dots: of a track that is near, and of one that is
far away.
"""

_BANDS_MAX = 30
"""Stretches of the guard in a time history at most; those that are nearest to each other are drawn
as one.
"""

_NARROWEST = 0.002
"""Width of a stretch of the guard at least, over the flight's duration, to be seen."""

Place = Callable[[pd.DataFrame], tuple[Array, Array]]
"""Where samples are in a panel."""


class FlightView:
    """A flight's record, thinned, but with its closest approach, its crossings and the guard's
    stretches.

    Attributes
    ----------
    trial, row : whose flight, and its figures
    config : of the flight itself
    whole, samples : its time history, and those of its samples that are shown
    vessel : whether there is a ship
    distance : what the keep-out area is about, of the shown samples [m]
    closest : the sample of the closest approach, the first where there is no ship
    crossings : where and when the plume was crossed
    """

    def __init__(self, trial: Trial, row: "pd.Series[Any]", history: pd.DataFrame) -> None:
        self.trial, self.row, self.whole = trial, row, history
        self.config = trial.flight_config(row)
        distance = self.distance_of(history)
        self.vessel = not math.isnan(float(row["min_distance_m"]))
        nearest = int(np.nanargmin(distance)) if self.vessel else 0
        step = max(1, math.ceil(len(history) / flight_points(history)))
        kept = np.union1d(np.arange(0, len(history), step), [nearest, len(history) - 1])
        self.samples, self.distance = history.iloc[kept], distance[kept]
        self.closest = history.iloc[[nearest]]
        self.time = column(self.samples, "time_s")
        self.ends = self.time[[0, -1]]
        self.radius = float(row["keepout_radius_m"])
        self.crossings = self.at_times(
            trial.run.crossings_of(str(row["flight_id"]))["time_s"].to_numpy(dtype=np.float64)
        )

    @property
    def settled_at(self) -> float:
        """When it had settled [s]; its end if it never had."""
        settled = float(self.row["settling_time_s"])
        return float(self.ends[1]) if math.isnan(settled) else settled

    def distance_of(self, samples: pd.DataFrame) -> Array:
        """Return the distance that the keep-out area is about [m]."""
        return keepout_distance(samples, self.config)

    def at_times(self, times: Array) -> pd.DataFrame:
        """Return where everything was at some times [s], between samples."""
        whole = self.whole
        known = [
            name
            for name in map(str, whole)
            if name.endswith(("north_m", "east_m", "plume_axis_rad", "altitude_m"))
        ]
        # The axis may pass from pi to -pi between two samples.
        curves = {
            name: np.unwrap(column(whole, name)) if name.endswith("_rad") else column(whole, name)
            for name in known
        }
        return pd.DataFrame(
            {
                "time_s": times,
                **{n: np.interp(times, column(whole, "time_s"), c) for n, c in curves.items()},
            }
        )

    def since(self, time: float) -> "FlightView | None":
        """Return the flight from a time [s] on; None where fewer than two samples are left."""
        history = self.whole[self.whole["time_s"] >= time]
        if len(history) < 2:
            return None
        late = FlightView(self.trial, self.row, history)
        late.crossings, late.closest = (
            rows[rows["time_s"] >= time] for rows in (self.crossings, self.closest)
        )
        return late

    def marks(self, place: Place, *, far: bool = False) -> list[Line]:
        """Return the crossings and the closest approach, where ``place`` has them, or has them from
        far away.
        """
        # Many diamonds would hide the track.
        style: Style = (
            "dots"
            if len(self.crossings) > (_DIAMONDS_FAR if far else _DIAMONDS_MAX)
            else "diamonds"
        )
        marks: list[tuple[pd.DataFrame, str, str, Style]] = [
            (self.crossings, "crossing", Meaning.CROSSING, style)
        ]
        marks += [(self.closest, "closest approach", Meaning.LIMIT, "cross")] if self.vessel else []
        return [
            self.line(place, samples, label, colour, style)
            for samples, label, colour, style in marks
            if len(samples)
        ]

    def ends_of(self, place: Place) -> list[Line]:
        """Return where it began and ended."""
        return [
            self.line(place, self.whole.iloc[[0]], "start", Meaning.FLOWN, "ring"),
            self.line(place, self.whole.iloc[[-1]], "end", Meaning.FLOWN, "square"),
        ]

    def guarded(self, place: Place) -> list[Line]:
        """Return the stretches in which the guard changed commands, to be drawn below the track."""
        lines = []
        for held, label, colour in (
            (True, GUARD, Meaning.GUARD),
            (False, GUARD_LOST, Meaning.GUARD_LOST),
        ):
            stretches = [
                (start, end) for start, end, found in guard_stretches(self.whole) if found is held
            ]
            step = max(
                1, math.ceil(sum(end - start + 1 for start, end in stretches) / _GUARDED_MAX)
            )
            x: list[Array] = []
            y: list[Array] = []
            for start, end in stretches:
                # From sample to sample, so that a single one has a length; a gap follows.
                part = place(
                    self.whole.iloc[
                        [*range(max(0, start - 1), end, step), min(end, len(self.whole) - 1)]
                    ]
                )
                x, y = [*x, part[0], np.array([np.nan])], [*y, part[1], np.array([np.nan])]
            if x:
                lines.append(
                    Line(
                        x=np.concatenate(x),
                        y=np.concatenate(y),
                        label=label,
                        colour=colour,
                        style="broad",
                    )
                )
        return lines

    def bands(self) -> list[Band]:
        """Return the same stretches of time."""
        time = column(self.whole, "time_s")
        least, bands = _NARROWEST * float(self.ends[1]), []
        for held, label, colour in (
            (True, GUARD, Meaning.GUARD),
            (False, GUARD_LOST, Meaning.GUARD_LOST),
        ):
            times = [
                (
                    float(time[start]),
                    max(float(time[min(end, len(time) - 1)]), float(time[start]) + least),
                )
                for start, end, found in guard_stretches(self.whole)
                if found is held
            ]
            bands += [
                Band(start=start, end=end, label=label, colour=colour)
                for start, end in _joined(times)
            ]
        return bands

    @staticmethod
    def line(
        place: Place, samples: pd.DataFrame, label: str, colour: str, style: Style = "solid"
    ) -> Line:
        """Return samples where ``place`` has them."""
        x, y = place(samples)
        return Line(x=x, y=y, label=label, colour=colour, style=style)


def flight_view(trial: Trial, row: "pd.Series[Any]") -> FlightView | None:
    """Return a flight of a trial, given its row; None if it has no time history."""
    history = trial.run.history(str(row["flight_id"]))
    return None if history is None or len(history) < 2 else FlightView(trial, row, history)


def _joined(times: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return ``_BANDS_MAX`` stretches of time at most, of which the shortest gaps are closed."""
    gaps = sorted(
        (after[0] - before[1] for before, after in itertools.pairwise(times)), reverse=True
    )
    closed = gaps[_BANDS_MAX - 1] if len(gaps) >= _BANDS_MAX else 0.0
    joined: list[tuple[float, float]] = []
    for start, end in times:
        if joined and start - joined[-1][1] <= closed:
            joined[-1] = (joined[-1][0], max(end, joined[-1][1]))
        else:
            joined.append((start, end))
    return joined
