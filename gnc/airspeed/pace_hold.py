"""Keeping pace with the reference in gusts: hold the speed over the mean air, not the airspeed.

An autopilot that holds airspeed follows every gust along its path. Here it is asked for the
airspeed that it has, and what the speed over the mean air lacks; gusts drop out of the sum, and the
airspeed varies with them instead.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from gnc.errors import InfeasibleError
from gnc.estimation.navigation import OwnMotion

_CRITICAL = 0.25
"""Of a first-order loop's bandwidth, the gain of a position loop about it that has two equal poles:
none faster, no overshoot.
"""


class SpeedHold(NamedTuple):
    """Parameters of the law.

    Attributes
    ----------
    gain : speed per along-track error [1/s]
    airspeed_min, airspeed_max : between which airspeed is commanded [m/s]
    """

    gain: float
    airspeed_min: float
    airspeed_max: float

    def within(self, airspeed: float) -> float:
        """Return the airspeed nearest to this one that can be commanded [m/s]."""
        if airspeed > self.airspeed_max:
            return self.airspeed_max
        return self.airspeed_min if airspeed < self.airspeed_min else airspeed


def design_speed_hold(
    *, bandwidth: float, speed: float, look_ahead: float, airspeed_min: float, airspeed_max: float
) -> SpeedHold:
    """Return the parameters for a vehicle and a look-ahead.

    The steering law takes out an error across the path at the rate V_r/R. At the same rate along
    it, an error dies out on a straight line, and it does not matter that the path turns meanwhile.
    A vehicle whose airspeed answers too slowly for that gets a quarter of its bandwidth.

    Parameters
    ----------
    bandwidth : of the vehicle's airspeed behind its command [rad/s]
    speed : V_r [m/s]
    look_ahead : R of equation (15) [m]
    airspeed_min, airspeed_max : that the vehicle can fly [m/s]

    Raises
    ------
    InfeasibleError : V_r is not between the airspeeds that the vehicle can fly, or one of the
        others is not above 0
    """
    if not airspeed_min < speed < airspeed_max:
        raise InfeasibleError(
            f"reference speed is {speed:g} m/s; to keep it in gusts it must lie between {airspeed_min:g} and {airspeed_max:g} m/s"
        )
    for name, value, unit in (("bandwidth", bandwidth, "rad/s"), ("look-ahead", look_ahead, "m")):
        if not value > 0.0:
            raise InfeasibleError(f"speed hold: {name} is {value:g} {unit}; it must be above 0")
    return SpeedHold(min(speed / look_ahead, _CRITICAL * bandwidth), airspeed_min, airspeed_max)


@dataclass(frozen=True, slots=True, kw_only=True)
class PaceHold:
    """Keeps pace with the reference by the speed over the mean air.

    Attributes
    ----------
    speed : V_r [m/s]
    hold : parameters of the law
    turn_speed : up to which the vehicle can turn at omega_max; not exceeded while the keep-out
        guard turns it away [m/s]
    """

    speed: float
    hold: SpeedHold
    turn_speed: float = math.inf

    def pace(self, along: float, /) -> float:
        """Return the pace that brings the vehicle beside a reference that is so far ahead along its
        course [m/s].
        """
        return self.hold.within(self.speed + self.hold.gain * along)

    def airspeed(self, pace: float, own: OwnMotion, guarding: bool, /) -> float:
        """Return the airspeed to command for a pace [m/s]: the measured one, and what the speed
        over the mean air lacks.

        Parameters
        ----------
        pace : [m/s]
        own : the vehicle's motion: its speed over the mean air, its airspeed against the gusty air
        guarding : whether the keep-out guard turns the vehicle away, or did so of late
        """
        command = self.hold.within(own.airspeed + pace - own.speed)
        return self.turn_speed if guarding and command > self.turn_speed else command


def air_turn(heading_rate: float, *, speed: float, airspeed: float) -> float:
    """Return what to command [rad/s] of an autopilot that turns against the gusty air, for a turn
    of the motion over the mean air.

    An autopilot knows the lateral acceleration and divides it by its airspeed. The same
    acceleration turns the motion over the mean air by as much more as that is slower. The other way
    round, with speeds exchanged, it makes a measured turn one of that motion.

    Parameters
    ----------
    heading_rate : of the motion over the mean air [rad/s]
    speed : horizontal, over the mean air [m/s]
    airspeed : as measured, against the gusty air [m/s]
    """
    return heading_rate * speed / airspeed
