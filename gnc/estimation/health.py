"""Faults of the vehicle, detected from its airspeed, its heading rate and its servos' reports."""

import math
from dataclasses import dataclass
from enum import Enum

from gnc.estimation.navigation import SensorReadings

PATIENCE = 2.0
"""Time constant of the means of airspeed and heading rate [s]."""

SERVO_PATIENCE = 0.1
"""Time constant of the mean error of a control surface [s]: several lags of a servo."""

STUCK = 0.1
"""Mean error of a control surface over its travel, above which it counts as stuck [-].

Sound surfaces reach 0.03, in severe and in light turbulence.
"""

UNCONTROLLED = 0.8
"""Mean error of the heading rate over omega_max, above which control counts as lost [-].

Severe turbulence made it up to 0.58, over 28 flights of 500 s that stayed in control.
"""

CHECK_INTERVAL = 0.2
"""Time between checks, a step of the guidance at least [s].

One heading rate is compared with the mean of the commands in between. From that mean, a vehicle
without lag differs the more, the longer the interval is.
"""


class Fault(Enum):
    """A fault of the vehicle."""

    NONE = "none"
    THRUST_LOST = "thrust lost"
    CONTROL_LOST = "control lost"
    ACTUATOR_STUCK = "actuator stuck"


@dataclass(frozen=True, slots=True, kw_only=True)
class HealthParameters:
    """What a healthy vehicle is like.

    Attributes
    ----------
    airspeed_error : mean lack of airspeed above which thrust counts as lost [m/s]
    speed : V_r; a vehicle that is still speeding up beyond it lacks nothing [m/s]
    heading_rate_max : omega_max, or what a vehicle in turbulence may turn at without a command, if
        that is more [rad/s]
    lag : of the heading rate behind its command [s]
    time_step : of the guidance [s]
    """

    airspeed_error: float
    speed: float
    heading_rate_max: float
    lag: float
    time_step: float


class HealthMonitor:
    """Checks airspeed, heading rate and servos at a fixed interval. A fault, once detected, stays.

    Thrust is lost when the airspeed stays below its command and does not rise. Control is lost when
    the heading rate stays away from that of a vehicle with its lag under the same commands. An
    actuator is stuck when its control surface stays away from its command; that is detected seconds
    before the heading rate shows it, and turbulence does not cause it.

    Parameters
    ----------
    parameters : of the healthy vehicle
    check_interval : time between checks [s]

    Attributes
    ----------
    fault : detected, if any
    """

    def __init__(
        self, parameters: HealthParameters, check_interval: float = CHECK_INTERVAL
    ) -> None:
        p = parameters
        self._interval = max(1, round(check_interval / p.time_step))
        between = self._interval * p.time_step
        self._decay = math.exp(-between / PATIENCE)
        self._servo_decay = math.exp(-between / SERVO_PATIENCE)
        self._lag_decay = math.exp(-between / p.lag) if p.lag > 0.0 else 0.0
        self._speed = p.speed
        self._lack_limit = p.airspeed_error
        self._rate_limit = UNCONTROLLED * p.heading_rate_max
        self._steps = self._interval - 1
        self._commanded = 0.0
        self._expected_rate = 0.0
        self._last_airspeed = 0.0
        self._mean_lack = 0.0
        self._mean_gain = 0.0
        self._mean_rate_error = 0.0
        self._mean_servo_error = 0.0
        self.fault = Fault.NONE

    def check(
        self, readings: SensorReadings, airspeed_command: float, heading_rate_command: float
    ) -> bool:
        """Return whether a check was due and finds a fault; call it once per guidance step.

        Parameters
        ----------
        readings : of the sensors on board
        airspeed_command, heading_rate_command : last commands [m/s, rad/s]
        """
        # The mean of the commands since the last check: if the command changes its sign at every
        # step, single ones would all have the same sign, and the vehicle would seem not to follow.
        self._commanded += heading_rate_command
        self._steps += 1
        if self._steps < self._interval:
            return False
        command = self._commanded / self._interval
        self._steps = 0
        self._commanded = 0.0
        self._update_means(readings, min(airspeed_command, self._speed), command)
        if self.fault is Fault.NONE:
            self.fault = self._detected()
        return self.fault is not Fault.NONE

    def _update_means(
        self, readings: SensorReadings, airspeed_command: float, heading_rate_command: float
    ) -> None:
        _, airspeed, _, _, heading_rate, servo_error = readings
        decay = self._decay
        gained = airspeed - self._last_airspeed if self._last_airspeed else 0.0
        self._last_airspeed = airspeed
        self._expected_rate = _mean(self._expected_rate, heading_rate_command, self._lag_decay)
        rate_error = abs(heading_rate - self._expected_rate)
        self._mean_lack = _mean(self._mean_lack, airspeed_command - airspeed, decay)
        self._mean_gain = _mean(self._mean_gain, gained, decay)
        self._mean_rate_error = _mean(self._mean_rate_error, rate_error, decay)
        self._mean_servo_error = _mean(self._mean_servo_error, servo_error, self._servo_decay)

    def _detected(self) -> Fault:
        if self._mean_servo_error > STUCK:
            return Fault.ACTUATOR_STUCK
        if self._mean_lack > self._lack_limit and self._mean_gain < 0.0:
            return Fault.THRUST_LOST
        if self._mean_rate_error > self._rate_limit:
            return Fault.CONTROL_LOST
        return Fault.NONE


def _mean(mean: float, value: float, decay: float) -> float:
    """Return an exponentially weighted mean with a new value in it."""
    return decay * mean + (1.0 - decay) * value
