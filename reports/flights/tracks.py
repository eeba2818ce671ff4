"""Tracks of flights: about the ship with its plume up the page, at the plume from near, and over
the ground.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Note, Panel
from reports.document.map_marks import on_map
from reports.document.palette import Meaning
from reports.document.ship_map import ship_lines, ship_panel, ship_words
from reports.flights.flight_view import FlightView, Place, flight_view
from reports.flights.other_ships import other_ship_lines, other_ship_words, other_ships
from reports.run.columns import Array, column
from reports.run.surroundings import Surroundings, surroundings
from reports.run.time_history import about_the_plume, turned
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
"""Size of what is shown from near, over that of the whole, up to which it has a panel of its own.
"""

_UPRIGHT, _LARGE, _BESIDE, _WIDE, _FLAT = 0.66, 1.05, 1.2, 1.9, 4.8
"""Width over height: of one of two flights on page 1, of one of two of a flight there, of such on
its own page, alone, and over the ground."""

_ABOVE = 0.08
"""Height of words above what is drawn over the ground, over the height of the panel."""

_APART, _UNDER = 0.12, 0.012
"""Distance of these words at least, and of a word from the end of the line that leads to it from
its mark, over the length of the row.
"""

TIMES = "time since the start"
"""What the legend calls the marks."""

_AWAY = 1.0
"""Way of the ship over the size of the track about its, from which there is a panel over the
ground.
"""

_FILLED, _HIGHER, _GROUND = 0.5, 1.5, 0.19
"""Part of that panel's width that the tracks fill at least, or else it is higher, by this factor;
and its height, over the width of the page."""

_TURNED, _LEGS, _NORTH_UP = math.radians(10.0), 40, 0.25
"""Change of the ship's course from which north is up over the ground, parts of the flight that have
one, and that map's height.
"""

_WAY = "ship's track"
"""What the legend calls the way of a ship over the ground."""

_PICTURE = "picture"
"""Name of the large picture."""


def track_chart(view: FlightView) -> Chart:
    """Return where one flight went: about the ship, its plume up the page, from near, and over the
    ground.
    """
    return _Tracks(view).chart()


def track_picture(
    shown: Sequence[tuple[Trial, "pd.Series[Any]", str]], told: str = ""
) -> Chart | None:
    """Return a large picture of flights side by side, each about its ship; all tracks of a flight
    that is alone.

    Parameters
    ----------
    shown : trial, row and title of each flight
    told : what the caption says besides

    Returns
    -------
    The figure, or None if no flight has a time history.
    """
    found = [
        (_Tracks(view), title)
        for trial, row, title in shown
        if (view := flight_view(trial, row)) is not None
    ]
    if not found:
        return None
    if len(found) == 1:
        chart = found[0][0].chart(_LARGE)
        return replace(chart, name=_PICTURE, caption=chart.caption + told)
    panels = [tracks.picture(title) for tracks, title in found]
    words = _words([tracks.about for tracks, _ in found])
    return Chart(
        name=_PICTURE, caption=words + told, panels=panels, columns=len(panels), panel_height=0.42
    )


class _Tracks:
    """The panels of one flight's tracks."""

    def __init__(self, view: FlightView) -> None:
        self.view = view
        nearest = int(view.whole.index.get_indexer(view.closest.index)[0])
        # What stands still in a panel is as it was at the closest approach.
        self.about = (
            surroundings(view.config, view.row, view.whole, nearest) if view.vessel else None
        )
        self._others = other_ships(view)

    def chart(self, aspect: float = _BESIDE) -> Chart:
        """Return where it went; of two panels beside each other each has an aspect."""
        about = self.about
        if about is None:
            return Chart(
                name="tracks",
                caption=_words([about]) + other_ship_words(self._others),
                panels=[in_kilometres(self.ground())],
                panel_height=0.42,
            )
        near, (ground, height) = self._near(about, aspect), self._below()
        panels = [
            self._whole(about, "The whole flight", aspect if near else _WIDE),
            *([near] if near else []),
        ]
        return Chart(
            name="tracks",
            caption=_words([about]) + _GROUND_WORDS * bool(ground) + other_ship_words(self._others),
            panels=[in_kilometres(panel) for panel in [*panels, *([ground] if ground else [])]],
            columns=len(panels),
            panel_height=0.28,
            last_height=height,
        )

    def picture(self, title: str) -> Panel:
        """Return the whole flight in one panel."""
        return in_kilometres(
            self.ground(title) if self.about is None else self._whole(self.about, title, _UPRIGHT)
        )

    def _whole(self, about: Surroundings, title: str, aspect: float) -> Panel:
        """Return the whole flight, seen from the ship with its plume up the page."""
        view = self.view
        lines = [
            *view.guarded(about_the_plume),
            view.line(about_the_plume, view.samples, "flown", Meaning.FLOWN),
            self._reference(about_the_plume, view.samples),
            *view.marks(about_the_plume),
            *view.ends_of(about_the_plume),
        ]
        ship = ship_lines(about, about.axis)
        lines += other_ship_lines(
            self._others, lambda north, east: turned(north, east, about.axis), relative=True
        )
        return ship_panel(about, lines, title=title, shown=[*ship, *lines], aspect=aspect)

    def _near(self, about: Surroundings, aspect: float) -> Panel | None:
        """Return the last of the flight from near; None where it never settled, or where the whole
        is no larger.
        """
        view, rate = self.view, float(self.view.row.get("omega_0_rad_s", math.nan))
        last = _NEAR_PERIODS * math.tau / rate if rate > 0.0 else _NEAR_S
        begin = max(view.settled_at, float(view.ends[1]) - last)
        late = view.since(begin)
        if late is None:
            return None
        track = late.line(about_the_plume, late.whole, "flown", Meaning.FLOWN)
        reference = self._reference(about_the_plume, late.whole)
        size, whole = (
            max(float(np.ptp(x)), float(np.ptp(y)))
            for x, y in ((track.x, track.y), about_the_plume(view.samples))
        )
        if size > _NEARER * max(whole, 2.0 * view.radius):
            return None
        lines = [*late.guarded(about_the_plume), track, reference, *late.marks(about_the_plume)]
        title = f"The last {view.ends[1] - begin:.0f} s"
        return ship_panel(about, lines, title=title, shown=[track, reference], aspect=aspect)

    def _below(self) -> tuple[Panel | None, float]:
        """Return the flight over the ground, beside a ship that goes far, and its height; nothing
        of any other.
        """
        if not self._goes_far():
            return None, 0.0
        if self._way() is None:
            return self.ground(), _NORTH_UP
        panel = self.ground()
        places = np.concatenate([line.x for line in panel.lines if line.label in ("flown", _WAY)])
        left, right = panel.x_range or (-math.inf, math.inf)
        if float(np.ptp(places)) >= _FILLED * (right - left):
            return panel, _GROUND
        return self.ground(flat=_FLAT / _HIGHER), _GROUND * _HIGHER

    def ground(self, title: str = "", flat: float = _FLAT) -> Panel:
        """Return the flight over the ground: flat, along the way of a ship that goes far and
        straight; else with north up.
        """
        view, about, way = self.view, self.about, self._way()
        up = way or 0.0

        def place(samples: pd.DataFrame, prefix: str = "") -> tuple[Array, Array]:
            return turned(
                column(samples, f"{prefix}north_m"), column(samples, f"{prefix}east_m"), up
            )

        lines: list[Line] = []
        if about is not None:
            (x, y), track = place(view.closest, "vessel_"), place(view.samples, "vessel_")
            lines += ship_lines(about, up, float(x[0]), float(y[0]))
            lines.append(
                Line(x=track[0], y=track[1], label=_WAY, colour=Meaning.SHIP, style="thin")
            )
        lines += [
            *view.guarded(place),
            view.line(place, view.samples, "flown", Meaning.FLOWN),
            *([] if view.vessel else [self._reference(place, view.samples)]),
            *view.marks(place, far=self._goes_far()),
            *view.ends_of(place),
        ]
        lines += other_ship_lines(
            self._others, lambda north, east: turned(north, east, up), relative=False
        )
        marked, notes = ([], []) if way is None else self._times(place, lines)
        labels = (
            ("East [m]", "North [m]")
            if way is None
            else ("Along the ship's way [m]", "To port [m]")
        )
        panel = Panel(
            x_label=labels[0], y_label=labels[1], title=title, lines=[*lines, *marked], notes=notes
        )
        wind = None if about is None else (about.wind[0], about.wind[1] - up)
        if way is None:
            wide, high = np.ptp(
                np.array(
                    [place(view.samples), place(view.samples, "vessel_" if view.vessel else "")]
                ),
                axis=(0, 2),
            )
            flat = float(np.clip(wide / max(high, 1.0), _BESIDE, _WIDE))
        return on_map(panel, north=-up, wind=wind, aspect=flat)

    def _ship(self) -> Array:
        """Return where the ship was, north and east, shape (n, 2) [m]."""
        return np.column_stack(
            [column(self.view.samples, f"vessel_{axis}_m") for axis in ("north", "east")]
        )

    def _goes_far(self) -> bool:
        """Return whether there is a ship that goes farther than the track about it is wide."""
        if not self.view.vessel:
            return False
        (north, east), size = (
            np.ptp(self._ship(), axis=0),
            np.nanmax(np.hypot(*about_the_plume(self.view.samples))),
        )
        return bool(np.hypot(north, east) >= _AWAY * size)

    def _way(self) -> float | None:
        """Return the course that puts the ship's way across the page [rad]; None where it does not
        go far, or turns.
        """
        if not self._goes_far():
            return None
        places = self._ship()
        legs = np.diff(
            places[np.linspace(0, len(places) - 1, min(_LEGS + 1, len(places))).astype(int)], axis=0
        )
        legs = legs[np.hypot(*legs.T) > 0.0]
        if float(np.ptp(np.unwrap(np.arctan2(legs[:, 1], legs[:, 0])))) > _TURNED:
            return None
        north, east = places[-1] - places[0]
        return math.atan2(east, north) - 0.5 * math.pi

    @staticmethod
    def _reference(place: Place, samples: pd.DataFrame) -> Line:
        """Return the reference, thin, to be drawn over the track."""
        x, y = place(_reference_of(samples))
        return Line(x=x, y=y, label="reference", colour=Meaning.ASKED, style="thin")

    def _times(self, place: Place, drawn: Sequence[Line]) -> tuple[list[Line], list[Note]]:
        """Return marks at round times along a track that goes across the page, and their words in a
        row above all that is drawn, as many as there is room for; a thin line leads to each.
        """
        end = float(self.view.ends[1])
        step = next((s for s in _STEPS if end / s <= _MARKS_MAX), _STEPS[-1])
        times = np.arange(step, end - 0.3 * step, step)
        (x, y), flown = place(self.view.at_times(times)), place(self.view.samples)
        wide, high = (float(np.ptp(of)) for of in flown)
        length = max(wide, _FLAT * (high + 2.0 * self.view.radius))
        top = max(float(np.nanmax(line.y)) for line in drawn) + _ABOVE * length / _FLAT
        lines = [Line(x=x, y=y, label=TIMES, colour=Meaning.SHIP, style="dots")] * bool(len(x))
        notes: list[Note] = []
        for right, above, time in zip(x.tolist(), y.tolist(), times.tolist(), strict=True):
            if all(abs(right - of.x) > _APART * length for of in notes):
                notes.append(Note(x=right, y=top, text=_duration(time)))
                leads = np.array([above, top - _UNDER * length])
                lines.append(
                    Line(x=np.full(2, right), y=leads, label="", colour=Meaning.SHIP, style="thin")
                )
        return lines, notes


def _words(about: Sequence[Surroundings | None]) -> str:
    """Return what the tracks of flights are seen from, for a caption, given what was about each."""
    beside = [of for of in about if of is not None]
    return ship_words(*beside) if beside else "Over the ground."


_GROUND_WORDS = " Below, over the ground, with the ship as it was at the closest approach."


def _reference_of(samples: pd.DataFrame) -> pd.DataFrame:
    """Return samples with the reference in the place of the aircraft."""
    return samples.assign(north_m=samples["reference_north_m"], east_m=samples["reference_east_m"])


def _duration(seconds: float) -> str:
    return f"{seconds / 60.0:g} min" if seconds >= 60.0 else f"{seconds:g} s"
