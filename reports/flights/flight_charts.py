"""Figures of one flight: tracks and time histories."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.chart import Array, Chart, Line, Panel, circle
from reports.run.run_data import RunData
from reports.run.time_history import thinned

POINTS_MAX = 1800
"""Points of a curve at most: more than a screen shows."""

_FAR = 10_000.0
"""Distances from which axes are in kilometres [m]."""


def flight_charts(run: RunData, row: "pd.Series[Any]") -> list[Chart]:
    """Return the figures of one flight, or none if it has no record."""
    history = run.history(str(row["flight_id"]))
    if history is None or len(history) < 2:
        return []
    view = _View(run, row, history)
    return [replace(chart, panels=[in_kilometres(panel) for panel in chart.panels]) for chart in (view.tracks(), view.histories())]


def in_kilometres(panel: Panel) -> Panel:
    """Return a panel with kilometres where metres would have five digits: on both axes if they are equally long."""
    x, y = _reach([line.x for line in panel.lines]), _reach([line.y for line in panel.lines])
    if panel.equal:
        x = y = max(x, y)
    if x >= _FAR and panel.x_label.endswith("[m]"):
        lines = [replace(line, x=line.x / 1000.0) for line in panel.lines]
        panel = replace(panel, lines=lines, x_label=panel.x_label.replace("[m]", "[km]"))
    if y >= _FAR and panel.y_label.endswith("[m]"):
        lines = [replace(line, y=line.y / 1000.0) for line in panel.lines]
        panel = replace(panel, lines=lines, y_label=panel.y_label.replace("[m]", "[km]"))
    return panel


def _reach(curves: list[Array]) -> float:
    return max((float(np.nanmax(np.abs(curve))) for curve in curves if len(curve)), default=0.0)


class _View:
    """A flight's record, thinned, with the vessel's motion and the crossings."""

    def __init__(self, run: RunData, row: "pd.Series[Any]", history: pd.DataFrame) -> None:
        config = run.manifest["config"]
        self._h = thinned(history, POINTS_MAX)
        self._radius = float(row["keepout_radius_m"])
        course = math.radians(config["vessel"]["course_deg"])
        speed = float(row["nu"]) * float(config["guidance"]["airspeed_mps"])
        self._velocity = (speed * math.cos(course), speed * math.sin(course))
        self._course = course
        self._plume = math.radians(config["plume"]["heading_deg"])
        self._elevation = math.radians(config["plume"]["elevation_deg"])
        self._source_height = float(config["plume"]["source_height_m"])
        self._omega_max = float(row["heading_rate_limit_rad_s"])
        self._target_altitude = self._source_height + float(row["r_co_m"]) * math.sin(self._elevation)
        times = run.crossings_of(str(row["flight_id"]))["time_s"].to_numpy(dtype=np.float64)
        full_time = history["time_s"].to_numpy()
        self._crossing_time = times
        self._crossing_north = np.interp(times, full_time, history["north_m"])
        self._crossing_east = np.interp(times, full_time, history["east_m"])
        self._crossing_distance = run.crossings_of(str(row["flight_id"]))["distance_m"].to_numpy(dtype=np.float64)

    def _c(self, name: str) -> Array:
        return self._h[name].to_numpy(dtype=np.float64)

    def _relative(self, north: Array, east: Array, time: Array) -> tuple[Array, Array]:
        """Metres ahead of and right of the vessel."""
        x, y = north - self._velocity[0] * time, east - self._velocity[1] * time
        return (
            x * math.cos(self._course) + y * math.sin(self._course),
            -x * math.sin(self._course) + y * math.cos(self._course),
        )

    def tracks(self) -> Chart:
        time = self._c("time_s")
        ahead, right = self._relative(self._c("north_m"), self._c("east_m"), time)
        ref_ahead, ref_right = self._relative(self._c("reference_north_m"), self._c("reference_east_m"), time)
        cross_ahead, cross_right = self._relative(self._crossing_north, self._crossing_east, self._crossing_time)
        keepout_right, keepout_ahead = circle(self._radius)
        reach = 1.6 * self._radius
        return Chart(
            name="tracks",
            caption="Over the ground, and in the frame that moves with the vessel. Diamonds are plume crossings after settling.",
            panels=[
                Panel(
                    x_label="East [m]",
                    y_label="North [m]",
                    title="Over the ground",
                    equal=True,
                    lines=[
                        Line(x=self._velocity[1] * time, y=self._velocity[0] * time, label="vessel", colour="black"),
                        Line(x=self._c("east_m"), y=self._c("north_m"), label="UAV", colour="blue"),
                        Line(
                            x=self._crossing_east, y=self._crossing_north, label="crossing", colour="vermillion", style="diamonds"
                        ),
                    ],
                ),
                Panel(
                    x_label="Right of the vessel [m]",
                    y_label="Ahead of the vessel [m]",
                    title="In the vessel's frame",
                    equal=True,
                    lines=[
                        Line(x=keepout_right, y=keepout_ahead, label="keep-out", colour="vermillion"),
                        Line(
                            x=np.array([0.0, reach * math.sin(self._plume)]),
                            y=np.array([0.0, reach * math.cos(self._plume)]),
                            label="plume axis",
                            colour="grey",
                            style="dash",
                        ),
                        Line(x=ref_right, y=ref_ahead, label="reference", colour="orange"),
                        Line(x=right, y=ahead, label="UAV", colour="blue"),
                        Line(x=cross_right, y=cross_ahead, label="crossing", colour="vermillion", style="diamonds"),
                    ],
                ),
            ],
            columns=2,
            panel_height=0.46,
        )

    def histories(self) -> Chart:
        time = self._c("time_s")
        ahead, right = self._relative(self._c("north_m"), self._c("east_m"), time)
        distance = np.sqrt(ahead**2 + right**2 + (self._c("altitude_m") - self._source_height) ** 2)
        ends = np.array([time[0], time[-1]])

        def level(value: float, label: str) -> Line:
            return Line(x=ends, y=np.array([value, value]), label=label, colour="vermillion", style="dash")

        x = "Time [s]"
        return Chart(
            name="histories",
            caption="Distance to the funnel, heading rate, bank, airspeed and altitude over time. Dashed: r_min and ω_max.",
            panels=[
                Panel(
                    x_label=x,
                    y_label="Distance [m]",
                    lines=[
                        level(self._radius, "limit"),
                        Line(x=time, y=distance, label="flown", colour="blue"),
                        Line(
                            x=self._crossing_time,
                            y=self._crossing_distance,
                            label="crossing",
                            colour="vermillion",
                            style="diamonds",
                        ),
                    ],
                ),
                Panel(
                    x_label=x,
                    y_label="Rate [rad/s]",
                    lines=[
                        level(self._omega_max, "limit"),
                        level(-self._omega_max, "limit"),
                        Line(x=time, y=self._c("heading_rate_command_rad_s"), label="command", colour="orange"),
                        Line(x=time, y=self._c("heading_rate_rad_s"), label="flown", colour="blue"),
                    ],
                ),
                Panel(
                    x_label=x,
                    y_label="Bank [deg]",
                    lines=[Line(x=time, y=np.degrees(self._c("roll_rad")), label="flown", colour="blue")],
                ),
                Panel(
                    x_label=x,
                    y_label="Airspeed [m/s]",
                    lines=[
                        Line(x=time, y=self._c("airspeed_command_mps"), label="command", colour="orange"),
                        Line(x=time, y=self._c("airspeed_mps"), label="flown", colour="blue"),
                    ],
                ),
                Panel(
                    x_label=x,
                    y_label="Altitude [m]",
                    lines=[
                        Line(x=ends, y=np.array([self._target_altitude] * 2), label="command", colour="orange"),
                        Line(x=time, y=self._c("altitude_m"), label="flown", colour="blue"),
                    ],
                    y_range=(
                        min(self._target_altitude - 1.0, float(self._c("altitude_m").min()) - 0.2),
                        max(self._target_altitude + 1.0, float(self._c("altitude_m").max()) + 0.2),
                    ),
                ),
            ],
            share_x=True,
            panel_height=0.15,
        )
