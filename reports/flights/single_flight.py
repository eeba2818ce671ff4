"""Figures of one flight: where it flew, seen from the vessel and over the ground, and its time histories."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Panel, Style, circle
from reports.run.columns import NOTICEABLE, Array, column
from reports.run.time_history import about_the_plume, keepout_distance, tracking_error
from reports.run.trials import Trial

POINTS_MAX = 1300
"""Points of a curve at most, beside the closest approach."""

_GUARDED_MAX = 300
"""Points of the keep-out guard's interventions that are marked at most."""

_GUARD = {1.0: ("guard", "orange"), 2.0: ("guard cannot hold its radius", "purple")}
"""Label and colour by the value of the column ``guard``."""

_NEAR, _FAR = 0.95, 1.6
"""Distances that the time history shows, over r_min [-]."""

_ERROR_MIN = 0.1
"""Floor of the tracking error's logarithmic axis [m]."""

_TIME = "Time [s]"


def flight_charts(trial: Trial, row: "pd.Series[Any]") -> list[Chart]:
    """Return the figures of one flight of a trial, given its row; none if it has no time history."""
    history = trial.run.history(str(row["flight_id"]))
    if history is None or len(history) < 2:
        return []
    view = _View(trial, row, history)
    return [replace(chart, panels=[in_kilometres(panel) for panel in chart.panels]) for chart in (view.tracks(), view.histories())]


