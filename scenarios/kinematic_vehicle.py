"""The paper's vehicle: equation (1), in the same closed loop as JSBSim's."""

import math

from gnc.oscillation import bank_for_heading_rate
from gnc.unicycle import lagged_move, unicycle_move
from scenarios.vehicle import SAMPLE_COLUMNS

_NONE = (math.nan,) * (len(SAMPLE_COLUMNS) - 4)


class KinematicVehicle:
    """A vehicle that flies the commanded airspeed at once and turns at the commanded heading rate, at once or with a lag.

    It keeps its altitude. Its bank is that of a coordinated turn, for comparison only: nothing bounds it.

    Parameters
    ----------
    north, east, altitude : where it starts [m]
    course : [rad]
    speed : [m/s]
    time_step : of the guidance [s]
    lag : time constant of the heading rate behind its command [s]; 0 for equation (1) as it stands
    """

    __slots__ = ("_altitude", "_course", "_east", "_heading_rate", "_lag", "_north", "_speed", "_time_step")

    def __init__(
        self, *, north: float, east: float, altitude: float, course: float, speed: float, time_step: float, lag: float
    ) -> None:
        self._north, self._east, self._altitude = north, east, altitude
        self._course, self._speed = course, speed
        self._heading_rate = 0.0
        self._time_step, self._lag = time_step, lag

    def motion(self) -> tuple[float, float, float, float, float]:
        """Return north, east [m], north and east velocity [m/s] and heading rate [rad/s]."""
        speed, course = self._speed, self._course
        return self._north, self._east, speed * math.cos(course), speed * math.sin(course), self._heading_rate

    def sample(self) -> tuple[float, ...]:
        """Return ``SAMPLE_COLUMNS``."""
        bank = bank_for_heading_rate(self._heading_rate, self._speed)
        return self._altitude, self._speed, bank, 0.0, *_NONE

    def advance(self, heading_rate: float, airspeed: float) -> None:
        """Fly one guidance step with these commands [rad/s, m/s]."""
        self._speed = airspeed
        if self._lag > 0.0:
            self._north, self._east, self._course, self._heading_rate = lagged_move(
                self._north, self._east, self._course, self._heading_rate, airspeed, heading_rate, self._lag, self._time_step
            )
        else:
            self._north, self._east, self._course = unicycle_move(
                self._north, self._east, self._course, airspeed, heading_rate, self._time_step
            )
            self._heading_rate = heading_rate

    def fault(self, sample: tuple[float, ...]) -> str:
        """Return nothing, unless the guidance commanded what is not a number: equation (1) is never out of control."""
        return "" if math.isfinite(sample[2] + self._north + self._east) else "the motion is not a number"
