"""What figures take from a flight's time history."""

import math

import numpy as np
import pandas as pd

from reports.document.chart import Array


def tracking_error(history: pd.DataFrame) -> Array:
    """Return the distance to the reference at every sample [m]."""
    north, east = (history[f"reference_{axis}"] - history[axis] for axis in ("north_m", "east_m"))
    error: Array = np.hypot(north.to_numpy(dtype=np.float64), east.to_numpy(dtype=np.float64))
    return error


def thinned(history: pd.DataFrame, points_max: int) -> pd.DataFrame:
    """Return every so many samples, ``points_max`` of them at most."""
    return history.iloc[:: max(1, math.ceil(len(history) / points_max))]
