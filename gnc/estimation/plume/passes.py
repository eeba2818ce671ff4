"""The way of the vehicle over a plume's axis, gathered from turn to turn with what is read on it."""

import math
from array import array
from bisect import bisect_left, bisect_right
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_TURNED = 5.0
"""Distance that the vehicle goes back across by which a pass is over [m]: more than its place is
uncertain.
"""

_LONGEST = 25.0
"""Time after which a pass is over without a turn [s]."""

FINE = 0.25
"""Step of the concentration along the path that the sensor's lag is computed from [s]: 5 m at 20
m/s, about a spread.
"""

_BESIDE = 0.25
"""Least way across over that along, where the vehicle turns within the plume [-]: the turn is
short.
"""

_READINGS_MIN = 4
"""Least readings of a pass [-]: with fewer, background and pulse cannot be told apart."""


@dataclass(frozen=True, slots=True)
class Path:
    """The way from one side of the axis to the other, and what was read on it.

    Attributes
    ----------
    time, along, across, altitude : of the way, at equal steps, shape (n,) [s, m]
    read_at : when the air of each reading was at the inlet, shape (m,) [s]
    readings : shape (m,) [ppm]
    """

    time: Array
    along: Array
    across: Array
    altitude: Array
    read_at: Array
    readings: Array

    @property
    def duration(self) -> float:
        """Time from turn to turn, and for which the sensor still has what it read before the second
        one [s].
        """
        return float(self.time[-1] - self.time[0])

    def at(self, across: float) -> tuple[float, float]:
        """Return along and altitude [m] where the way is nearest to a place ``across`` [m]."""
        nearest = self._nearest(across)
        return float(self.along[nearest]), float(self.altitude[nearest])

    def drawn_out(self, across: float, apparent_wind: float) -> float:
        """Return how far along the plume, over how far across it, the vehicle goes by the place
        nearest to ``across`` [-].

        Parameters
        ----------
        across : [m]
        apparent_wind : with which the plume itself moves along [m/s]
        """
        i = min(max(self._nearest(across), 1), len(self.time) - 2)
        along = (
            self.along[i + 1]
            - self.along[i - 1]
            - apparent_wind * (self.time[i + 1] - self.time[i - 1])
        )
        return float(
            abs(along) / max(abs(self.across[i + 1] - self.across[i - 1]), _BESIDE * abs(along))
        )

    def covered(self, places: Array, weights: Array) -> float:
        """Return the sum of the weights of those places across, in order, that the way goes over."""
        first, last = places.searchsorted((self.across.min(), self.across.max()))
        return float(weights[first:last].sum())

    def _nearest(self, across: float) -> int:
        return int(np.abs(self.across - across).argmin())


class PassCollector:
    """Gathers places and readings until the vehicle has turned back and the sensor has answered.

    Parameters
    ----------
    delay, tail : of the sensor, and how long after a turn what it reads belongs to the pass before
        [s]
    """

    __slots__ = (
        "_columns",
        "_delay",
        "_farthest",
        "_farthest_at",
        "_read_at",
        "_readings",
        "_side",
        "_tail",
        "_turn",
    )

    def __init__(self, *, delay: float, tail: float) -> None:
        self._delay, self._tail = delay, tail
        # Of numbers that stand one behind the other numpy makes arrays at once: of places in order
        # of time.
        self._columns = array("d"), array("d"), array("d"), array("d")
        self._read_at, self._readings = array("d"), array("d")
        self._farthest = self._farthest_at = math.nan
        self._side = 0.0
        self._turn: float | None = None

    def add(
        self, time: float, along: float, across: float, altitude: float, reading: float
    ) -> Path | None:
        """Take note of a place and of a reading, or of none; return the pass that is over, if one
        is.

        Parameters
        ----------
        time : [s]
        along, across, altitude : of the vehicle, in the frame of the predicted axis [m]
        reading : [ppm], or not a number
        """
        times, alongs, acrosses, altitudes = columns = self._columns
        if times and time <= times[-1]:
            for column in columns:
                column.pop()
        times.append(time)
        alongs.append(along)
        acrosses.append(across)
        altitudes.append(altitude)
        answered = time - self._delay
        if not math.isnan(reading):
            self._read_at.append(answered)
            self._readings.append(reading)
        self._look_for_turn(time, across)
        turn = self._turn
        return None if turn is None or answered < turn + self._tail else self._closed(turn)

    def _look_for_turn(self, time: float, across: float) -> None:
        gone, side = across - self._farthest, self._side
        if side * gone > 0.0 or math.isnan(gone):
            self._farthest, self._farthest_at = across, time
        elif not -_TURNED <= gone <= _TURNED:
            if side == 0.0:
                self._side = math.copysign(1.0, gone)
                self._farthest, self._farthest_at = across, time
            elif self._turn is None:
                self._turn, self._side = self._farthest_at, -side
                self._farthest, self._farthest_at = across, time
        if self._turn is None and time - self._columns[0][0] > _LONGEST:
            self._turn = time

    def _closed(self, turn: float) -> Path | None:
        columns, read_at, readings = self._columns, self._read_at, self._readings
        begun, end = columns[0][0], turn + self._tail
        self._turn = None
        kept = bisect_left(columns[0], turn)
        self._columns = columns[0][kept:], columns[1][kept:], columns[2][kept:], columns[3][kept:]
        first, last = bisect_left(read_at, begun), bisect_right(read_at, end)
        self._read_at, self._readings = read_at[last:], readings[last:]
        if last - first < _READINGS_MIN or turn - begun < 2.0 * FINE:
            return None
        known_at, *known = map(np.array, columns)
        time = np.arange(begun, end + FINE, FINE)
        along, across, altitude = (np.interp(time, known_at, values) for values in known)
        return Path(
            time,
            along,
            across,
            altitude,
            np.array(read_at[first:last]),
            np.array(readings[first:last]),
        )
