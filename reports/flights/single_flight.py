"""Figures of one flight over the real sea: where it flew, seen from the vessel and over the ground, and its time histories."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.chart import Array, Chart, Line, Panel, Style, circle
from reports.flights.flight_charts import in_kilometres
from reports.flights.trial_tables import funnel_distance
from reports.run.time_history import tracking_error
from reports.run.trials import Trial, column

POINTS_MAX = 1300
"""Points of a curve at most, beside the closest approach."""

_GUARDED_MAX = 300
"""Places where the guard intervened that are marked at most."""

_NEAR, _FAR = 0.95, 1.6
"""Distances that the time history shows, over r_min [-]."""

_ERROR_MIN = 0.1
"""Floor of the tracking error's logarithmic axis [m]."""

_TIME = "Time [s]"


def sea_flight_charts(trial: Trial, row: "pd.Series[Any]") -> list[Chart]:
    """Return the figures of one flight, or none if it has no record."""
    history = trial.run.history(str(row["flight_id"]))
    if history is None or len(history) < 2:
        return []
    view = _View(trial, row, history)
    tracks, histories = view.tracks(), view.histories()
    return [replace(tracks, panels=[in_kilometres(panel) for panel in tracks.panels]), histories]


class _View:
    """A flight's record, thinned, but with its closest approach, and where the guard had its hands on."""

    def __init__(self, trial: Trial, row: "pd.Series[Any]", history: pd.DataFrame) -> None:
        self._trial, self._row = trial, row
        distance = funnel_distance(history, trial.source_height)
        step = max(1, math.ceil(len(history) / POINTS_MAX))
        nearest = int(np.argmin(distance))
        kept = np.union1d(np.arange(0, len(history), step), [nearest, len(history) - 1])
        self._h, self._distance = history.iloc[kept], distance[kept]
        self._nearest = int(np.searchsorted(kept, nearest))
        guarded = np.flatnonzero(column(history, "guard") > 0.0)
        guarded = guarded[:: max(1, math.ceil(len(guarded) / _GUARDED_MAX))]
        self._guarded, self._guarded_distance = history.iloc[guarded], distance[guarded]
        self._time = self._c("time_s")
        self._ends = np.array([self._time[0], self._time[-1]])
        self._radius = float(row["keepout_radius_m"])

    def _c(self, name: str) -> Array:
        return column(self._h, name)

    def tracks(self) -> Chart:
        """Return where it flew."""
        right, along = _about_the_plume(self._h)
        guarded_right, guarded_along = _about_the_plume(self._guarded)
        disc_right, disc_along = circle(self._radius)
        i = slice(self._nearest, self._nearest + 1)
        return Chart(
            name="tracks",
            caption="Seen from the vessel, with the true axis of its plume up the page, and over the ground. Dots are where the"
            " keep-out guard changed commands, the diamond is the closest approach.",
            panels=[
                Panel(
                    x_label="Right of the plume's axis [m]",
                    y_label="Along the plume's axis [m]",
                    title="Seen from the vessel",
                    equal=True,
                    lines=[
                        Line(x=disc_right, y=disc_along, label="r_min", colour="vermillion", fill=True),
                        Line(
                            x=np.zeros(2), y=np.array([0.0, 1.6 * self._radius]), label="plume", colour="grey", style="dash"
                        ),
                        Line(x=right, y=along, label="UAV", colour="blue"),
                        Line(x=guarded_right, y=guarded_along, label="guard", colour="orange", style="points"),
                        Line(x=right[i], y=along[i], label="closest", colour="black", style="diamonds"),
                    ],
                ),
                Panel(
                    x_label="East [m]",
                    y_label="North [m]",
                    title="Over the ground",
                    equal=True,
                    lines=[
                        Line(x=self._c("vessel_east_m"), y=self._c("vessel_north_m"), label="vessel", colour="black"),
                        Line(x=self._c("east_m"), y=self._c("north_m"), label="UAV", colour="blue"),
                        Line(
                            x=column(self._guarded, "east_m"), y=column(self._guarded, "north_m"), label="guard",
                            colour="orange", style="points",
                        ),
                        Line(x=self._c("east_m")[i], y=self._c("north_m")[i], label="closest", colour="black", style="diamonds"),
                    ],
                ),
            ],
            columns=2,
            panel_height=0.42,
        )  # fmt: skip

    def histories(self) -> Chart:
        """Return its time histories."""
        panels = [self._distance_panel(), self._tracking_panel(), self._wind_panel(), self._vessel_panel()]
        panels += [self._rate_panel(), self._airspeed_panel(), self._mode_panel(), self._altitude_panel()]
        other = "the vessel's place as estimated" if self._trial.reported else "bank"
        return Chart(
            name="histories",
            caption=f"Distance from the funnel near r_min (beyond {_FAR:g} r_min it is off the panel), tracking error, wind as"
            f" estimated, {other}, commanded heading rate, airspeed, what the guidance was doing, and altitude.",
            panels=panels,
            columns=2,
            share_x=True,
            panel_height=0.15,
        )

    def _line(self, y: Array, label: str, colour: str, style: Style = "solid") -> Line:
        return Line(x=self._time, y=y, label=label, colour=colour, style=style)

    def _level(self, value: float, label: str, colour: str, style: Style = "dash") -> Line:
        return Line(x=self._ends, y=np.array([value, value]), label=label, colour=colour, style=style)

    def _distance_panel(self) -> Panel:
        i = slice(self._nearest, self._nearest + 1)
        low = min(_NEAR * self._radius, float(self._distance.min()) - 2.0)
        high = max(_FAR * self._radius, 1.1 * float(self._distance.min()))
        upright = {"fault": self._row["fault_time_s"], "manoeuvre ends": self._row["manoeuvre_end_s"]}
        marks = [
            Line(x=np.array([time, time]), y=np.array([low, high]), label=label, colour="black", style="dot")
            for label, time in upright.items()
            if not pd.isna(time) and 0.0 < time <= self._ends[1]
        ]
        return Panel(
            x_label=_TIME,
            y_label="Distance [m]",
            lines=[
                self._line(self._distance, "flown", "blue"),
                self._level(self._radius, "limit", "vermillion"),
                *marks,
                Line(
                    x=column(self._guarded, "time_s"), y=self._guarded_distance, label="guard", colour="orange", style="points"
                ),
                Line(x=self._time[i], y=self._distance[i], label="closest", colour="black", style="diamonds"),
            ],
            y_range=(low, high),
        )  # fmt: skip

    def _tracking_panel(self) -> Panel:
        error = np.maximum(tracking_error(self._h), _ERROR_MIN)
        top = 10.0 ** max(1, math.ceil(math.log10(float(error.max()))))
        lines = [self._line(error, "flown", "blue")]
        return Panel(x_label=_TIME, y_label="Off track [m]", lines=lines, log_y=True, y_range=(_ERROR_MIN, top))

    def _wind_panel(self) -> Panel:
        # Wind is given by where it comes from.
        towards = math.radians(float(self._row["wind_from_deg"])) + math.pi
        speed = float(self._row["wind_speed_mps"])
        return Panel(
            x_label=_TIME,
            y_label="Wind [m/s]",
            lines=[
                self._level(speed * math.cos(towards), "true wind", "black"),
                self._level(speed * math.sin(towards), "true wind", "black"),
                self._line(self._c("wind_north_mps"), "wind north", "green"),
                self._line(self._c("wind_east_mps"), "wind east", "purple"),
            ],
        )

    def _vessel_panel(self) -> Panel:
        """Return how far the vessel is from where it is taken to be; the bank, if it is known exactly."""
        if not self._trial.reported:
            bank = self._line(np.degrees(self._c("roll_rad")), "flown", "blue")
            return Panel(x_label=_TIME, y_label="Bank [deg]", lines=[bank])
        north, east = (self._c(f"vessel_seen_{axis}_m") - self._c(f"vessel_{axis}_m") for axis in ("north", "east"))
        error = self._line(np.hypot(north, east), "flown", "blue")
        return Panel(x_label=_TIME, y_label="Vessel off [m]", lines=[error])

    def _rate_panel(self) -> Panel:
        limit = float(self._row["heading_rate_limit_rad_s"])
        lines = [self._level(side * limit, "limit", "vermillion") for side in (1.0, -1.0)]
        lines.append(self._line(self._c("heading_rate_command_rad_s"), "command", "sky"))
        return Panel(x_label=_TIME, y_label="Rate [rad/s]", lines=lines)

    def _airspeed_panel(self) -> Panel:
        lines = [
            self._line(self._c("airspeed_command_mps"), "command", "sky"),
            self._line(self._c("airspeed_mps"), "flown", "blue"),
        ]
        return Panel(x_label=_TIME, y_label="Airspeed [m/s]", lines=lines)

    def _altitude_panel(self) -> Panel:
        altitude, funnel = self._c("altitude_m"), self._trial.source_height
        low, high = min(funnel - 1.0, float(altitude.min()) - 0.2), max(funnel + 1.0, float(altitude.max()) + 0.2)
        lines = [self._level(funnel, "funnel", "grey"), self._line(altitude, "flown", "blue")]
        return Panel(x_label=_TIME, y_label="Height [m]", lines=lines, y_range=(low, high))

    def _mode_panel(self) -> Panel:
        """Return the modes that occur, a row each, by their names if the run has them."""
        mode = self._c("mode")
        occurring = [float(m) for m in np.unique(mode)]
        names = self._trial.run.manifest.get("modes", [])
        # Mode k lies on row i of those that occur; steps from one to the next are upright.
        place = np.searchsorted(occurring, mode).astype(np.float64)
        steps = np.append(np.flatnonzero(np.diff(place)), len(place) - 1)
        starts = np.append(0, steps[:-1] + 1)
        times, rows = np.ravel(np.column_stack([self._time[starts], self._time[steps]])), np.repeat(place[starts], 2)
        return Panel(
            x_label=_TIME,
            y_label="Mode [-]",
            lines=[Line(x=times, y=rows, label="flown", colour="blue")],
            y_range=(-0.5, len(occurring) - 0.5),
            y_names=[(float(i), names[int(m)] if m < len(names) else f"mode {m:g}") for i, m in enumerate(occurring)],
        )


def _about_the_plume(history: pd.DataFrame) -> tuple[Array, Array]:
    """Return metres right of the plume's axis and along it, as seen from the vessel."""
    north, east = (column(history, f"{axis}_m") - column(history, f"vessel_{axis}_m") for axis in ("north", "east"))
    axis = column(history, "plume_axis_rad")
    return np.cos(axis) * east - np.sin(axis) * north, np.cos(axis) * north + np.sin(axis) * east