class _View:
    """A flight's record, thinned, but with its closest approach, its crossings and the guard's interventions."""

    def __init__(self, trial: Trial, row: "pd.Series[Any]", history: pd.DataFrame) -> None:
        run, self._trial, self._row, self._source_height = trial.run, trial, row, trial.source_height
        self._modes = run.manifest.get("modes", [])
        distance = self._distance_of(history)
        self._vessel = bool(np.isfinite(distance).any())
        nearest = int(np.nanargmin(distance)) if self._vessel else 0
        step = max(1, math.ceil(len(history) / POINTS_MAX))
        kept = np.union1d(np.arange(0, len(history), step), [nearest, len(history) - 1])
        self._h, self._distance = history.iloc[kept], distance[kept]
        self._closest = history.iloc[[nearest]]
        self._time = self._c("time_s")
        self._ends = self._time[[0, -1]]
        self._radius = float(row["keepout_radius_m"])
        self._guarded = []
        for value, (label, colour) in _GUARD.items():
            samples = np.flatnonzero(column(history, "guard") == value)
            samples = samples[:: max(1, math.ceil(len(samples) / _GUARDED_MAX))]
            if len(samples):
                self._guarded.append((history.iloc[samples], label, colour))
        times = run.crossings_of(str(row["flight_id"]))["time_s"].to_numpy(dtype=np.float64)
        known = [name for name in map(str, history) if name.endswith(("north_m", "east_m", "plume_axis_rad", "altitude_m"))]
        # The axis may pass from pi to -pi between two samples.
        curves = {name: np.unwrap(column(history, name)) if name.endswith("_rad") else column(history, name) for name in known}
        at_times = {name: np.interp(times, column(history, "time_s"), curve) for name, curve in curves.items()}
        self._crossings = pd.DataFrame({"time_s": times, **at_times})

    def _distance_of(self, samples: pd.DataFrame) -> Array:
        return keepout_distance(samples, self._source_height, self._trial.shape)

    def _c(self, name: str) -> Array:
        return column(self._h, name)

    def _marks(self, place: Callable[[pd.DataFrame], tuple[Array, Array]]) -> list[Line]:
        """Return crossings, the guard's interventions and the closest approach, where ``place`` has them."""
        marks: list[tuple[pd.DataFrame, str, str, Style]] = [(self._crossings, "crossing", "vermillion", "diamonds")]
        marks += [(samples, label, colour, "points") for samples, label, colour in self._guarded]
        marks += [(self._closest, "closest", "black", "diamonds")] if self._vessel else []
        lines = []
        for samples, label, colour, style in marks:
            x, y = place(samples)
            lines += [Line(x=x, y=y, label=label, colour=colour, style=style)] if len(x) else []
        return lines

    def tracks(self) -> Chart:
        """Return where it flew."""
        panels = [self._over_the_ground()]
        return Chart(
            name="tracks",
            caption="Seen from the vessel, with the true axis of its plume up the page, and over the ground. Diamonds are plume"
            " crossings after settling and the closest approach; dots are where the keep-out guard changed commands."
            if self._vessel
            else "Over the ground.",
            panels=[self._from_the_vessel(), *panels] if self._vessel else panels,
            columns=2 if self._vessel else 1,
            panel_height=0.42,
        )

    def _from_the_vessel(self) -> Panel:
        right, along = circle(self._radius)
        reference = about_the_plume(self._h, "reference_")
        return Panel(
            x_label="Right of the plume's axis [m]",
            y_label="Along the plume's axis [m]",
            title="Seen from the vessel",
            equal=True,
            lines=[
                Line(x=right, y=along, label="r_min", colour="vermillion", fill=True),
                Line(x=np.zeros(2), y=np.array([0.0, 1.6 * self._radius]), label="plume", colour="grey", style="dash"),
                Line(x=reference[0], y=reference[1], label="reference", colour="sky"),
                self._curve(*about_the_plume(self._h), "UAV"),
                *self._marks(about_the_plume),
            ],
        )

    def _over_the_ground(self) -> Panel:
        def place(samples: pd.DataFrame, prefix: str = "") -> tuple[Array, Array]:
            return column(samples, f"{prefix}east_m"), column(samples, f"{prefix}north_m")

        other = "vessel" if self._vessel else "reference"
        return Panel(
            x_label="East [m]",
            y_label="North [m]",
            title="Over the ground",
            equal=True,
            lines=[
                self._curve(*place(self._h, f"{other}_"), other, "black" if self._vessel else "sky"),
                self._curve(*place(self._h), "UAV"),
                *self._marks(place),
            ],
        )

    def histories(self) -> Chart:
        """Return its time histories, of what it has."""
        makers = [
            self._distance_panel, self._tracking_panel, self._wind_panel, self._vessel_panel, self._rate_panel,
            self._bank_panel, self._airspeed_panel, self._altitude_panel, self._mode_panel,
        ]  # fmt: skip
        panels = [panel for panel in (make() for make in makers) if panel is not None]
        return Chart(
            name="histories",
            caption=f"Time histories. Distance is {self._trial.measured_from}, dashed r_min; of more than"
            f" {_FAR:g} r_min it is off the panel. Dashed in the panel of the heading rate: ω_max.",
            panels=panels,
            columns=2,
            share_x=True,
            panel_height=min(0.22, 0.72 / -(-len(panels) // 2)),
        )

    @staticmethod
    def _curve(x: Array, y: Array, label: str, colour: str = "blue") -> Line:
        return Line(x=x, y=y, label=label, colour=colour)

    def _line(self, y: Array, label: str = "flown", colour: str = "blue") -> Line:
        return Line(x=self._time, y=y, label=label, colour=colour)

    def _level(self, value: float, label: str, colour: str) -> Line:
        return Line(x=self._ends, y=np.array([value, value]), label=label, colour=colour, style="dash")

    def _distance_panel(self) -> Panel | None:
        if not self._vessel:
            return None
        nearest = float(np.nanmin(self._distance))
        low, high = min(_NEAR * self._radius, nearest - 2.0), max(_FAR * self._radius, 1.1 * nearest)
        upright = {"fault": self._row.get("fault_time_s"), "manoeuvre ends": self._row.get("manoeuvre_end_s")}
        marks = [
            Line(x=np.array([time, time]), y=np.array([low, high]), label=label, colour="black", style="dot")
            for label, time in upright.items()
            if time is not None and 0.0 < time <= self._ends[1]
        ]
        lines = [self._line(self._distance), self._level(self._radius, "limit", "vermillion"), *marks]
        lines += self._marks(lambda samples: (column(samples, "time_s"), self._distance_of(samples)))
        return Panel(x_label=_TIME, y_label="Distance [m]", lines=lines, y_range=(low, high))

    def _tracking_panel(self) -> Panel:
        error = np.maximum(tracking_error(self._h), _ERROR_MIN)
        top = 10.0 ** max(1, math.ceil(math.log10(float(error.max()))))
        return Panel(x_label=_TIME, y_label="Off track [m]", lines=[self._line(error)], log_y=True, y_range=(_ERROR_MIN, top))

    def _wind_panel(self) -> Panel | None:
        north, east = self._c("wind_north_mps"), self._c("wind_east_mps")
        if not np.nanmax(np.abs([north, east]), initial=0.0) > NOTICEABLE:
            return None
        # Wind is given by where it comes from.
        towards, speed = math.radians(float(self._row["wind_from_deg"])) + math.pi, float(self._row["wind_speed_mps"])
        lines = [self._level(speed * part, "true wind", "black") for part in (math.cos(towards), math.sin(towards))]
        lines += [self._line(north, "wind north", "green"), self._line(east, "wind east", "purple")]
        return Panel(x_label=_TIME, y_label="Wind [m/s]", lines=lines)

    def _vessel_panel(self) -> Panel | None:
        """Return how far the vessel is from where it is taken to be, or nothing if it is known exactly."""
        north, east = (self._c(f"vessel_seen_{axis}_m") - self._c(f"vessel_{axis}_m") for axis in ("north", "east"))
        error = np.hypot(north, east)
        if not np.nanmax(error, initial=0.0) > NOTICEABLE:
            return None
        return Panel(x_label=_TIME, y_label="Vessel off [m]", lines=[self._line(error)])

    def _rate_panel(self) -> Panel:
        limit = float(self._row["heading_rate_limit_rad_s"])
        lines = [self._level(side * limit, "limit", "vermillion") for side in (1.0, -1.0)]
        lines.append(self._line(self._c("heading_rate_command_rad_s"), "command", "sky"))
        return Panel(x_label=_TIME, y_label="Rate [rad/s]", lines=[*lines, self._line(self._c("heading_rate_rad_s"))])

    def _bank_panel(self) -> Panel:
        return Panel(x_label=_TIME, y_label="Bank [deg]", lines=[self._line(np.degrees(self._c("roll_rad")))])

    def _airspeed_panel(self) -> Panel:
        lines = [self._line(self._c("airspeed_command_mps"), "command", "sky"), self._line(self._c("airspeed_mps"))]
        return Panel(x_label=_TIME, y_label="Airspeed [m/s]", lines=lines)

    def _altitude_panel(self) -> Panel:
        """Return the altitude, with that of the funnel and, over a rising plume, of the centre of oscillation."""
        levels = {"funnel": (self._source_height, "grey")}
        rise = float(self._row.get("r_co_m", 0.0)) * math.sin(math.radians(float(self._row.get("plume_elevation_deg", 0.0))))
        if rise > 0.0:
            levels["centre of oscillation"] = (self._source_height + rise, "black")
        altitude, highest = self._c("altitude_m"), max(height for height, _ in levels.values())
        lines = [self._level(height, label, colour) for label, (height, colour) in levels.items()]
        y_range = min(self._source_height - 1.0, float(altitude.min()) - 0.2), max(highest + 1.0, float(altitude.max()) + 0.2)
        return Panel(x_label=_TIME, y_label="Height [m]", lines=[*lines, self._line(altitude)], y_range=y_range)

    def _mode_panel(self) -> Panel | None:
        """Return the modes that occur, a row each, by name if the run has names; None for a flight in one mode."""
        mode = self._c("mode")
        occurring = [float(m) for m in np.unique(mode[np.isfinite(mode)])]
        if len(occurring) < 2:
            return None
        # Mode k lies on row i of those that occur; steps from one to the next are upright.
        index = np.searchsorted(occurring, mode).astype(np.float64)
        steps = np.append(np.flatnonzero(np.diff(index)), len(index) - 1)
        starts = np.append(0, steps[:-1] + 1)
        times, rows = np.ravel(np.column_stack([self._time[starts], self._time[steps]])), np.repeat(index[starts], 2)
        return Panel(
            x_label=_TIME,
            y_label="Mode [-]",
            lines=[self._curve(times, rows, "flown")],
            y_range=(-0.5, len(occurring) - 0.5),
            y_names=[(float(i), self._modes[int(m)] if m < len(self._modes) else f"mode {m:g}") for i, m in enumerate(occurring)],
        )
