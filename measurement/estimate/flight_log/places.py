"""Where a logged flight was."""

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt

from measurement.errors import MeasurementError
from measurement.estimate.flight_log.details import Position
from measurement.sniffer.lag import Array

PLACES = ("latitude", "longitude", "north", "east", "height")
"""Keys of the columns that say where a flight was."""

EARTH_RADIUS_M = 6_371_000.0
"""Mean radius [m]: a track of a few kilometres is laid on a plane."""

SPEED_MOST, _ERROR_M = 340.0, 100.0
"""No aircraft that measures exhaust flies faster [m/s]: the speed of sound; and by how much a place
may be in error [m].
"""

_NONE = np.empty(0, dtype=np.intp)


def places_of(found: dict[str, Array], time: Array, path: Path) -> tuple[dict[str, Array], str]:
    """Return columns of places without those of a receiver that had no fix, and a remark on these,
    or an empty text.

    Parameters
    ----------
    found : columns of the log by ``PLACES``, shape (n,) each [deg, m]
    time : shape (n,) [s]
    path : of the log

    Raises
    ------
    MeasurementError : a latitude or a longitude is out of range, or a place is farther from the one
        before than an aircraft flies
    """
    for name, most in (("latitude", 90.0), ("longitude", 360.0)):
        if name in found and (beyond := np.abs(found[name]) > most).any():
            row = int(np.argmax(beyond))
            raise MeasurementError(
                f"'{path}': {name} is {found[name][row]:g} deg in row {row + 2}; it must be {-most:g} to {most:g}: correct it,"
                " leave it empty, or name what stands for a missing one in the configuration, as in missing = [-9999]"
            )
    found, remark = _with_fix(found)
    _check_jumps(on_a_plane(found), time, path)
    return found, remark


def _with_fix(found: dict[str, Array]) -> tuple[dict[str, Array], str]:
    """Return places without those of latitude and longitude 0, which receivers give that have no
    fix, and which rows these are.
    """
    if not {"latitude", "longitude"} <= set(found):
        return found, ""
    without = (found["latitude"] == 0.0) & (found["longitude"] == 0.0)
    rows = np.flatnonzero(without) + 2
    if not len(rows):
        return found, ""
    named = (
        f"row {rows[0]} is"
        if len(rows) == 1
        else f"{len(rows):,} rows, from row {rows[0]} to row {rows[-1]}, are"
    )
    kept = {name: np.where(without, np.nan, found[name]) for name in ("latitude", "longitude")}
    return (
        found | kept,
        f"{named} at latitude 0 and longitude 0, as of a receiver without a fix: taken as missing",
    )


def _check_jumps(place: dict[str, Array], time: Array, path: Path) -> None:
    """Refuse places, shape (n,) each, between which no aircraft flies in the time [s]."""
    if "north_m" not in place:
        return
    north, east = place["north_m"], place["east_m"]
    rows = np.flatnonzero(np.isfinite(north + east))
    # A receiver may be slower than the log: a place counts from the row on in which it is new.
    rows = (
        rows[np.concatenate([[True], (np.diff(north[rows]) != 0.0) | (np.diff(east[rows]) != 0.0)])]
        if len(rows)
        else rows
    )
    distance, seconds = np.hypot(np.diff(north[rows]), np.diff(east[rows])), np.diff(time[rows])
    jumps = np.flatnonzero(distance > SPEED_MOST * seconds + _ERROR_M)
    if jumps.size:
        i, more = int(jumps[0]), f" (1 of {jumps.size} such jumps)" if jumps.size > 1 else ""
        raise MeasurementError(
            f"'{path}': the place in row {rows[i + 1] + 2} is {distance[i] / 1000.0:,.1f} km from that in row {rows[i] + 2},"
            f" {seconds[i]:g} s earlier, which is faster than {SPEED_MOST:g} m/s{more}: correct the places that are wrong, or leave"
            " them empty"
        )


def _known(found: dict[str, Array]) -> npt.NDArray[np.intp]:
    """Return the rows that have a latitude and a longitude."""
    return (
        np.flatnonzero(np.isfinite(found["latitude"] + found["longitude"]))
        if {"latitude", "longitude"} <= set(found)
        else _NONE
    )


def on_a_plane(found: dict[str, Array]) -> dict[str, Array]:
    """Return where the flight was, on a plane about its first known place."""
    place = {}
    if {"north", "east"} <= set(found):
        place = {"north_m": found["north"], "east_m": found["east"]}
    elif len(known := _known(found)):
        latitude, longitude = np.radians(found["latitude"]), np.radians(found["longitude"])
        first = known[0]
        east = (longitude - longitude[first] + math.pi) % math.tau - math.pi
        place = {
            "north_m": EARTH_RADIUS_M * (latitude - latitude[first]),
            "east_m": EARTH_RADIUS_M * math.cos(latitude[first]) * east,
        }
    if "height" in found:
        place["height_m"] = found["height"]
    return place


def ends(found: dict[str, Array]) -> tuple[Position | None, Position | None]:
    """Return the first and the last known latitude and longitude, or twice None."""
    if not len(known := _known(found)):
        return None, None
    first, last = (
        (float(found["latitude"][i]), float(found["longitude"][i])) for i in known[[0, -1]]
    )
    return first, last
