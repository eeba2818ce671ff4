"""Whether a gas sensor still answers: judged by its readings alone."""

import math
from enum import Enum

from gnc.estimation.plume.prior import GasSensor

_EQUAL, _EQUAL_BY_NOISE = 10, 1e-12
"""Readings in a row that are one and the same, from which a sensor counts as stuck [-]: at least so
many, and as many as noise makes equal with at most so small a probability, at any reading. Noise of
10 steps makes 9 equal with 3e-13.
"""

_SILENT_INTERVALS, _SILENT_TIME = 5.0, 2.0
"""A sensor counts as silent after so many intervals between its readings, and at least so long
[-, s].
"""


class SensorState(Enum):
    """What the readings say about their sensor."""

    WORKING = "working"
    SILENT = "silent"
    STUCK = "stuck"
    SATURATED = "saturated"


class SensorWatch:
    """Watches the readings of a sensor.

    A sensor that is dead but still has the noise of one that works cannot be told from clean air.
    One whose noise is less than the step of its readings repeats them in clean air, too: it takes
    longer to tell that it is stuck (at half the step 73 readings, at a fifth 2,211), and is never
    told where its noise is less than a sixteenth of the step.

    Parameters
    ----------
    sensor : its data sheet

    Attributes
    ----------
    state : what the readings say; it recovers with them
    """

    __slots__ = ("_equal", "_last", "_patience", "_saturated", "_stuck_from", "_waited", "state")

    def __init__(self, sensor: GasSensor) -> None:
        self._patience = max(_SILENT_TIME, _SILENT_INTERVALS * sensor.interval)
        self._saturated, self._stuck_from = sensor.saturated, equal_readings(sensor)
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
            self.state = (
                SensorState.STUCK if self._equal >= self._stuck_from else SensorState.WORKING
            )


def equal_readings(sensor: GasSensor) -> float:
    """Return the number of equal readings in a row from which a sensor counts as stuck [-];
    infinite where noise never shows.

    A reading is rounded to the step d, its noise is normal with the deviation s. It is most often
    the same where the air is at a multiple of d: with the probability erf(d/(2 sqrt(2) s)) each
    time.
    """
    same = math.erf(sensor.resolution / (2.0 * math.sqrt(2.0) * sensor.noise))
    if same in (0.0, 1.0):
        return _EQUAL if same == 0.0 else math.inf
    return max(_EQUAL, math.ceil(math.log(_EQUAL_BY_NOISE) / math.log(same)))
