"""Whether the vehicle still flies as it is told, from its speed, its turning, and what its servos report."""

import math
from enum import Enum


class Trouble(Enum):
    """What is wrong with the vehicle."""

    NONE = "none"
    NO_THRUST = "no thrust"
    NO_CONTROL = "no control"
    STUCK = "stuck control surface"


class Health:
    """Watches speed, heading rate and servos. Trouble, once found, stays.

    Thrust is gone when the airspeed stays below its command and does not rise. Control is gone when the heading rate stays away
    from what a vehicle with its lag would make of the commands. A control surface is stuck when it stays away from where it was
    told to go; that shows before the vehicle's turning does, by seconds, and turbulence does not look like it.

    Parameters
    ----------
    airspeed_error : mean lack of airspeed that is too much [m/s]
    heading_rate_error : mean size of the difference that is too much [rad/s]
    servo_error : mean of the servos' errors that is too much [-]
    lag : of the heading rate behind its command [s]
    time_step : between looks [s]
    patience : time constant of the means [s]
    servo_patience : time constant of the mean of the servos' errors, several lags of a servo [s]

    Attributes
    ----------
    trouble : what is wrong
    """

    __slots__ = (
        "_airspeed_error",
        "_expected",
        "_kept",
        "_lag_kept",
        "_last_airspeed",
        "_mean_error",
        "_mean_gain",
        "_mean_lack",
        "_mean_servo_error",
        "_rate_error",
        "_servo_error",
        "_servo_kept",
        "trouble"
    )  # fmt: skip

    def __init__(
        self,
        *,
        airspeed_error: float,
        heading_rate_error: float,
        servo_error: float,
        lag: float,
        time_step: float,
        patience: float,
        servo_patience: float,
    ) -> None:
        self._airspeed_error, self._rate_error, self._servo_error = airspeed_error, heading_rate_error, servo_error
        self._kept, self._servo_kept = math.exp(-time_step / patience), math.exp(-time_step / servo_patience)
        self._lag_kept = math.exp(-time_step / lag) if lag > 0.0 else 0.0
        self._mean_lack = self._mean_gain = self._mean_error = self._mean_servo_error = self._expected = 0.0
        self._last_airspeed = 0.0
        self.trouble = Trouble.NONE

    def look(self, lack: float, airspeed: float, heading_rate: float, command: float, servo_error: float) -> Trouble:
        """Return what is wrong.

        Parameters
        ----------
        lack : commanded less measured airspeed [m/s]
        airspeed : measured [m/s]
        heading_rate : of that motion [rad/s]
        command : heading rate that was last asked for [rad/s]
        servo_error : of the control surface that is farthest from what it was told, over its travel [-]
        """
        kept, servo_kept = self._kept, self._servo_kept
        self._expected = self._lag_kept * self._expected + (1.0 - self._lag_kept) * command
        self._mean_lack = kept * self._mean_lack + (1.0 - kept) * lack
        gained = airspeed - self._last_airspeed if self._last_airspeed else 0.0
        self._last_airspeed = airspeed
        self._mean_gain = kept * self._mean_gain + (1.0 - kept) * gained
        self._mean_error = kept * self._mean_error + (1.0 - kept) * abs(heading_rate - self._expected)
        self._mean_servo_error = servo_kept * self._mean_servo_error + (1.0 - servo_kept) * servo_error
        if self.trouble is Trouble.NONE:
            if self._mean_servo_error > self._servo_error:
                self.trouble = Trouble.STUCK
            elif self._mean_lack > self._airspeed_error and self._mean_gain < 0.0:
                self.trouble = Trouble.NO_THRUST
            elif self._mean_error > self._rate_error:
                self.trouble = Trouble.NO_CONTROL
        return self.trouble
