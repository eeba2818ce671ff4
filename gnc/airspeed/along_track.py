"""Airspeed by the along-track error: V_r, and a bounded share of how far the reference is ahead."""

from dataclasses import dataclass

from gnc.estimation.own_motion import OwnMotion
from gnc.numeric import limited


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongTrackTrim:
    """Trims the airspeed about V_r.

    Attributes
    ----------
    speed : V_r [m/s]
    gain : commanded airspeed per along-track error [1/s]; 0 for V_r at all times
    change_max : largest change of the commanded airspeed [m/s]
    """

    speed: float
    gain: float
    change_max: float

    def pace(self, along: float, /) -> float:
        """Return the pace that brings the vehicle beside a reference that is so far ahead along its course [m/s]."""
        return self.speed + limited(self.gain * along, self.change_max) if self.gain else self.speed

    def airspeed(self, pace: float, _own: OwnMotion, _guarding: bool, /) -> float:
        """Return the airspeed to command for a pace: in still air they are the same [m/s]."""
        return pace
