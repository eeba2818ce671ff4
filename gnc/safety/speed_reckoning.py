"""The speeds that a vehicle may come to by what it was commanded: turns away are predicted with the
fastest and the slowest.
"""

import math

_LATE = 2.0
"""For how many time constants of the airspeed what was commanded counts [-]: an overshoot lasts
longer than a rise.
"""


class SpeedReckoning:
    """Between what speeds a vehicle stays whose airspeed follows its commands with a lag, and
    overshoots their changes.

    A pace is a speed over the mean air. What is commanded no longer is forgotten little by little.

    Parameters
    ----------
    speed : V_r, to which a turn away returns [m/s]
    bandwidth : of the airspeed behind its command [rad/s]
    overshoot : of the airspeed over a rise of its command, and below a fall [-]
    time_step : between commands [s]

    Attributes
    ----------
    highest, lowest : pace commanded of late, the highest at least V_r [m/s]
    """

    __slots__ = ("_crest", "_kept", "_overshoot", "_speed", "_trough", "highest", "lowest")

    def __init__(
        self, *, speed: float, bandwidth: float, overshoot: float, time_step: float
    ) -> None:
        self._speed, self._overshoot = speed, overshoot
        self._kept = math.exp(-time_step * bandwidth / _LATE)
        self.highest = self.lowest = self._crest = self._trough = speed

    def fastest(self, pace: float) -> float:
        """Return the speed that it may rise to if a pace [m/s] were commanded now, and V_r after it
        [m/s].
        """
        rise = pace if pace > self._speed else self._speed
        reached = rise + self._overshoot * (rise - (pace if pace < self.lowest else self.lowest))
        return reached if reached > self._crest else self._crest

    def slowest(self, pace: float) -> float:
        """Return the speed that it may fall to if a pace [m/s] were commanded now, and V_r after it
        [m/s].
        """
        fall = pace if pace < self._speed else self._speed
        reached = fall - self._overshoot * ((pace if pace > self.highest else self.highest) - fall)
        return reached if reached < self._trough else self._trough

    def include(self, pace: float) -> None:
        """Take note of a pace that is flown in place of the last one [m/s]."""
        self._crest, self._trough = self.fastest(pace), self.slowest(pace)
        self.highest, self.lowest = max(self.highest, pace), min(self.lowest, pace)

    def note(self, pace: float) -> None:
        """Take note of the pace that is commanded for this step [m/s]."""
        kept, highest, lowest = self._kept, self.highest, self.lowest
        fastest, slowest = self.fastest(pace), self.slowest(pace)
        highest = pace if pace > highest else pace + kept * (highest - pace)
        self.highest = highest if highest > self._speed else self._speed
        self.lowest = pace if pace < lowest else pace + kept * (lowest - pace)
        # What it rose to, or fell to, of late is left as the pace is.
        self._crest = pace + kept * (fastest - pace)
        self._trough = pace + kept * (slowest - pace)
