"""The speed that a vehicle may come to by what it was commanded: turns away are predicted with it."""

import math

_LATE = 2.0
"""For how many time constants of the airspeed what was commanded counts [-]: an overshoot lasts longer than a rise."""


class SpeedReckoning:
    """The highest pace commanded of late, and how far the airspeed overshoots a rise from the lowest one.

    A pace is a speed over the mean air. What is commanded no longer is forgotten little by little.

    Parameters
    ----------
    speed : V_r, to which a turn away returns [m/s]
    bandwidth : of the airspeed behind its command [rad/s]
    overshoot : of the airspeed over a rise of its command [-]
    time_step : between commands [s]

    Attributes
    ----------
    highest, lowest : pace commanded of late, the highest at least V_r [m/s]
    """

    __slots__ = ("_kept", "_overshoot", "_speed", "highest", "lowest")

    def __init__(self, *, speed: float, bandwidth: float, overshoot: float, time_step: float) -> None:
        self._speed, self._overshoot = speed, overshoot
        self._kept = math.exp(-time_step * bandwidth / _LATE)
        self.highest = self.lowest = speed

    def fastest(self, pace: float) -> float:
        """Return the speed that it may come to if a pace [m/s] were commanded now, and V_r after it [m/s]."""
        highest = pace if pace > self.highest else self.highest
        return highest + self._overshoot * (highest - (pace if pace < self.lowest else self.lowest))

    def include(self, pace: float) -> None:
        """Take note of a pace that is flown in place of the last one [m/s]."""
        self.highest, self.lowest = max(self.highest, pace), min(self.lowest, pace)

    def note(self, pace: float) -> None:
        """Take note of the pace that is commanded for this step [m/s]."""
        kept, highest, lowest = self._kept, self.highest, self.lowest
        highest = pace if pace > highest else pace + kept * (highest - pace)
        self.highest = highest if highest > self._speed else self._speed
        self.lowest = pace if pace < lowest else pace + kept * (lowest - pace)
