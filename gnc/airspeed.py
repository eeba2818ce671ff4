"""Airspeed laws, which keep the vehicle beside its reference.

A law works in two steps. The pace is a speed over the mean air, chosen by how far ahead the
reference is. The airspeed to command for it depends on the gusts.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import OwnMotion
from gnc.numeric import clip


class AirspeedLaw(Protocol):
    """An airspeed that keeps the vehicle beside its reference."""

    def pace(self, along: float, /) -> float:
        """Return the speed over the mean air that brings the vehicle beside its reference [m/s].

        Parameters
        ----------
        along : distance of the reference ahead of the vehicle, along the reference's course [m]
        """

    def airspeed(self, pace: float, own: OwnMotion, guarding: bool, /) -> float:
        """Return the airspeed to command for a pace [m/s].

        Parameters
        ----------
        pace : [m/s]
        own : the vehicle's motion
        guarding : whether the keep-out guard turns the vehicle away, or did so recently
        """


# ---------------------------------------------------------------- In still air


@dataclass(frozen=True, slots=True, kw_only=True)
class AlongTrackTrim:
    """V_r, and a bounded part of the distance of the reference ahead.

    Attributes
    ----------
    speed : V_r [m/s]
    gain : commanded airspeed per along-track error [1/s]; 0 for V_r at all times
    change_max : largest change of the commanded airspeed [m/s]
    airspeed_min, airspeed_max : of the vehicle [m/s]
    """

    speed: float
    gain: float
    change_max: float
    airspeed_min: float = 0.0
    airspeed_max: float = math.inf

    def pace(self, along: float, /) -> float:
        """Return the speed that brings the vehicle beside its reference [m/s]."""
        if not self.gain:
            return self.speed
        least = max(self.speed - self.change_max, self.airspeed_min)
        most = min(self.speed + self.change_max, self.airspeed_max)
        return clip(self.speed + self.gain * along, least, most)

    def airspeed(self, pace: float, _own: OwnMotion, _guarding: bool, /) -> float:
        """Return the airspeed to command for a pace [m/s]: in still air they are the same."""
        return pace


# ---------------------------------------------------------------- In gusts

_CRITICAL = 0.25
"""Gain of a position loop about a first-order loop, over the bandwidth of that loop [-].

With it both poles are equal, which is the fastest response without overshoot.
"""


class SpeedHold(NamedTuple):
    """Parameters of ``PaceHold`` that depend on the vehicle.

    Attributes
    ----------
    gain : speed per along-track error [1/s]
    airspeed_min, airspeed_max : of the commanded airspeed [m/s]
    """

    gain: float
    airspeed_min: float
    airspeed_max: float


def design_speed_hold(
    *, bandwidth: float, speed: float, look_ahead: float, airspeed_min: float, airspeed_max: float
) -> SpeedHold:
    """Return the parameters for a vehicle and a look-ahead.

    The steering law removes an error across the path at the rate V_r/R. If an error along the path
    decays at the same rate, then the whole error decays on a straight line, and a turn of the path
    in the meantime does not matter. A vehicle whose airspeed responds too slowly for that gets a
    quarter of its bandwidth.

    Parameters
    ----------
    bandwidth : of the vehicle's airspeed behind its command [rad/s]
    speed : V_r [m/s]
    look_ahead : R of equation (15) [m]
    airspeed_min, airspeed_max : of the vehicle [m/s]

    Raises
    ------
    InfeasibleError : V_r is outside of the vehicle's airspeeds, or another value is not above 0
    """
    if not airspeed_min < speed < airspeed_max:
        raise InfeasibleError(
            f"reference speed is {speed:g} m/s; to keep it in gusts it must lie between"
            f" {airspeed_min:g} and {airspeed_max:g} m/s"
        )
    for name, value, unit in (("bandwidth", bandwidth, "rad/s"), ("look-ahead", look_ahead, "m")):
        if not value > 0.0:
            raise InfeasibleError(f"speed hold: {name} is {value:g} {unit}; it must be above 0")
    return SpeedHold(min(speed / look_ahead, _CRITICAL * bandwidth), airspeed_min, airspeed_max)


@dataclass(frozen=True, slots=True, kw_only=True)
class PaceHold:
    """Holds the speed over the mean air, not the airspeed.

    An autopilot that holds the airspeed follows every gust along its path. This law commands the
    measured airspeed, corrected by the error of the speed over the mean air: gusts cancel in the
    sum, and the airspeed varies with them instead.

    Attributes
    ----------
    speed : V_r [m/s]
    hold : parameters of the vehicle
    turn_speed : largest speed at which the vehicle can turn at omega_max, not exceeded while the
        keep-out guard turns it away [m/s]
    """

    speed: float
    hold: SpeedHold
    turn_speed: float = math.inf

    def pace(self, along: float, /) -> float:
        """Return the speed over the mean air that brings the vehicle beside its reference [m/s]."""
        hold = self.hold
        return clip(self.speed + hold.gain * along, hold.airspeed_min, hold.airspeed_max)

    def airspeed(self, pace: float, own: OwnMotion, guarding: bool, /) -> float:
        """Return the airspeed to command for a pace [m/s]."""
        hold = self.hold
        command = clip(own.airspeed + pace - own.speed, hold.airspeed_min, hold.airspeed_max)
        return self.turn_speed if guarding and command > self.turn_speed else command


def air_turn(heading_rate: float, *, speed: float, airspeed: float) -> float:
    """Return the command for a heading rate over the mean air, of an autopilot in gusts [rad/s].

    The autopilot knows the lateral acceleration and divides it by its airspeed. The same
    acceleration turns the motion over the mean air by airspeed/speed as much. With the speeds
    exchanged, the function converts a measured heading rate to one over the mean air.

    Parameters
    ----------
    heading_rate : of the motion over the mean air [rad/s]
    speed : horizontal speed over the mean air [m/s]
    airspeed : measured airspeed, against the gusty air [m/s]
    """
    return heading_rate * speed / airspeed
