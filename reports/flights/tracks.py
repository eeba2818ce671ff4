"""Tracks of flights, thinned to what figures show: about the ship with its plume up the page, from
near, and over the ground, with the other ships.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from reports.document.axes import in_kilometres
from reports.document.chart import Band, Chart, Line, Note, Panel, Style, circle
from reports.document.palette import Meaning
from reports.document.ship_map import on_map, ship_lines, ship_panel, ship_words
from reports.run.columns import Array, column
from reports.run.surroundings import Surroundings, surroundings
from reports.run.time_history import (
    about_the_plume,
    flight_points,
    guard_stretches,
    keepout_distance,
    turned,
)
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
                # A part goes from sample to sample: a single one has a length. A gap follows.
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
    """Return ``_BANDS_MAX`` stretches of time at most: the shortest gaps are closed."""
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


_NEAR = 1500.0
"""Distance beyond its radius within which another ship is drawn [m]."""

_AROUND = 60.0
"""Time before and after the closest approach for which the track of the ship is drawn [s]."""

_NAMED = 6
"""Ships whose closest approach is named, at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherShip:
    """Another ship, as a flight came nearest to it.

    Attributes
    ----------
    name, radius : of it, and what is kept from it [m]
    distance, at : of the closest approach [m, s]
    track : time, north and east about then, shape (n, 3) [s, m]
    vessel : where the measured ship was at these times, north and east, shape (n, 2) [m]
    place : of it at the closest approach, north and east over the ground [m]
    vessel_then : of the measured ship then, likewise
    """

    name: str
    radius: float
    distance: float
    at: float
    track: Array
    vessel: Array
    place: tuple[float, float]
    vessel_then: tuple[float, float]


def other_ships(view: FlightView) -> list[OtherShip]:
    """Return the other ships of a flight, the one first whose radius it came nearest to."""
    recorded = view.trial.run.traffic(str(view.row["flight_id"]))
    time = column(view.whole, "time_s")
    own, measured = (
        np.column_stack([column(view.whole, f"{prefix}{axis}_m") for axis in ("north", "east")])
        for prefix in ("", "vessel_")
    )
    found = []
    for ship in recorded:
        times, north, east = (np.asarray(ship[name]) for name in ("time", "north", "east"))
        known = (time >= times[0]) & (time <= times[-1])
        if not known.any():
            continue
        places = np.column_stack([np.interp(time, times, axis) for axis in (north, east)])
        distances = np.where(known, np.hypot(*(own - places).T), math.inf)
        nearest = int(np.argmin(distances))
        about = (times >= time[nearest] - _AROUND) & (times <= time[nearest] + _AROUND)
        found.append(
            OtherShip(
                name=str(ship["name"]),
                radius=float(ship["radius"]),
                distance=float(distances[nearest]),
                at=float(time[nearest]),
                track=np.column_stack([times, north, east])[about],
                vessel=np.column_stack(
                    [np.interp(times[about], time, axis) for axis in measured.T]
                ),
                place=(float(places[nearest, 0]), float(places[nearest, 1])),
                vessel_then=(float(measured[nearest, 0]), float(measured[nearest, 1])),
            )
        )
    return sorted(found, key=lambda of: of.distance - of.radius)


def other_ship_lines(
    ships: Sequence[OtherShip],
    placed: Callable[[Array, Array], tuple[Array, Array]],
    *,
    relative: bool,
) -> list[Line]:
    """Return the areas of ships that were near, as they were at their closest approach, and their
    tracks about then.

    Parameters
    ----------
    ships : of the flight
    placed : where places north and east are on the page
    relative : whether places are seen from the measured ship
    """
    lines = []
    for ship in ships:
        if ship.distance - ship.radius > _NEAR:
            continue
        place, track = np.array(ship.place), ship.track[:, 1:]
        if relative:
            place, track = place - np.array(ship.vessel_then), track - ship.vessel
        x, y = placed(track[:, 0], track[:, 1])
        right, along = circle(ship.radius)
        centre = placed(place[:1], place[1:])
        label = f"{ship.name}, r = {ship.radius:g} m"
        lines += [
            Line(x=x, y=y, label="", colour=Meaning.SHIP, style="dash"),
            Line(
                x=centre[0] + right,
                y=centre[1] + along,
                label=label,
                colour=Meaning.LIMIT,
                style="dash",
            ),
        ]
    return lines


def other_ship_words(ships: Sequence[OtherShip]) -> str:
    """Return how near a flight came to each other ship, for a caption; nothing without any."""
    if not ships:
        return ""
    named = "; ".join(
        f"{ship.name} {ship.distance:.0f} m (r = {ship.radius:g} m) at {ship.at:.0f} s"
        for ship in ships[:_NAMED]
    )
    more = f"; {len(ships) - _NAMED} more stayed farther off" if len(ships) > _NAMED else ""
    return (
        f" Closest approach to each other ship: {named}{more}. Dashed: their areas at that moment,"
        " and their ways a minute before and after."
    )


_STEPS = (10.0, 30.0, 60.0, 120.0, 300.0, 600.0, 1800.0, 3600.0)
"""Times between marks along a track [s]."""

_MARKS_MAX = 8
"""Marks of the time along a track at most."""

_NEAR_PERIODS = 2.0
"""Periods of the oscillation that are shown from near, at the end of the flight."""

_NEAR_S = 60.0
"""The same of a flight without an oscillation [s]."""

_NEARER = 0.5
"""Size of what is shown from near, over that of the whole, up to which it has another panel."""

_UPRIGHT, _LARGE, _BESIDE, _WIDE, _FLAT = 0.66, 1.05, 1.2, 1.9, 4.8
"""Width over height: of one of two flights on page 1, of one of two of a flight there, of such on
the page of a flight, alone, and over the ground."""

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
    shown: Sequence[tuple[Trial, "pd.Series[Any]", str]], remark: str = ""
) -> Chart | None:
    """Return a large picture of flights side by side, each about its ship; all tracks of a flight
    that is alone.

    Parameters
    ----------
    shown : trial, row and title of each flight
    remark : what the caption says besides

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
        return replace(chart, name=_PICTURE, caption=chart.caption + remark)
    panels = [tracks.picture(title) for tracks, title in found]
    words = _words([tracks.about for tracks, _ in found])
    return Chart(
        name=_PICTURE, caption=words + remark, panels=panels, columns=len(panels), panel_height=0.42
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
        return Line(x=x, y=y, label="reference", colour=Meaning.COMMANDED, style="thin")

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
