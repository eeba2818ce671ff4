"""Logs whose rows are faster than the sensors: a row repeats a reading, or has none, until the next
one is there.
"""

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from measurement.estimate.record import shown_step
from measurement.gases import GASES
from measurement.sniffer.lag import Array
from measurement.sniffer.sniffer import Readings

_FEWEST = 10
"""Intervals between new readings by which it is told how many rows a reading has."""

_LOW = 0.1
"""Share of these intervals that are the shortest: readings that are equal by chance make others
twice as long and longer.
"""

_OFF, _REGULAR = 0.25, 0.8
"""How far an interval may be from a whole multiple of the sensor's own, over that, and the share of
the intervals that are so near: half of those are that noise and rounding make."""


_LARGER = 0.25
"""Least share of the changes that are larger than a step of the readings."""


def new_readings(logged: Readings, gases: Sequence[str]) -> Readings:
    """Return each reading of a log once, at the time of the first row that has it; a log with a row
    per reading as it is.

    The times are those of the slowest of the gases; the others are interpolated between their own
    readings.

    Parameters
    ----------
    logged : by row, not a number where there is no reading
    gases : that the instrument has
    """
    columns = logged.values.T
    rows_each = [rows_per_reading(column) for column in columns]
    slowest = max((GASES.index(gas) for gas in gases), key=lambda i: rows_each[i])
    if rows_each[slowest] == 1.0:
        return logged
    time = logged.time[_first_rows(columns[slowest], rows_each[slowest])]
    values = np.full((len(time), len(columns)), np.nan)
    for i, (column, rows) in enumerate(zip(columns, rows_each, strict=True)):
        own = _first_rows(column, rows)
        values[:, i] = np.interp(time, logged.time[own], column[own])
    return Readings(time, values)


def rows_per_reading(column: Array) -> float:
    """Return how many rows of a log a reading of a gas has, mean; 1 where they do not come at
    intervals of more than a row.

    Readings in coarse steps may change as seldom and as evenly as passes come, and mostly by one
    step: they do not tell.

    Parameters
    ----------
    column : readings by row, not a number where there is none, shape (n,)
    """
    changes = _changes(column)
    between = np.diff(changes)
    if (
        len(between) < _FEWEST
        or np.mean(np.abs(np.diff(column[changes])) > 1.5 * shown_step(column)) < _LARGER
    ):
        return 1.0
    rows = float(np.mean(between[between <= 1.5 * np.quantile(between, _LOW)]))
    off = np.abs(between / rows - np.round(between / rows))
    return rows if float(np.mean(off <= _OFF)) >= _REGULAR else 1.0


def _changes(column: Array) -> npt.NDArray[np.intp]:
    """Return the rows with another reading than the last one before them."""
    known = np.flatnonzero(np.isfinite(column))
    return known[np.concatenate([[True], np.diff(column[known]) != 0.0])] if len(known) else known


def _first_rows(column: Array, rows: float) -> npt.NDArray[np.intp]:
    """Return the first row of each reading; where none is new for longer, at the sensor's own
    interval.
    """
    starts = np.unique(np.concatenate([[0], _changes(column)]))
    parts = []
    for start, end in zip(starts, [*starts[1:], len(column)], strict=True):
        parts.append(
            start + np.round(rows * np.arange(max(1, round((end - start) / rows)))).astype(np.intp)
        )
    return np.concatenate(parts)
