"""What an airspeed law is."""

from typing import Protocol

from gnc.estimation.own_motion import OwnMotion


class AirspeedLaw(Protocol):
    """What airspeed keeps the vehicle beside its reference."""

    def command(self, along: float, own: OwnMotion, guarding: bool, /) -> float:
        """Return the airspeed to command [m/s].

        Parameters
        ----------
        along : how far the reference is ahead, along its course [m]
        own : the vehicle's motion
        guarding : whether the keep-out guard turns the vehicle away, or did so of late
        """
