"""Columns of a run's tables, as figures and truth values."""

from collections.abc import Callable, Mapping

import numpy as np
import numpy.typing as npt
import pandas as pd

from common.columns import Column
from common.verdict import COMPLETED, DIVERGED, GONE, LOST, KeepOut

Array = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]

NOTICEABLE = 1e-3
"""Smallest error of a position [m] or speed [m/s] that is shown."""

_KEEP_OUT = ("outcome", "keepout_violations", "required", "keepout_radius_m")
"""Columns that say how a flight kept out."""


def column(rows: pd.DataFrame, name: str) -> Array:
    """Return a column as figures; nothing but "not a number" where the run has no such column."""
    return rows[name].to_numpy(dtype=np.float64) if name in rows else np.full(len(rows), np.nan)


def total(rows: pd.DataFrame, name: str) -> int:
    """Return the sum of a column of counts."""
    return int(np.nansum(column(rows, name)))


def largest(values: Array) -> float | None:
    """Return the largest known value, or None."""
    return float(np.nanmax(values)) if np.isfinite(values).any() else None


def least(values: Array) -> float | None:
    """Return the least known value, or None."""
    return float(np.nanmin(values)) if np.isfinite(values).any() else None


def study_flight(rows: pd.DataFrame) -> "pd.Series[str]":
    """Return the name of the study's flight of each row: the flight itself, or the one beside which
    a comparison's flight stands.
    """
    own = rows["flight_id"].astype(str)
    return (
        rows["beside"].where(rows["beside"].notna(), own).astype(str) if "beside" in rows else own
    )


def was_flown(rows: pd.DataFrame) -> Mask:
    """Return which flights were flown, with a vessel or without: those that lasted for any time, as
    the console counts them.

    The outcome does not tell: a flight is ``failed`` as well where it was flown and an instrument
    could not be evaluated.
    """
    return np.isfinite(column(rows, "duration_s"))


