"""What an airspeed law is: it says at which pace to fly, a speed over the mean air, and what
airspeed to command for it.
"""

from typing import Protocol

from gnc.estimation.navigation import OwnMotion


class AirspeedLaw(Protocol):
    """What airspeed keeps the vehicle beside its reference."""

    def pace(self, along: float, /) -> float:
        """Return the pace that brings the vehicle beside a reference that is so far ahead along its
        course [m/s].

        Parameters
        ----------
        along : [m]
        """

    def airspeed(self, pace: float, own: OwnMotion, guarding: bool, /) -> float:
        """Return the airspeed to command for a pace [m/s].

        Parameters
        ----------
        pace : [m/s]
        own : the vehicle's motion
        guarding : whether the keep-out guard turns the vehicle away, or did so of late
        """
