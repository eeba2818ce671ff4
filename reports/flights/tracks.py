"""Tracks of flights: about the ship with her plume up the page, at the plume from near, and over the ground."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Note, Panel, circle
from reports.document.map_marks import hull_line, on_map, plume_lines
from reports.document.palette import Meaning
from reports.flights.flight_view import FlightView, Place
from reports.run.columns import Array, column
from reports.run.plume_shape import PlumeShape, plume_shape
from reports.run.ship import hull_of
from reports.run.time_history import about_the_plume, turned, vessel_heading
from reports.run.trials import Trial

_STEPS = (10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0)
"""Times between marks along a track [s]."""

_MARKS_MAX = 8
"""Marks of the time along a track at most."""

_NEAR_PERIODS = 2.0
"""Periods of the oscillation that are shown from near, at the end of the flight."""

_NEAR_S = 60.0
"""The same of a flight without an oscillation [s]."""

_NEARER = 0.5
"""Size of what is shown from near, over that of the whole, up to which it has a panel of its own."""

_BESIDE, _WIDE, _FLAT = 1.2, 1.9, 4.4
"""Width over height: of a panel that has another beside it, of one that is alone, and of one over the ground."""

_AWAY = 1.5
"""Way of the ship over the size of the track about her, from which there is a panel over the ground."""


def track_charts(view: FlightView) -> list[Chart]:
    """Return where one flight went: about the ship, and over the ground."""
    return _Tracks(view).charts()


def track_chart(flights: Sequence[tuple[Trial, "pd.Series[Any]", str]], *, name: str = "picture") -> Chart | None:
    """Return a large picture of one flight about its ship, or of a few side by side; None if none has a time history.

    Parameters
    ----------
    flights : each with its trial, its row and what is written above it
    name : of the chart
    """
    views = []
    for trial, row, title in flights:
        history = trial.run.history(str(row["flight_id"]))
        if history is not None and len(history) > 1:
            views.append((_Tracks(FlightView(trial, row, history)), title))
    if not views:
        return None
    aspect = _WIDE if len(views) == 1 else _BESIDE
    panels = [in_kilometres(tracks.about(title, aspect) if tracks.view.vessel else tracks.ground(title)) for tracks, title in views]
    caption = views[0][0].caption()
    return Chart(name=name, caption=caption, panels=panels, columns=len(panels), panel_height=0.5 if len(views) == 1 else 0.45)


class _Tracks:
    """The panels of one flight's tracks."""

    def __init__(self, view: FlightView) -> None:
        self.view = view
        self._trial, self._row = view.trial, view.row
        self._hull = hull_of(self._trial.config)
        heading = vessel_heading(view.whole, float(self._trial.setting("vessel.course_deg", 0.0)))
        # What stands still in these panels is as it was at the closest approach.
        self._heading = float(heading[view.whole.index.get_loc(view.closest.index[0])])
        self._axis = float(view.closest["plume_axis_rad"].iloc[0]) if view.vessel else 0.0
        self._shape = self._plume() if view.vessel else None
        self._step = next((s for s in _STEPS if view.ends[1] / s <= _MARKS_MAX), _STEPS[-1])

    def charts(self) -> list[Chart]:
        """Return its charts."""
        if not self.view.vessel:
            panel = in_kilometres(self.ground())
            return [Chart(name="tracks", caption="Over the ground.", panels=[panel], panel_height=0.42)]
        near, ground = self._near(), self.ground() if self._way() is not None else None
        panels = [self.about("The whole flight", _BESIDE if near else _WIDE), *([near] if near else [])]
        over = " Below, over the ground, with ship, keep-out area and plume as they were at the closest approach." if ground else ""
        return [
            Chart(
                name="tracks",
                caption=self.caption() + over,
                panels=[in_kilometres(panel) for panel in [*panels, *([ground] if ground else [])]],
                columns=len(panels),
                panel_height=0.36,
                last_height=0.19 if ground else 0.0,
            )
        ]

    def caption(self) -> str:
        """Return what a panel about the ship shows, in words."""
        shape = "sphere" if self._trial.shape == "sphere" else "cylinder"
        hull, smoke = self._hull, self._shape is not None and self._shape.smoke
        width = " Its width is two standard deviations of the mean smoke to either side." if smoke else ""
        moved = " Ship, north and wind are as they were at the closest approach." if self._moved() else ""
        return (
            f"Seen from the ship, with the axis of her plume up the page.{width} The keep-out {shape} is about her funnel; her hull"
            f" is that of {hull.title}, {hull.length:g} m by {hull.beam:g} m, as the scenario gives none.{moved}"
        )

    def _moved(self) -> bool:
        """Return whether the course along which the plume trails changed."""
        return bool(np.ptp(np.unwrap(column(self.view.samples, "plume_axis_rad"))) > math.radians(2.0))

    def _plume(self) -> PlumeShape:
        """Return the plume's shape, in the wind and at the ship's speed that the flight began with."""
        north, east = (float(column(self.view.whole, f"vessel_velocity_{axis}_mps")[0]) for axis in ("north", "east"))
        wind, towards = self._wind()
        apparent = math.hypot(wind * math.cos(towards) - north, wind * math.sin(towards) - east)
        reach = 1.2 * float(np.nanmax(np.hypot(*about_the_plume(self.view.samples))))
        length = max(1.6 * self.view.radius, min(reach, 4.0 * self.view.radius))
        return plume_shape(self._trial.config, speed=math.hypot(north, east), wind=wind, apparent_wind=apparent, length=length)

    def _wind(self) -> tuple[float, float]:
        """Return the wind's speed [m/s] and the course that it blows along [rad]: it is given by where it comes from."""
        speed, origin = (float(self._row.get(name, math.nan)) for name in ("wind_speed_mps", "wind_from_deg"))
        return (speed, math.radians(origin) + math.pi) if speed > 0.0 and math.isfinite(origin) else (0.0, 0.0)

    def _still(self, up: float, x: float, y: float, angle: float) -> list[Line]:
        """Return plume, keep-out area and ship where the page's course ``up`` is up, her funnel at a place."""
        if self._shape is None:
            return []
        right, along = circle(self.view.radius)
        hull = self._hull
        return [
            Line(x=x + right, y=y + along, label="keep-out area, r_min", colour=Meaning.LIMIT, fill=True),
            *plume_lines(self._shape.distance, self._shape.half_width if self._shape.smoke else None, angle, x, y),
            hull_line(hull.length, hull.beam, hull.funnel, self._heading - up, x, y),
        ]

    def about(self, title: str, aspect: float) -> Panel:
        """Return the whole flight, seen from the ship with her plume up the page."""
        view = self.view
        lines = [
            *self._still(self._axis, 0.0, 0.0, 0.0),
            *view.guarded(about_the_plume),
            view.line(about_the_plume, view.samples, "flown", Meaning.FLOWN),
            self._reference(about_the_plume, view.samples),
            *view.marks(about_the_plume),
            *view.ends_of(about_the_plume),
        ]
        times, notes = self._times(about_the_plume, until=view.settled_at)
        return self._about([*lines, *times], notes, title, aspect)

    def _near(self) -> Panel | None:
        """Return the last of the flight from near; None where it never settled, or where the whole is no larger."""
        view, period = self.view, math.tau / float(self._row.get("omega_0_rad_s", math.nan))
        last = _NEAR_PERIODS * period if math.isfinite(period) else _NEAR_S
        begin = max(view.settled_at, float(view.ends[1]) - last)
        late = view.since(begin)
        if late is None:
            return None
        shown = late.whole
        track = view.line(about_the_plume, shown, "flown", Meaning.FLOWN)
        size, whole = (max(float(np.ptp(x)), float(np.ptp(y))) for x, y in ((track.x, track.y), about_the_plume(view.samples)))
        if size > _NEARER * max(whole, 2.0 * view.radius):
            return None
        reference = self._reference(about_the_plume, shown)
        lines = [*self._still(self._axis, 0.0, 0.0, 0.0), *late.guarded(about_the_plume), track, reference]
        marks = late.marks(about_the_plume)
        return self._about([*lines, *marks], [], f"The last {view.ends[1] - begin:.0f} s", _BESIDE, [track, reference])

    def _about(self, lines: Sequence[Line], notes: Sequence[Note], title: str, aspect: float, shown: Sequence[Line] = ()) -> Panel:
        """Return a panel about the ship as a map."""
        panel = Panel(x_label="Right of the plume's axis [m]", y_label="Along it [m]", title=title, lines=lines, notes=notes)
        wind, towards = self._wind()
        return on_map(panel, north=-self._axis, wind=(wind, towards - self._axis), shown=shown, aspect=aspect)

    def ground(self, title: str = "") -> Panel:
        """Return the flight over the ground: along the way of a ship that goes far, else with north up the page."""
        view = self.view
        way = self._way()
        up = way or 0.0

        def place(samples: pd.DataFrame, prefix: str = "") -> tuple[Array, Array]:
            return turned(column(samples, f"{prefix}north_m"), column(samples, f"{prefix}east_m"), up)

        lines: list[Line] = []
        if view.vessel:
            x, y = place(view.closest, "vessel_")
            lines += self._still(up, float(x[0]), float(y[0]), self._axis - up)
            x, y = place(view.samples, "vessel_")
            lines.append(Line(x=x, y=y, label="ship's track", colour=Meaning.SHIP, style="thin"))
        lines += [
            *view.guarded(place),
            view.line(place, view.samples, "flown", Meaning.FLOWN),
            *([] if view.vessel else [self._reference(place, view.samples)]),
            *view.marks(place),
            *view.ends_of(place),
        ]
        times, notes = self._times(place, until=float(view.ends[1]), beside=way is None)
        labels = ("East [m]", "North [m]") if way is None else ("Along the ship's way [m]", "To port [m]")
        panel = Panel(x_label=labels[0], y_label=labels[1], title=title, lines=[*lines, *times], notes=notes)
        wind, towards = self._wind()
        return on_map(panel, north=-up, wind=(wind, towards - up), aspect=_WIDE if way is None else _FLAT)

    def _way(self) -> float | None:
        """Return the course that puts the ship's way across the page [rad]; None where she does not go far."""
        view = self.view
        if not view.vessel:
            return None
        north, east = (float(np.diff(column(view.whole, f"vessel_{axis}_m")[[0, -1]])[0]) for axis in ("north", "east"))
        size = float(np.nanmax(np.hypot(*about_the_plume(view.samples))))
        return math.atan2(east, north) - 0.5 * math.pi if math.hypot(north, east) > _AWAY * size else None

    @staticmethod
    def _reference(place: Place, samples: pd.DataFrame) -> Line:
        """Return the reference, thin, to be drawn over the track."""
        x, y = place(_reference_of(samples))
        return Line(x=x, y=y, label="reference", colour=Meaning.ASKED, style="thin")

    def _times(self, place: Place, *, until: float, beside: bool = True) -> tuple[list[Line], list[Note]]:
        """Return marks along the track at round times up to some [s], and what they say: beside the track or above it all."""
        times = np.arange(self._step, until - 0.3 * self._step, self._step)
        if not len(times):
            return [], []
        x, y = place(self.view.at_times(times))
        high = float(np.max(place(self.view.samples)[1])) + self.view.radius
        notes = [
            Note(x=float(right), y=float(up), text=f"  {_duration(time)}", align="left")
            if beside
            else Note(x=float(right), y=high, text=_duration(time))
            for right, up, time in zip(x, y, times.tolist(), strict=True)
        ]
        return [Line(x=x, y=y, label="", colour=Meaning.SHIP, style="dots")], notes


def _reference_of(samples: pd.DataFrame) -> pd.DataFrame:
    """Return samples with the reference in the place of the aircraft."""
    return samples.assign(north_m=samples["reference_north_m"], east_m=samples["reference_east_m"])


def _duration(seconds: float) -> str:
    return f"{seconds / 60.0:g} min" if seconds >= 60.0 else f"{seconds:g} s"
