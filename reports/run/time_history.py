"""What figures take from a flight's time history."""

import math

import numpy as np
import pandas as pd

from reports.run.columns import Array, column


def tracking_error(history: pd.DataFrame) -> Array:
    """Return the distance to the reference at every sample [m]."""
    north, east = (column(history, f"reference_{axis}") - column(history, axis) for axis in ("north_m", "east_m"))
    error: Array = np.hypot(north, east)
    return error


def keepout_distance(history: pd.DataFrame, source_height: float, shape: str) -> Array:
    """Return the distance that the keep-out area is about at every sample [m]; not a number without a vessel.

    Parameters
    ----------
    history : of the flight
    source_height : of the funnel's mouth, the centre of a sphere [m]
    shape : "sphere", or "cylinder" for the horizontal distance from its axis
    """
    north, east = (column(history, f"{axis}_m") - column(history, f"vessel_{axis}_m") for axis in ("north", "east"))
    up = np.zeros(len(history)) if shape == "cylinder" else column(history, "altitude_m") - source_height
    distance: Array = np.sqrt(north**2 + east**2 + up**2)
    return distance


def about_the_plume(history: pd.DataFrame, prefix: str = "") -> tuple[Array, Array]:
    """Return metres right of and along the plume's axis, seen from the vessel, of the UAV or what a prefix names."""
    north, east = (column(history, f"{prefix}{axis}_m") - column(history, f"vessel_{axis}_m") for axis in ("north", "east"))
    axis = column(history, "plume_axis_rad")
    return np.cos(axis) * east - np.sin(axis) * north, np.cos(axis) * north + np.sin(axis) * east


def thinned(history: pd.DataFrame, points_max: int) -> pd.DataFrame:
    """Return every so many samples, ``points_max`` of them at most."""
    return history.iloc[:: max(1, math.ceil(len(history) / points_max))]
