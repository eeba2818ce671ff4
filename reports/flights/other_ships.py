"""The ships besides the one that is measured, on the maps of a flight and in the words below."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from reports.document.chart import Line, circle
from reports.document.palette import Meaning
from reports.flights.flight_view import FlightView
from reports.run.columns import Array, column

_NEAR = 1500.0
"""Distance beyond its radius within which another ship is drawn [m]."""

_AROUND = 60.0
"""Time before and after its closest approach for which its track is drawn [s]."""

_NAMED = 6
"""Ships whose closest approach is told, at most."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherShip:
    """Another ship, as a flight came nearest to it.

    Attributes
    ----------
    name, radius : of it, and what is kept from its [m]
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
    told = "; ".join(
        f"{ship.name} {ship.distance:.0f} m (r = {ship.radius:g} m) at {ship.at:.0f} s"
        for ship in ships[:_NAMED]
    )
    more = f"; {len(ships) - _NAMED} more stayed farther off" if len(ships) > _NAMED else ""
    return (
        f" Closest approach to each other ship: {told}{more}. Dashed: their areas at that moment,"
        " and their ways a minute before and after."
    )
