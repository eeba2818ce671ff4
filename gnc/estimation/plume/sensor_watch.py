"""Whether a gas sensor still answers: judged by its readings alone."""

import math
from enum import Enum

_EQUAL = 10
"""Readings in a row that are one and the same, from which a sensor counts as stuck [-]: noise makes them differ."""

_SILENT_INTERVALS, _SILENT_TIME = 5.0, 2.0
"""A sensor counts as silent after so many intervals between its readings, and at least so long [-, s]."""


class SensorState(Enum):
    """What the readings say about their sensor."""

    WORKING = "working"
    SILENT = "silent"
    STUCK = "stuck"
    SATURATED = "saturated"


class SensorWatch:
    """Watches the readings of a sensor.

    A sensor that is dead but still has the noise of one that works cannot be told from clean air.

    Parameters
    ----------
    interval : between readings [s]
    saturated : reading from which on it is saturated [ppm]

    Attributes
    ----------
    state : what the readings say; it recovers with them
    """

    __slots__ = ("_equal", "_last", "_patience", "_saturated", "_waited", "state")

    def __init__(self, *, interval: float, saturated: float) -> None:
        self._patience = max(_SILENT_TIME, _SILENT_INTERVALS * interval)
        self._saturated = saturated
        self._last, self._waited, self._equal = math.nan, 0.0, 0
        self.state = SensorState.WORKING

    def wait(self, time_step: float) -> None:
        """Let ``time_step`` [s] go by."""
        self._waited += time_step
        if self._waited > self._patience:
            self.state = SensorState.SILENT

    def read(self, reading: float) -> None:
        """Take note of a reading [ppm]."""
        self._equal = self._equal + 1 if reading == self._last else 1
        self._last, self._waited = reading, 0.0
        if reading >= self._saturated:
            self.state = SensorState.SATURATED
        else:
            self.state = SensorState.STUCK if self._equal >= _EQUAL else SensorState.WORKING
