"""The paper's vehicle: equation (1), in the same closed loop as JSBSim's."""

import math

from aircraft.wind import CALM, WindField
from common.physics import bank_for_heading_rate
from gnc.estimation.navigation import MeasuredMotion
from gnc.unicycle import lagged_move, unicycle_move
from scenarios.errors import InputError
from scenarios.vehicles.vehicle import SAMPLE_COLUMNS

_NONE = (math.nan,) * (len(SAMPLE_COLUMNS) - 5)


class KinematicVehicle:
    """A vehicle that flies the commanded airspeed at once and turns at the commanded heading rate,
    at once or with a lag.

    It takes a commanded altitude at once, and drifts with the wind. Its bank is that of a
    coordinated turn, for comparison only: nothing bounds it.

    Parameters
    ----------
    north, east, altitude : where it starts [m]
    course : course relative to the air; without wind it is the course over the ground [rad]
    speed : against the air [m/s]
    time_step : of the guidance [s]
    lag : time constant of the heading rate behind its command [s]; 0 for equation (1) as it stands
    wind : velocity of the air over time and height
    """

    def __init__(
        self,
        *,
        north: float,
        east: float,
        altitude: float,
        course: float,
        speed: float,
        time_step: float,
        lag: float,
        wind: WindField = CALM,
    ) -> None:
        self._north, self._east, self._altitude = north, east, altitude
        self._course, self._speed = course, speed
        self._heading_rate = 0.0
        self._time_step, self._lag = time_step, lag
        self._wind, self._time = None if wind.constant else wind, 0.0
        self._wind_north, self._wind_east = wind.now(0.0, altitude)

    def motion(self) -> MeasuredMotion:
        """Return the motion now."""
        velocity_north = self._speed * math.cos(self._course) + self._wind_north
        velocity_east = self._speed * math.sin(self._course) + self._wind_east
        return MeasuredMotion(
            self._north, self._east, velocity_north, velocity_east, self._heading_rate
        )

    def air_data(self) -> tuple[float, float, float]:
        """Return airspeed [m/s], heading, not wrapped, and the bank of a coordinated turn [rad]."""
        return self._speed, self._course, bank_for_heading_rate(self._heading_rate, self._speed)

    def engine(self) -> None:
        """Return nothing: equation (1) has no engine."""

    def sample(self) -> tuple[float, ...]:
        """Return ``SAMPLE_COLUMNS``."""
        airspeed, heading, bank = self.air_data()
        return self._altitude, airspeed, bank, 0.0, heading % math.tau, *_NONE

    def advance(self, heading_rate: float, airspeed: float) -> None:
        """Fly one guidance step with these commands [rad/s, m/s]."""
        self._speed = airspeed
        if self._lag > 0.0:
            self._north, self._east, self._course, self._heading_rate = lagged_move(
                self._north,
                self._east,
                self._course,
                self._heading_rate,
                airspeed,
                heading_rate,
                self._lag,
                self._time_step,
            )
        else:
            self._north, self._east, self._course = unicycle_move(
                self._north, self._east, self._course, airspeed, heading_rate, self._time_step
            )
            self._heading_rate = heading_rate
        self._north += self._wind_north * self._time_step
        self._east += self._wind_east * self._time_step
        if self._wind is not None:
            self._time += self._time_step
            self._wind_north, self._wind_east = self._wind.now(self._time, self._altitude)

    def command_altitude(self, altitude: float, /) -> None:
        """Take an altitude [m] at once: equation (1) has none of its own."""
        self._altitude = altitude

    def servo_error(self) -> float:
        """Return 0: equation (1) has no servos."""
        return 0.0

    def hold_elevator(self) -> None:
        """Do nothing: equation (1) has no elevator."""

    def fail(self, name: str) -> None:
        """Raise InputError: equation (1) has no parts."""
        raise InputError(
            f"'{name}' cannot fail in a kinematic flight, which has no parts; fly it with fidelity"
            " six_dof"
        )

    def fault(self, sample: tuple[float, ...]) -> str:
        """Return an empty text, unless the guidance commanded NaN: equation (1) is never out of
        control.
        """
        return (
            ""
            if math.isfinite(sample[2] + self._north + self._east)
            else "the motion is not a number"
        )
