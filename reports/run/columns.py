"""Columns of a run's tables, as figures and truth values."""

import numpy as np
import numpy.typing as npt
import pandas as pd

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

NOTICEABLE = 1e-3
"""Smallest error of a position [m] or speed [m/s] that is shown."""

_LOST_MODES = ("ditched", "gliding", "terminating")
"""Modes at the end of a flight whose aircraft does not come back."""


def column(rows: pd.DataFrame, name: str) -> Array:
    """Return a column as figures; nothing but "not a number" where the run has no such column."""
    return rows[name].to_numpy(dtype=np.float64) if name in rows else np.full(len(rows), np.nan)


def total(rows: pd.DataFrame, name: str) -> int:
    """Return the sum of a column of counts."""
    return int(np.nansum(column(rows, name)))


def largest(values: Array) -> float | None:
    """Return the largest known value, or None."""
    return float(np.nanmax(values)) if np.isfinite(values).any() else None


def measured(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the flights that were flown, of which the closest approach is known."""
    return rows[rows["min_distance_m"].notna()]


def clearance(rows: pd.DataFrame) -> Array:
    """Return how far from the keep-out area each flight stayed at its closest, negative if it violated it [m]."""
    return column(rows, "min_distance_m") - column(rows, "keepout_radius_m")


def violated(rows: pd.DataFrame) -> Mask:
    """Return which flights violated the keep-out area."""
    inside: Mask = column(rows, "keepout_violations") > 0.0
    return inside


def lost(rows: pd.DataFrame) -> Mask:
    """Return which flights lost their aircraft, whether or not their criteria allow that."""
    gone = rows["outcome"] == "diverged"
    if "mode_at_end" in rows:
        gone |= rows["mode_at_end"].isin(_LOST_MODES)
    return gone.to_numpy(dtype=np.bool_)


def met(rows: pd.DataFrame) -> Mask:
    """Return which flights met every criterion and kept their aircraft."""
    return rows["criteria_met"].to_numpy(dtype=np.bool_) & ~lost(rows)


def interval_error(rows: pd.DataFrame) -> Array:
    """Return the mean crossing interval's relative difference from pi/omega_0 [-]."""
    ratio: Array = column(rows, "crossing_interval_mean_s") / column(rows, "crossing_interval_predicted_s") - 1.0
    return ratio
