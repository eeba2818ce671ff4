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

    def command(self, along: float, _own: OwnMotion, guarding: bool, /) -> float:
        """Return the airspeed to command [m/s]; a turn away from the keep-out area is flown at V_r.

        Parameters
        ----------
        along : how far the reference is ahead, along its course [m]
        guarding : whether the keep-out guard turns the vehicle away, or did so of late
        """
        if guarding or not self.gain:
            return self.speed
        return self.speed + limited(self.gain * along, self.change_max)
