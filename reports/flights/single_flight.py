"""Figures of one flight: where it went, and its time histories."""

import math
from dataclasses import replace

import numpy as np

from common.run_layout import FLIGHTS
from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Panel, Style, across, between, upright
from reports.document.palette import Meaning
from reports.flights.names import flight_name
from reports.flights.tracks import FlightView, track_chart
from reports.run.columns import NOTICEABLE, Array, column, is_figure
from reports.run.flight_config import fault_marks, keepout_shape, source_height
from reports.run.time_history import (
    ERROR_MIN,
    floor_words,
    shown_distances,
    tracking_error,
    true_wind,
)
from reports.run.trials import measured_from

_HIDDEN = 0.2
"""Height within which a flight that stays there hides a level [m]."""

_TWO_COLUMNS = 6
"""Panels that stand in two columns; more are in three, so that each is higher than its label is
long.
"""

_LONG_S, _WITHIN_S, _TINT = 900.0, 30.0, 0.35
"""Duration from which turns would fill a panel [s], time whose range is shown then, some turns long
[s], and its tint.
"""

_TIME = "Time [s]"

_VESSEL_ERROR = "Vessel error [m]"
_VESSEL_WORDS = " Vessel error: from where the vessel is to where the guidance takes it to be."


def flight_charts(view: FlightView | None) -> list[Chart]:
    """Return the figures of one flight; none if it has no time history."""
    return [] if view is None else [track_chart(view), _Histories(view).chart()]


