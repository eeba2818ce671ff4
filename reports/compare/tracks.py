"""The flight that differs most between two runs: both tracks in one figure."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

from reports.compare.pairs import JUDGED, Difference, Pairs, Run
from reports.document.axes import in_kilometres
from reports.document.chart import Chart, Line, Panel, circle
from reports.document.ship_map import ship_panel, ship_words
from reports.run.columns import Array, column
from reports.run.flight_config import Config, flight_config
from reports.run.surroundings import Surroundings, surroundings
from reports.run.time_history import (
    ERROR_MIN,
    about_the_plume,
    flight_points,
    floor_words,
    keepout_distance,
    thinned,
    tracking_error,
)

_ASPECT = 1.1
"""Width of a map over its height [-]."""

_COLOURS = ("blue", "orange")
"""Colours of the first run and of the other."""


def most_changed(pairs: Pairs, found: dict[str, Difference]) -> Chart | None:
    """Return both flights of the pair that differs most, of those that have both time histories;
    None if nothing differs.

    Flights whose criteria changed come first. Then it is the largest difference over the figure's
    median in the first run, of the figures that most reports judge.
    """
    recorded = [
        pairs.first.data.has_history(before) and pairs.other.data.has_history(after)
        for before, after in zip(pairs.names, map(str, pairs.after["flight_id"]), strict=True)
    ]
    changes = {name: _relative(found[name]) for name in JUDGED if name in found}
    if not changes or not any(recorded):
        return None
    table = np.array(list(changes.values()))
    turned = pairs.no_longer_met | pairs.newly_met
    size = np.where(recorded, table.max(axis=0) + np.where(turned, 1.0 + table.max(), 0.0), 0.0)
    place = int(np.argmax(size))
    if not size[place] > 0.0:
        return None
    figure = found[list(changes)[int(np.argmax(table[:, place]))]]
    return _chart(
        pairs, place, _state(pairs, place) if turned[place] else _change(pairs, place, figure)
    )


def _relative(difference: Difference) -> Array:
    """Return how large each difference is over the median in the first run; 0 where it is not known
    [-].
    """
    typical = float(np.nanmedian(np.abs(difference.before)))
    size: Array = (
        np.nan_to_num(np.abs(difference.change)) / typical
        if typical > 0.0
        else np.zeros(len(difference.before))
    )
    return size


def _state(pairs: Pairs, place: int) -> str:
    runs = (pairs.first, pairs.other) if pairs.no_longer_met[place] else (pairs.other, pairs.first)
    return f"meets its criteria in {runs[0].letter}, and not in {runs[1].letter}"


def _change(pairs: Pairs, place: int, difference: Difference) -> str:
    figure = difference.figure
    before, after = (
        f"{values[place]:.{figure.digits}f}{figure.after}"
        for values in (difference.before, difference.after)
    )
    return f"{figure.title}: {before} in {pairs.first.letter}, {after} in {pairs.other.letter}"


def _chart(pairs: Pairs, place: int, why: str) -> Chart | None:
    flown: list[_Flight] = []
    for run, rows, colour in zip(
        (pairs.first, pairs.other), (pairs.before, pairs.after), _COLOURS, strict=True
    ):
        row = rows.iloc[place]
        history = run.data.history(str(row["flight_id"]))
        if history is None or len(history) < 2:
            return None
        flown.append(
            _Flight(
                run=run, row=row, history=thinned(history, flight_points(history)), colour=colour
            )
        )
    vessel = all(np.isfinite(column(flight.history, "vessel_north_m")).any() for flight in flown)
    about = _about(flown[0]) if vessel else None
    panels = [_whole(flown, about), _settled(flown, about)] if about else [_over_the_ground(flown)]
    floor = floor_words(flight.history for flight in flown)
    names = {"flight": pairs.names[place], "why": why, "floor": floor}
    caption = _CAPTION.format(**names)
    if about:
        caption += _BESIDE.format(ship=ship_words(about), first=pairs.first.letter)
    return Chart(
        name=f"changed{pairs.other.letter}",
        caption=caption,
        panels=[in_kilometres(panel) for panel in (*panels, _errors(flown))],
        columns=len(panels),
        panel_height=0.42,
        last_height=0.2,
    )


_CAPTION = "The flight that differs most, {flight}: {why}.{floor}"
_BESIDE = " {ship} Ship, filled area, plume, wind and north are as in {first}."


def _about(flight: "_Flight") -> Surroundings:
    """Return what was about a flight at its closest approach."""
    nearest = int(np.nanargmin(keepout_distance(flight.history, flight.config)))
    return surroundings(flight.config, flight.row, flight.history, nearest)


@dataclass(frozen=True, slots=True, kw_only=True)
class _Flight:
    """One of both flights: its run, its row, its thinned time history, and its colour."""

    run: Run
    row: "pd.Series[Any]"
    history: pd.DataFrame
    colour: str

    @property
    def config(self) -> Config:
        """Return the configuration of the flight itself."""
        return flight_config(self.run.data, self.row)

    @property
    def radius(self) -> float:
        """Return r_min [m]."""
        return float(self.row["keepout_radius_m"])

    def curve(self, x: Array, y: Array) -> Line:
        return Line(x=x, y=y, label=self.run.title, colour=self.colour)

    def over_time(self, y: Array) -> Line:
        return self.curve(column(self.history, "time_s"), y)


def _whole(flown: list[_Flight], about: Surroundings) -> Panel:
    """Return both tracks about the ship of the first flight; where the other has another keep-out
    area, that as well.
    """
    lines = [flight.curve(*about_the_plume(flight.history)) for flight in flown]
    if (other := flown[1]).radius != about.radius:
        x, y = circle(other.radius)
        lines.insert(
            0,
            Line(x=x, y=y, label=f"r_min of {other.run.letter}", colour=other.colour, style="dash"),
        )
    return ship_panel(about, lines, title="Whole flight", aspect=_ASPECT)


def _settled(flown: list[_Flight], about: Surroundings) -> Panel:
    """Return the track of each flight from when it had settled; of one that never had, the second
    half.
    """
    settled = [float(flight.row["settling_time_s"]) for flight in flown]
    tracks = []
    for flight, begin in zip(flown, settled, strict=True):
        time = flight.history["time_s"]
        late = flight.history[
            time >= (begin if math.isfinite(begin) else 0.5 * float(time.iloc[-1]))
        ]
        tracks.append(flight.curve(*about_the_plume(late)))
    title = (
        "Each once settled"
        if all(map(math.isfinite, settled))
        else "Each once settled, or its second half"
    )
    return ship_panel(about, tracks, title=title, shown=tracks, aspect=_ASPECT)


def _over_the_ground(flown: list[_Flight]) -> Panel:
    lines = [
        flight.curve(column(flight.history, "east_m"), column(flight.history, "north_m"))
        for flight in flown
    ]
    return Panel(
        x_label="East [m]", y_label="North [m]", title="Over the ground", equal=True, lines=lines
    )


def _errors(flown: list[_Flight]) -> Panel:
    errors = [np.maximum(tracking_error(flight.history), ERROR_MIN) for flight in flown]
    top = 10.0 * max(float(np.nanmax(error)) for error in errors)
    return Panel(
        x_label="Time [s]",
        y_label="Tracking error [m]",
        title="Tracking error",
        lines=[flight.over_time(error) for flight, error in zip(flown, errors, strict=True)],
        log_y=True,
        y_range=(ERROR_MIN, top),
    )
