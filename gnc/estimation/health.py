"""Faults of the vehicle, detected from its thrust, its heading rate and its servos' reports."""

import math
from dataclasses import dataclass
from enum import Enum

from gnc.estimation.navigation import SensorReadings
from gnc.estimation.thrust import ThrustMonitor, ThrustParameters

PATIENCE = 2.0
"""Time constant of the mean error of the heading rate [s]."""

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

One heading rate is compared with the mean of the commands in between. The longer the interval is,
the more a vehicle without lag differs from that mean.
"""


class Fault(Enum):
    """A fault of the vehicle."""

    NONE = "none"
    THRUST_LOST = "thrust lost"
    CONTROL_LOST = "control lost"
    ACTUATOR_STUCK = "actuator stuck"


@dataclass(frozen=True, slots=True, kw_only=True)
class HealthParameters:
    """The properties of a healthy vehicle.

    Attributes
    ----------
    thrust : model of the expected thrust; None for a vehicle without an engine
    heading_rate_max : omega_max, or the heading rate of a vehicle in turbulence without a command,
        if that is larger [rad/s]
    lag : of the heading rate behind its command [s]
    time_step : of the guidance [s]
    """

    thrust: ThrustParameters | None
    heading_rate_max: float
    lag: float
    time_step: float


class HealthMonitor:
    """Checks thrust, heading rate and servos at a fixed interval.

    Thrust is lost when height of energy is missing (``gnc.estimation.thrust``); that fault ends
    when thrust is there again. The others stay. Control is lost when the heading rate stays away
    from that of a vehicle with its lag under the same commands. An actuator is stuck when its
    control surface stays away from its command; that is detected seconds before the heading rate
    shows it, and turbulence does not cause it.

    Parameters
    ----------
    parameters : of the healthy vehicle
    check_interval : time between checks [s]

    Attributes
    ----------
    fault : present fault, if any
    thrust : monitor of the thrust, or None
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
        self._rate_limit = UNCONTROLLED * p.heading_rate_max
        self._steps = self._interval - 1
        self._commanded = 0.0
        self._expected_rate = 0.0
        self._mean_rate_error = 0.0
        self._mean_servo_error = 0.0
        self.thrust = ThrustMonitor(p.thrust, between) if p.thrust else None
        self.fault = Fault.NONE

    def check(self, readings: SensorReadings, heading_rate_command: float) -> bool:
        """Return whether a fault begins or ends; call it once per guidance step.

        Parameters
        ----------
        readings : of the sensors on board
        heading_rate_command : last command [rad/s]
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
        self._update(readings, command)
        before = self.fault
        if before is Fault.NONE or before is Fault.THRUST_LOST:
            self.fault = self._detected()
        return self.fault is not before

    def _update(self, readings: SensorReadings, heading_rate_command: float) -> None:
        _, airspeed, _, _, heading_rate, servo_error, engine = readings
        if self.thrust is not None and engine is not None:
            self.thrust.update(airspeed, engine)
        self._expected_rate = _mean(self._expected_rate, heading_rate_command, self._lag_decay)
        rate_error = abs(heading_rate - self._expected_rate)
        self._mean_rate_error = _mean(self._mean_rate_error, rate_error, self._decay)
        self._mean_servo_error = _mean(self._mean_servo_error, servo_error, self._servo_decay)

    def _detected(self) -> Fault:
        if self._mean_servo_error > STUCK:
            return Fault.ACTUATOR_STUCK
        if self.thrust is not None and self.thrust.lost:
            return Fault.THRUST_LOST
        if self._mean_rate_error > self._rate_limit:
            return Fault.CONTROL_LOST
        return Fault.NONE


def _mean(mean: float, value: float, decay: float) -> float:
    """Return an exponentially weighted mean with a new value in it."""
    return decay * mean + (1.0 - decay) * value
