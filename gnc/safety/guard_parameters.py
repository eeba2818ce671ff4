"""What the keep-out guard knows beforehand."""

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class GuardParameters:
    """Parameters of the keep-out guard.

    Attributes
    ----------
    radius : that the vehicle's path must keep from the vessel [m]
    heading_rate_max : omega_max, the largest command [rad/s]
    lag : time constant of the vehicle's heading rate behind its command; 0 if it follows at once
        [s]
    delay : dead time before that [s]
    slow_lag : by which it is behind slow commands; None if that is ``delay`` + ``lag`` [s]
    time_step : for which a command is held [s]
    speed_error : largest error of the vehicle's own velocity, of the wind, and by gusts, together
        [m/s]
    deviation : by how much nearer the vehicle may come in a full reversal of its turn than
        predicted [m]
    drift_rate : how fast dead reckoning may go wrong, where satellite navigation may be lost [m/s]
    allowance : of the radius, what is kept for what takes the vehicle off any turn predicted:
        turbulence, a failed part [m]
    wander : by how much the error of its own place may change during a turn away [m]
    turn_speed : up to which it can turn at ``heading_rate_max``; faster it turns at the same
        acceleration across [m/s]
    slowest : airspeed that it may fall to in any turn away, as without thrust; infinite where it
        keeps to its commands [m/s]
    """

    radius: float
    heading_rate_max: float
    lag: float
    delay: float = 0.0
    slow_lag: float | None = None
    time_step: float
    speed_error: float = 0.0
    deviation: float = 0.0
    drift_rate: float = 0.0
    allowance: float = 0.0
    wander: float = 0.0
    turn_speed: float = math.inf
    slowest: float = math.inf
