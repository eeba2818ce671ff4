"""The places of the ship to which a log is said to belong. A log that lies far from them is of
another ship or another day, or its places or times are not in the stated form.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from common.geodesy import cartesian
from common.tables import MISTAKES
from common.text import utc_text
from measurement.errors import MeasurementError

Array = npt.NDArray[np.float64]

DISTANCE_MOST = 20_000.0
"""Distance beyond which no sniffer finds a ship's exhaust [m]: 3.3 kg/s of CO2, from 20 MW, give
0.6 ppm there in 5 m/s (G. A. Briggs, ATDL 79 (1973), open country, neutral)."""

_SUSPECT, _NEARER = 1000.0, 10.0
"""Least distance, and least factor by which a correction has to bring the log nearer, for an error
message [m, -]."""

_HOURS = (*range(-14, 0), *range(1, 15))
"""Hours that a clock of another zone may be off."""

_COVERED = 60.0
"""Time by which the log may go beyond the ship's track [s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class ShipTrack:
    """The places of a ship.

    Attributes
    ----------
    name : in words, as "MMSI 219999001 (ship.csv)"
    latitude, longitude : shape (n,) [deg]
    time : since 1970 in UTC, rising, shape (n,) [s]; empty for a place where it was all the time
    """

    name: str
    latitude: Array
    longitude: Array
    time: Array


class LoggedPlaces(NamedTuple):
    """The places of an aircraft.

    Attributes
    ----------
    latitude, longitude : NaN where they are unknown, shape (n,) [deg]
    time : since 1970 in UTC, shape (n,) [s], or None for a log of seconds without a date
    lines : of the file, shape (n,)
    """

    latitude: Array
    longitude: Array
    time: Array | None
    lines: npt.NDArray[np.intp]


def distance_words(places: LoggedPlaces, ship: ShipTrack) -> str:
    """Return the distance of a log from its ship, in words.

    Raises
    ------
    MeasurementError : it has no places, or no time in common with the ship's track, or never comes
        near; or correcting a frequent mistake would bring it ten times nearer
    """
    if not np.isfinite(places.latitude + places.longitude).any():
        raise MeasurementError(
            f"there are no latitude and longitude to compare with {ship.name}; name their columns"
            " in [columns], or leave the ship's track out"
        )
    distance = _distance(places, ship)
    if np.isnan(distance).all():
        raise MeasurementError(_no_common_time(places, ship))
    nearest = int(np.nanargmin(distance))
    least, most = float(distance[nearest]), float(np.nanmax(distance))
    mistake, better = min(_mistaken(places, ship), key=lambda of: of[1])
    explained = better < min(DISTANCE_MOST, least / _NEARER)
    if least > DISTANCE_MOST or (least > _SUSPECT and explained):
        beyond = f", and exhaust is measured within {_km(DISTANCE_MOST)} at most"
        raise MeasurementError(
            f"the log comes no nearer than {_km(least)} to {ship.name} (row"
            f" {places.lines[nearest]}){beyond if least > DISTANCE_MOST else ''}"
            f"{f'; with {mistake} it would be {_km(better)}' if explained else ''}: correct places,"
            " times or the ship"
        )
    when = "" if places.time is not None or not len(ship.time) else ", whenever it was there"
    return f"{_km(least)} to {_km(most)} from {ship.name}{when}"


def _distance(places: LoggedPlaces, ship: ShipTrack) -> Array:
    """Return the distance from the ship at each row, NaN where either is not known, shape (n,) [m].

    The ship goes straight from report to report. Without times it is the nearest place of its
    track.
    """
    track = cartesian(np.radians(ship.latitude), np.radians(ship.longitude))
    own = cartesian(np.radians(places.latitude), np.radians(places.longitude))
    if places.time is None or not len(ship.time):
        each = [np.linalg.norm(own - place, axis=-1) for place in track]
        nearest: Array = np.minimum.reduce(each)
        return nearest
    at = np.column_stack([np.interp(places.time, ship.time, axis) for axis in track.T])
    covered = (places.time >= ship.time[0] - _COVERED) & (places.time <= ship.time[-1] + _COVERED)
    return np.where(covered, np.linalg.norm(own - at, axis=-1), np.nan)


def speed_of(ship: ShipTrack, begin: float, end: float) -> float | None:
    """Return a ship's mean speed over ground from report to report [m/s]; None where it is unknown.

    Parameters
    ----------
    begin, end : of the log, since 1970 in UTC [s]; at least a minute counts
    """
    if len(ship.time) < 2:
        return None
    middle, half = 0.5 * (begin + end), max(0.5 * (end - begin), _COVERED)
    first = max(middle - half, float(ship.time[0]))
    last = min(middle + half, float(ship.time[-1]))
    if last - first < _COVERED:
        return None
    inside = ship.time[(ship.time > first) & (ship.time < last)]
    times = np.concatenate([[first], inside, [last]])
    track = cartesian(np.radians(ship.latitude), np.radians(ship.longitude))
    at = np.column_stack([np.interp(times, ship.time, axis) for axis in track.T])
    return float(np.linalg.norm(np.diff(at, axis=0), axis=1).sum()) / (last - first)


def _mistaken(places: LoggedPlaces, ship: ShipTrack) -> Iterator[tuple[str, float]]:
    """Yield possible mistakes, each with the least distance that the log would have without it
    [m].
    """
    for mistake, corrected in MISTAKES.items():
        latitude, longitude = corrected(places.latitude, places.longitude)
        if not np.nanmax(np.abs(latitude)) > 90.0:
            yield mistake, _least(places._replace(latitude=latitude, longitude=longitude), ship)
    if places.time is not None and len(ship.time):
        for hours in _HOURS:
            later = places._replace(time=places.time + 3600.0 * hours)
            yield f"times {abs(hours)} h {'later' if hours > 0 else 'earlier'}", _least(later, ship)


def _least(places: LoggedPlaces, ship: ShipTrack) -> float:
    distance = _distance(places, ship)
    return np.inf if np.isnan(distance).all() else float(np.nanmin(distance))


def _no_common_time(places: LoggedPlaces, ship: ShipTrack) -> str:
    assert places.time is not None  # else every row has a distance
    (first, last), (begin, end) = (
        (utc_text(float(time[0])), utc_text(float(time[-1]))) for time in (places.time, ship.time)
    )
    mistake, better = min(_mistaken(places, ship), key=lambda of: of[1])
    fits = f"; with {mistake} it would come to {_km(better)}" if better < DISTANCE_MOST else ""
    return (
        f"the log goes from {first} to {last}, and the places of {ship.name} from {begin} to"
        f" {end}{fits}: give the ship's places of that time"
    )


def _km(metres: float) -> str:
    return f"{metres / 1000.0:,.1f} km" if metres >= 100.0 else f"{metres:.0f} m"