def flights_flown(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the flights that were flown."""
    return rows[was_flown(rows)]


def beside_vessel(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the flights whose closest approach is known: those that were flown beside a vessel,
    and not about a circle.
    """
    return rows[rows["min_distance_m"].notna()]


def clearance(rows: pd.DataFrame) -> Array:
    """Return how far from the keep-out area each flight stayed at its closest, negative if it
    violated it [m].
    """
    return column(rows, "min_distance_m") - column(rows, "keepout_radius_m")


def radii_differ(rows: pd.DataFrame) -> bool:
    """Return whether flights have different r_min: what counts is then how far beyond it each
    stayed.
    """
    return rows["keepout_radius_m"].nunique() > 1


def _keep_out(rows: pd.DataFrame) -> npt.NDArray[np.object_]:
    """Return of each flight how it kept out of the keep-out area."""
    names = [name for name in _KEEP_OUT if name in rows]
    found = [KeepOut.of(row) for row in rows[names].to_dict("records")]
    return np.array(found, dtype=object)


def violated(rows: pd.DataFrame) -> Mask:
    """Return which flights violated the keep-out area."""
    return np.asarray(_keep_out(rows) == KeepOut.VIOLATED, dtype=np.bool_)


def kept_out(rows: pd.DataFrame) -> Mask:
    """Return which flights are known to have kept out of the keep-out area, and came back."""
    return np.asarray(_keep_out(rows) == KeepOut.KEPT_OUT, dtype=np.bool_)


def lost(rows: pd.DataFrame) -> Mask:
    """Return which flights lost their aircraft, also where a fault was flown on purpose."""
    return rows["outcome"].isin(GONE).to_numpy(dtype=np.bool_)


SEVERE = ("lost its aircraft", "diverged", "violated the keep-out area")
"""What a flight did that matters more than how near others came, the worst first."""


def severity(rows: pd.DataFrame) -> npt.NDArray[np.int64]:
    """Return of each flight its place in ``SEVERE``; ``len(SEVERE)`` of one that did none of
    these.
    """
    outcomes = rows["outcome"]
    did = [outcomes == LOST, outcomes == DIVERGED, violated(rows)]
    places = np.select([np.asarray(of) for of in did], range(len(SEVERE)), len(SEVERE))
    return places.astype(np.int64)


def by_severity(rows: pd.DataFrame) -> pd.DataFrame:
    """Return flights with the one that matters most first: by ``severity``, and by how near to
    their keep-out area they came.
    """
    return rows.iloc[np.lexsort((clearance(rows), severity(rows)))]


def completed(rows: pd.DataFrame) -> Mask:
    """Return which flights completed their mission."""
    return (rows["outcome"] == COMPLETED).to_numpy(dtype=np.bool_)


def met(rows: pd.DataFrame) -> Mask:
    """Return which flights met every criterion: they kept out and completed their mission."""
    return rows["criteria_met"].to_numpy(dtype=np.bool_)


def passed(rows: pd.DataFrame) -> Mask:
    """Return which flights did what is required of them: met every criterion, or stayed outside of
    the keep-out area where no more is required.
    """
    if "required" not in rows:
        return met(rows)
    outside = np.isin(_keep_out(rows), (KeepOut.KEPT_OUT, KeepOut.OUTSIDE))
    return met(rows) | (outside & np.asarray(rows["required"] == "keep_out", dtype=np.bool_))


def recorded_at(values: Array, recorded: Mask, rank: int) -> tuple[int, bool]:
    """Return which flight is at a rank, or else is nearest to it of those with a time history, and
    whether its value is that one.

    Parameters
    ----------
    values : of the flights, by which they are ranked
    recorded : which of them have a time history, one of them at least
    rank : from 0 for the least value
    """
    place = int(np.argsort(values, kind="stable")[rank])
    nearest = (
        place
        if recorded[place]
        else int(np.argmin(np.where(recorded, np.abs(values - values[place]), np.inf)))
    )
    return nearest, bool(values[nearest] == values[place])


def count(mask: Mask) -> int:
    """Return how many flights a mask holds."""
    return int(np.count_nonzero(mask))


def interval_error(rows: pd.DataFrame) -> Array:
    """Return the mean crossing interval's relative difference from pi/omega_0 [-]."""
    ratio: Array = (
        column(rows, "crossing_interval_mean_s") / column(rows, "crossing_interval_predicted_s")
        - 1.0
    )
    return ratio


_DERIVED: Mapping[str, Callable[[pd.DataFrame], Array]] = {
    "clearance_m": clearance,
    "crossing_interval_error": interval_error,
    "crossing_clearance_m": lambda rows: column(rows, "crossing_clearance_min_m"),
    "fsc_error_percent": lambda rows: (
        column(rows, "fsc_percent") - column(rows, "fsc_expected_percent")
    ),
}
"""Figures that follow from the summary, as the run's ``columns.json`` has them under ``derived``.
"""


def figure(rows: pd.DataFrame, name: str) -> Array:
    """Return a figure of each flight, as recorded: a column of the summary or one that follows."""
    return _DERIVED[name](rows) if name in _DERIVED else column(rows, name)


def judged(rows: pd.DataFrame, name: str, of: Column) -> Array:
    """Return a figure as it is judged: of an error with a sign its size."""
    values = figure(rows, name)
    return np.abs(values) if of.worse == "off zero" else values


def worst(values: Array, of: Column) -> float:
    """Return the worst of known values, as they are judged."""
    return float(values.min() if of.worse == "lower" else values.max())


def is_figure(rows: pd.DataFrame, name: str) -> bool:
    """Return whether a column holds numbers, and any at all."""
    if name not in rows or pd.api.types.is_bool_dtype(rows[name]):
        return False
    return pd.api.types.is_numeric_dtype(rows[name]) and bool(np.isfinite(column(rows, name)).any())