class _Histories:
    """The panels of one flight's time histories."""

    def __init__(self, view: FlightView) -> None:
        self._view = view

    def chart(self) -> Chart:
        """Return its time histories, of what it has."""
        makers = [
            self._distance_panel,
            self._tracking_panel,
            self._wind_panel,
            self._vessel_panel,
            self._rate_panel,
            self._bank_panel,
            self._airspeed_panel,
            self._altitude_panel,
            self._mode_panel,
        ]
        trial, bands = self._view.trial, self._view.bands()
        own = (make() for make in makers)
        panels = [
            replace(in_kilometres(panel), bands=bands)
            for panel in (*own, *self._added_panels())
            if panel is not None
        ]
        columns = 2 if len(panels) <= _TWO_COLUMNS else 3
        small = floor_words([self._view.samples])
        vessel = _VESSEL_WORDS * any(panel.y_label == _VESSEL_ERROR for panel in panels)
        return Chart(
            name="histories",
            caption=f"{flight_name(trial, self._view.row)}: time"
            f" histories.{self._distance_words()}{small}{vessel}"
            " Dashed in the panel of the heading rate: ω_max."
            + (
                f" Rate and bank: the range of the values within each {_WITHIN_S:g} s."
                if self._long
                else ""
            )
            + (" Tinted: the keep-out guard changed commands." if bands else ""),
            panels=panels,
            columns=columns,
            share_x=True,
            panel_height=min(0.2, 0.33 / -(-len(panels) // columns)),
        )

    @property
    def _long(self) -> bool:
        return bool(self._view.ends[1] - self._view.ends[0] > _LONG_S)

    def _line(
        self, y: Array, label: str = "flown", colour: str = Meaning.FLOWN, style: Style = "solid"
    ) -> Line:
        return Line(x=self._view.time, y=y, label=label, colour=colour, style=style)

    def _command(self, y: Array) -> Line:
        return self._line(y, "command", Meaning.COMMANDED)

    def _column(self, name: str) -> Array:
        return column(self._view.samples, name)

    def _distance_panel(self) -> Panel | None:
        if not self._view.vessel:
            return None
        low, high = self._distance_range()
        events = {
            **fault_marks(self._view.row),
            "manoeuvre ends": self._view.row.get("manoeuvre_end_s"),
        }
        marks = [
            upright(time, (low, high), label, "black", "dot")
            for label, time in events.items()
            if time is not None and 0.0 < time <= self._view.ends[1]
        ]
        lines = [
            self._line(self._view.distance),
            across(self._view.ends, self._view.radius, "limit"),
            *marks,
        ]
        lines += self._view.marks(
            lambda samples: (column(samples, "time_s"), self._view.distance_of(samples))
        )
        return Panel(x_label=_TIME, y_label="Distance [m]", lines=lines, y_range=(low, high))

    def _distance_words(self) -> str:
        """Return what the panel of the distance shows; nothing without a ship."""
        if not self._view.vessel:
            return ""
        far, farthest = self._distance_range()[1], float(np.nanmax(self._view.distance))
        where = measured_from(keepout_shape(self._view.config))
        return (
            f" Distance is {where}, dashed"
            f" r_min.{f' Distances above {far:.0f} m are not shown.' if farthest > far else ''}"
        )

    def _distance_range(self) -> tuple[float, float]:
        """Return the least and the largest distance that are shown [m]."""
        settled = self._view.time >= float(self._view.row.get("settling_time_s", math.nan))
        return shown_distances(self._view.distance, settled, self._view.radius)

    def _tracking_panel(self) -> Panel:
        error = np.maximum(tracking_error(self._view.samples), ERROR_MIN)
        top = 10.0 ** max(1, math.ceil(math.log10(float(error.max()))))
        return Panel(
            x_label=_TIME,
            y_label="Tracking error [m]",
            lines=[self._line(error)],
            log_y=True,
            y_range=(ERROR_MIN, top),
        )

    def _wind_panel(self) -> Panel | None:
        north, east = self._column("wind_north_mps"), self._column("wind_east_mps")
        if not np.nanmax(np.abs([north, east]), initial=0.0) > NOTICEABLE:
            return None
        true_north, true_east = true_wind(self._view.samples, self._view.row)
        lines = [
            self._line(true_north, "true wind, north", "black", "dash"),
            self._line(true_east, "true wind, east", "black", "dot"),
            self._line(north, "estimate, north", Meaning.WIND),
            self._line(east, "estimate, east", Meaning.WIND, "dot"),
        ]
        return Panel(x_label=_TIME, y_label="Wind [m/s]", lines=lines)

    def _vessel_panel(self) -> Panel | None:
        """Return how far the vessel is from where it is taken to be, or nothing if it is known
        exactly.
        """
        north, east = (
            self._column(f"vessel_seen_{axis}_m") - self._column(f"vessel_{axis}_m")
            for axis in ("north", "east")
        )
        error = np.hypot(north, east)
        if not np.nanmax(error, initial=0.0) > NOTICEABLE:
            return None
        return Panel(x_label=_TIME, y_label=_VESSEL_ERROR, lines=[self._line(error)])

    def _rate_panel(self) -> Panel:
        limit = float(self._view.row["heading_rate_limit_rad_s"])
        lines = [across(self._view.ends, side * limit, "limit") for side in (1.0, -1.0)]
        # What is flown lies over its command: of many turns the one that is above hides the other.
        lines += self._fast("heading_rate_command_rad_s", "command", Meaning.COMMANDED, 1.0)
        lines += self._fast("heading_rate_rad_s", "flown", Meaning.FLOWN, 1.0)
        return Panel(x_label=_TIME, y_label="Rate [rad/s]", lines=lines)

    def _fast(self, name: str, label: str, colour: str, factor: float) -> list[Line]:
        """Return a column that swings with every turn; of a long flight, whose turns would fill the
        panel, between which values.
        """
        if not self._long:
            return [self._line(factor * self._column(name), label, colour)]
        time, values = (column(self._view.whole, of) for of in ("time_s", name))
        starts = np.flatnonzero(np.diff(np.floor(time / _WITHIN_S), prepend=-1.0) > 0.0)
        known = np.nan_to_num(factor * values)
        least, most = np.minimum.reduceat(known, starts), np.maximum.reduceat(known, starts)
        edges = np.append(time[starts], time[-1])
        x, low, high = np.repeat(edges, 2)[1:-1], np.repeat(least, 2), np.repeat(most, 2)
        stretch = between(x, low, high, label, colour, opacity=_TINT)
        return [replace(stretch, fill=label == "flown")]

    def _bank_panel(self) -> Panel:
        return Panel(
            x_label=_TIME,
            y_label="Bank [deg]",
            lines=self._fast("roll_rad", "flown", Meaning.FLOWN, math.degrees(1.0)),
        )

    def _airspeed_panel(self) -> Panel:
        lines = [
            self._command(self._column("airspeed_command_mps")),
            self._line(self._column("airspeed_mps")),
        ]
        return Panel(x_label=_TIME, y_label="Airspeed [m/s]", lines=lines)

    def _altitude_panel(self) -> Panel:
        """Return the altitude, with that of the funnel and, over a rising plume, of the centre of
        oscillation.
        """
        row, funnel = self._view.row, source_height(self._view.config)
        levels = {"stack": (funnel, Meaning.SHIP)}
        rise = float(row.get("r_co_m", 0.0)) * math.sin(
            math.radians(float(row.get("plume_elevation_deg", 0.0)))
        )
        if rise > 0.0:
            levels["centre of oscillation"] = (funnel + rise, Meaning.PLUME)
        altitude, highest = self._column("altitude_m"), max(height for height, _ in levels.values())
        # The true wind is dashed. A level that nearly all of the flight lies upon would be in the
        # legend alone.
        lines = [
            across(self._view.ends, height, label, colour, "thin")
            for label, (height, colour) in levels.items()
            if np.nanquantile(np.abs(altitude - height), 0.95) > _HIDDEN
        ]
        y_range = (
            min(funnel - 1.0, float(altitude.min()) - 0.2),
            max(highest + 1.0, float(altitude.max()) + 0.2),
        )
        return Panel(
            x_label=_TIME,
            y_label="Height [m]",
            lines=[*lines, self._line(altitude)],
            y_range=y_range,
        )

    def _added_panels(self) -> list[Panel]:
        """Return what users' instruments read, a panel each, of columns with any number."""
        run, samples = self._view.trial.run, self._view.samples
        declared = run.columns.get(FLIGHTS, samples)
        # An instrument may declare columns by its objects alone, which the run does not know before
        # it flies.
        undeclared = {
            name: run.column(name, FLIGHTS) for name in map(str, samples) if name not in declared
        }
        return [
            Panel(
                x_label=_TIME,
                y_label=of.label,
                lines=[self._line(of.scale * column(samples, name))],
            )
            for name, of in (run.added(FLIGHTS) | undeclared).items()
            if is_figure(samples, name)
        ]

    def _mode_panel(self) -> Panel | None:
        """Return the modes that occur, a row each, by name if the run has names; None for a flight
        in one mode.
        """
        mode, names = self._column("mode"), self._view.trial.run.manifest.get("modes", [])
        occurring = [float(m) for m in np.unique(mode[np.isfinite(mode)])]
        if len(occurring) < 2:
            return None
        # Mode k lies on row i of those that occur; steps from one to the next are upright.
        index = np.searchsorted(occurring, mode).astype(np.float64)
        steps = np.append(np.flatnonzero(np.diff(index)), len(index) - 1)
        starts = np.append(0, steps[:-1] + 1)
        times = np.ravel(np.column_stack([self._view.time[starts], self._view.time[steps]]))
        rows = np.repeat(index[starts], 2)
        return Panel(
            x_label=_TIME,
            y_label="Mode",
            lines=[Line(x=times, y=rows, label="flown", colour=Meaning.FLOWN)],
            y_range=(-0.5, len(occurring) - 0.5),
            y_names=[
                (float(i), names[int(m)] if m < len(names) else f"mode {m:g}")
                for i, m in enumerate(occurring)
            ],
        )
