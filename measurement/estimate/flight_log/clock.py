"""Times of a log that are written as a clock shows them, and are no seconds."""

from pathlib import Path

import numpy as np

from measurement.errors import MeasurementError
from measurement.sniffer.lag import Array

_COMPACT = 1e13, 1e14
"""Times of 14 digits, as 20240501120000, which are no seconds: they jump by 41 at every minute."""

_DAY_ENDS = 240_000.0
"""End of a day by a clock without marks, HHMMSS."""

_MINUTES_MIN = 2
"""Changes of the minute that show such a clock: seconds leave out 60 to 99 of a hundred by chance
once, and not time and again.
"""


def check_seconds(time: Array, name: str, path: Path) -> None:
    """Refuse times, shape (m,), that are dates or times of the day without marks.

    Parameters
    ----------
    time : of the rows, not a number where a row has none [s]
    name : of the column
    path : of the log

    Raises
    ------
    MeasurementError : they are
    """
    if _COMPACT[0] <= time[0] < _COMPACT[1]:
        raise MeasurementError(
            f"'{path}': time {time[0]:.0f} in column '{name}' is a date and time without marks; give seconds, or"
            " 2024-05-01T12:00:00.0"
        )
    if not (
        (time >= 0.0) & (time < _DAY_ENDS) & (time % 100.0 < 60.0) & (time // 100.0 % 100.0 < 60.0)
    ).all():
        return
    minutes = np.flatnonzero(np.diff(time // 100.0) > 0.0)
    if len(minutes) >= _MINUTES_MIN:
        row = int(minutes[0])
        raise MeasurementError(
            f"'{path}': times in column '{name}' go from {time[row]:.10g} to {time[row + 1]:.10g} (row {row + 3}), and so at"
            f" each of {len(minutes)} minutes: they are hours, minutes and seconds without marks; give seconds, or"
            " 2024-05-01T12:00:00.0"
        )
