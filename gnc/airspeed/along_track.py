"""Airspeed by the along-track error: V_r, and a bounded share of how far the reference is ahead."""

import math
from dataclasses import dataclass, field

from gnc.estimation.navigation import OwnMotion
from gnc.numeric import clip


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongTrackTrim:
    """Trims the airspeed about V_r.

    Attributes
    ----------
    speed : V_r [m/s]
    gain : commanded airspeed per along-track error [1/s]; 0 for V_r at all times
    change_max : largest change of the commanded airspeed [m/s]
    airspeed_min, airspeed_max : between which airspeed is trimmed [m/s]
    """

    speed: float
    gain: float
    change_max: float
    airspeed_min: float = 0.0
    airspeed_max: float = math.inf
    _least: float = field(init=False, repr=False, compare=False)
    _most: float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_least", max(self.speed - self.change_max, self.airspeed_min))
        object.__setattr__(self, "_most", min(self.speed + self.change_max, self.airspeed_max))

    def pace(self, along: float, /) -> float:
        """Return the pace that brings the vehicle beside a reference that is so far ahead along its
        course [m/s].
        """
        if not self.gain:
            return self.speed
        return clip(self.speed + self.gain * along, self._least, self._most)

    def airspeed(self, pace: float, _own: OwnMotion, _guarding: bool, /) -> float:
        """Return the airspeed to command for a pace: in still air they are the same [m/s]."""
        return pace
