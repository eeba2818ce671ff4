"""Whether the vehicle still flies as it is told, from its speed and its turning alone."""

import math
from enum import Enum


class Trouble(Enum):
    """What is wrong with the vehicle."""

    NONE = "none"
    NO_THRUST = "no thrust"
    NO_CONTROL = "no control"


class Health:
    """Watches speed and heading rate. Trouble, once found, stays.

    Thrust is gone when the airspeed stays below its command. Control is gone when the heading rate stays away from what a vehicle
    with its lag would make of the commands.

    Parameters
    ----------
    airspeed_error : mean lack of airspeed that is too much [m/s]
    heading_rate_error : mean size of the difference that is too much [rad/s]
    lag : of the heading rate behind its command [s]
    time_step : between looks [s]
    patience : time constant of the means [s]

    Attributes
    ----------
    trouble : what is wrong
    """

    __slots__ = (
        "_airspeed_error",
        "_expected",
        "_kept",
        "_lag_kept",
        "_mean_error",
        "_mean_lack",
        "_rate_error",
        "trouble"
    )  # fmt: skip

    def __init__(self, *, airspeed_error: float, heading_rate_error: float, lag: float, time_step: float, patience: float) -> None:
        self._airspeed_error, self._rate_error = airspeed_error, heading_rate_error
        self._kept = math.exp(-time_step / patience)
        self._lag_kept = math.exp(-time_step / lag) if lag > 0.0 else 0.0
        self._mean_lack, self._mean_error, self._expected = 0.0, 0.0, 0.0
        self.trouble = Trouble.NONE

    def look(self, lack: float, heading_rate: float, command: float) -> Trouble:
        """Return what is wrong.

        Parameters
        ----------
        lack : commanded less measured airspeed [m/s]
        heading_rate : of that motion [rad/s]
        command : heading rate that was last asked for [rad/s]
        """
        kept = self._kept
        self._expected = self._lag_kept * self._expected + (1.0 - self._lag_kept) * command
        self._mean_lack = kept * self._mean_lack + (1.0 - kept) * lack
        self._mean_error = kept * self._mean_error + (1.0 - kept) * abs(heading_rate - self._expected)
        if self.trouble is Trouble.NONE:
            if self._mean_lack > self._airspeed_error:
                self.trouble = Trouble.NO_THRUST
            elif self._mean_error > self._rate_error:
                self.trouble = Trouble.NO_CONTROL
        return self.trouble
