"""Whether the vehicle still follows its commands, judged by its airspeed, its heading rate and its
servos' reports.
"""

import math
from enum import Enum

PATIENCE = 2.0
"""Time constant of the means by which a fault is found [s]."""

STUCK, SERVO_PATIENCE = 0.1, 0.1
"""Mean error of a control surface, over its travel [-], above which it counts as stuck, and time
constant of that mean [s]: several lags of a servo. Of sound ones it is up to 0.03, in severe and in
light turbulence."""


class Fault(Enum):
    """A fault of the vehicle."""

    NONE = "none"
    THRUST_LOST = "thrust lost"
    CONTROL_LOST = "control lost"
    ACTUATOR_STUCK = "actuator stuck"


class Health:
    """Monitors airspeed, heading rate and servos. A fault, once detected, stays.

    Thrust is lost when the airspeed stays below its command and does not rise. Control is lost when
    the heading rate stays away from that of a vehicle with its lag under the same commands. An
    actuator is stuck when its control surface stays away from its command; that is detected seconds
    before the heading rate shows it, and turbulence does not cause it.

    Parameters
    ----------
    airspeed_error : mean lack of airspeed above which thrust counts as lost [m/s]
    heading_rate_error : mean absolute difference above which control counts as lost [rad/s]
    lag : of the heading rate behind its command [s]
    time_step : between checks [s]

    Attributes
    ----------
    fault : detected, if any
    """

    __slots__ = (
        "_airspeed_error",
        "_decay",
        "_expected",
        "_lag_decay",
        "_last_airspeed",
        "_mean_error",
        "_mean_gain",
        "_mean_lack",
        "_mean_servo_error",
        "_rate_error",
        "_servo_decay",
        "fault",
    )  # fmt: skip

    def __init__(
        self, *, airspeed_error: float, heading_rate_error: float, lag: float, time_step: float
    ) -> None:
        self._airspeed_error, self._rate_error = airspeed_error, heading_rate_error
        self._decay, self._servo_decay = (
            math.exp(-time_step / PATIENCE),
            math.exp(-time_step / SERVO_PATIENCE),
        )
        self._lag_decay = math.exp(-time_step / lag) if lag > 0.0 else 0.0
        self._mean_lack = self._mean_gain = self._mean_error = self._mean_servo_error = (
            self._expected
        ) = 0.0
        self._last_airspeed = 0.0
        self.fault = Fault.NONE

    def check(
        self, lack: float, airspeed: float, heading_rate: float, command: float, servo_error: float
    ) -> Fault:
        """Return the fault that has been detected, if any.

        Parameters
        ----------
        lack : commanded less measured airspeed [m/s]
        airspeed : measured [m/s]
        heading_rate : of that motion [rad/s]
        command : last heading-rate command [rad/s]
        servo_error : of the control surface that is farthest from its command, over its travel [-]
        """
        decay, servo_decay = self._decay, self._servo_decay
        self._expected = self._lag_decay * self._expected + (1.0 - self._lag_decay) * command
        self._mean_lack = decay * self._mean_lack + (1.0 - decay) * lack
        gained = airspeed - self._last_airspeed if self._last_airspeed else 0.0
        self._last_airspeed = airspeed
        self._mean_gain = decay * self._mean_gain + (1.0 - decay) * gained
        self._mean_error = decay * self._mean_error + (1.0 - decay) * abs(
            heading_rate - self._expected
        )
        self._mean_servo_error = (
            servo_decay * self._mean_servo_error + (1.0 - servo_decay) * servo_error
        )
        if self.fault is Fault.NONE:
            if self._mean_servo_error > STUCK:
                self.fault = Fault.ACTUATOR_STUCK
            elif self._mean_lack > self._airspeed_error and self._mean_gain < 0.0:
                self.fault = Fault.THRUST_LOST
            elif self._mean_error > self._rate_error:
                self.fault = Fault.CONTROL_LOST
        return self.fault
