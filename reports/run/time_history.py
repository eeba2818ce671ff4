"""What figures take from a flight's time history."""

import math
from collections.abc import Iterable

import numpy as np
import pandas as pd

from common.hull import HULL_SHAPES, ship_frame
from common.physics import wind_velocity
from reports.run.columns import Array, Mask, column
from reports.run.flight_config import (
    Config,
    Row,
    is_level,
    keepout_shape,
    outline_of,
    source_height,
)

_AT_REST = 0.01
"""Speed below which a vessel's heading is not that of its motion [m/s]."""

ERROR_MIN = 0.1
"""Floor of logarithmic axes of the tracking error [m]."""

_LOST = 2.0
"""Value of the column ``guard`` where the guard cannot hold its radius; it is 1 where it
changes commands, and else 0.
"""

_NEAR, _FAR, _ROOM, _USUAL = 0.95, 1.6, 1.05, 0.9
"""Distances that curves over time show: nearest and farthest over r_min, farthest over the largest
after settling, and the fraction of a flight that never settled whose distances are shown [-]."""

_FLIGHT_POINTS, _LONG_POINTS = 1300, 4000
"""Points of a curve of a flight, and of one of an hour."""

_TURNING = 1.0
"""Time between two points within which an X8 on its orbit turns by 30 degrees at most [s]."""


def tracking_error(history: pd.DataFrame) -> Array:
    """Return the distance to the reference at every sample [m]."""
    north, east = (
        column(history, f"reference_{axis}") - column(history, axis)
        for axis in ("north_m", "east_m")
    )
    error: Array = np.hypot(north, east)
    return error


def floor_words(histories: Iterable[pd.DataFrame]) -> str:
    """Return that small tracking errors are drawn at the floor of their axis, as a sentence with a
    space before it, if any are.
    """
    below = any(bool(np.any(tracking_error(history) < ERROR_MIN)) for history in histories)
    return f" Tracking errors below {ERROR_MIN:g} m are drawn at {ERROR_MIN:g} m." if below else ""


def keepout_distance(history: pd.DataFrame, config: Config) -> Array:
    """Return the distance that the keep-out area is about at every sample [m]; not a number without
    a vessel.

    It is measured from the funnel's mouth, or horizontally from the axis of a cylinder; or from the
    outline of the hull, at the height of the funnel's mouth or horizontally.

    Parameters
    ----------
    history : of the flight
    config : of the flight itself
    """
    north, east = (
        column(history, f"{axis}_m") - column(history, f"vessel_{axis}_m")
        for axis in ("north", "east")
    )
    shape, hull = keepout_shape(config), outline_of(config)
    level = is_level(shape)
    up = np.zeros(len(history)) if level else column(history, "altitude_m") - source_height(config)
    if shape in HULL_SHAPES.values() and hull is not None:
        heading = column(history, "vessel_heading_rad")
        from_hull: Array = np.hypot(hull.distance(*ship_frame(north, east, heading)), up)
        return from_hull
    distance: Array = np.sqrt(north**2 + east**2 + up**2)
    return distance


def shown_distances(distance: Array, since_settling: Mask, radius: float) -> tuple[float, float]:
    """Return the least and the largest distance that curves over time show [m]: r_min, and all that
    comes after settling.

    How a flight begins, often far away, may lie outside: how near it comes would not be seen beside
    that.

    Parameters
    ----------
    distance : what the keep-out area is about, of every sample [m]
    since_settling : which samples come after settling; of a flight without any, what it has at most
        times is shown
    radius : r_min [m]
    """
    settled, nearest = distance[since_settling & np.isfinite(distance)], float(np.nanmin(distance))
    usual = float(np.max(settled)) if len(settled) else float(np.nanquantile(distance, _USUAL))
    return min(_NEAR * radius, nearest - 2.0), max(_FAR * radius, 1.1 * nearest, _ROOM * usual)


def about_the_plume(history: pd.DataFrame, prefix: str = "") -> tuple[Array, Array]:
    """Return metres right of and along the plume's axis, seen from the vessel, of the UAV or what a
    prefix names.
    """
    north, east = (
        column(history, f"{prefix}{axis}_m") - column(history, f"vessel_{axis}_m")
        for axis in ("north", "east")
    )
    return turned(north, east, column(history, "plume_axis_rad"))


def turned(north: Array, east: Array, up: Array | float) -> tuple[Array, Array]:
    """Return metres to the right and up of a page on which the course ``up`` [rad] is up."""
    return np.cos(up) * east - np.sin(up) * north, np.cos(up) * north + np.sin(up) * east


def flight_points(history: pd.DataFrame) -> int:
    """Return how many samples curves of a flight show at most: more of a long one, that its turns
    do not become corners.
    """
    time = column(history, "time_s")
    return round(
        min(max(_FLIGHT_POINTS, (float(time[-1]) - float(time[0])) / _TURNING), _LONG_POINTS)
    )


def thinned(history: pd.DataFrame, points_max: int) -> pd.DataFrame:
    """Return every so many samples, ``points_max`` of them at most."""
    return history.iloc[:: max(1, math.ceil(len(history) / points_max))]


def vessel_heading(history: pd.DataFrame, course_deg: float) -> Array:
    """Return where the vessel's bow points at each sample, without jumps [rad]: along its motion,
    at rest as it was before.

    Parameters
    ----------
    history : of the flight
    course_deg : of a vessel that is at rest all the time [deg]
    """
    north, east = (column(history, f"vessel_velocity_{axis}_mps") for axis in ("north", "east"))
    recorded = column(history, "vessel_heading_rad")
    if len(recorded) and np.isfinite(recorded).all():
        return recorded
    moving = np.hypot(north, east) > _AT_REST
    if not moving.any():
        return np.full(len(history), math.radians(course_deg))
    last = np.maximum.accumulate(np.where(moving, np.arange(len(history)), np.argmax(moving)))
    heading: Array = np.unwrap(np.arctan2(east, north)[last])
    return heading


def true_wind(history: pd.DataFrame, row: Row) -> tuple[Array, Array]:
    """Return north and east velocity of the true mean wind at every sample [m/s]; where it is not
    recorded, that of the start.

    Parameters
    ----------
    history : of the flight
    row : of the flight in the summary
    """
    speed, origin = (
        float(np.nan_to_num(row.get(name, 0.0))) for name in ("wind_speed_mps", "wind_from_deg")
    )
    recorded = (column(history, f"true_wind_{axis}_mps") for axis in ("north", "east"))
    north, east = (
        np.where(np.isfinite(of), of, begun)
        for of, begun in zip(recorded, wind_velocity(speed, origin), strict=True)
    )
    return north, east


def guard_stretches(history: pd.DataFrame) -> list[tuple[int, int, bool]]:
    """Return when the guard changed commands: the first sample, that after the last, and whether it
    held its radius.
    """
    state = np.nan_to_num(column(history, "guard"))
    starts = np.concatenate([[0], np.flatnonzero(np.diff(state)) + 1])
    ends = np.append(starts[1:], len(state))
    stretches = zip(starts.tolist(), ends.tolist(), strict=True)
    return [
        (start, end, bool(state[start] < _LOST)) for start, end in stretches if state[start] > 0.0
    ]
