"""When the vehicle's health is looked at, and how much of an error is a fault."""

from dataclasses import dataclass

from gnc.estimation.health import Fault, Health
from gnc.estimation.own_motion import Readings

UNCONTROLLED = 0.8
"""Mean difference of heading rate from its command, over omega_max, at which control counts as lost
[-].

Severe turbulence makes it up to 0.58, over 28 flights of 500 s that stayed in control.
"""

CHECK_INTERVAL = 0.2
"""Time between checks of the vehicle's health, a step of the guidance at least [s].

One heading rate is compared with the mean of the commands in between, from which a vehicle without
lag differs the more the longer that is.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class HealthParameters:
    """What a healthy vehicle is like.

    Attributes
    ----------
    airspeed_error : mean lack of airspeed at which thrust counts as lost [m/s]
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
    """Checks the vehicle's health every ``CHECK_INTERVAL``.

    Attributes
    ----------
    fault : what is wrong with the vehicle; once found, it stays
    """

    __slots__ = ("_commanded", "_health", "_interval", "_speed", "_steps", "fault")

    def __init__(self, parameters: HealthParameters) -> None:
        p = parameters
        self._interval = max(1, round(CHECK_INTERVAL / p.time_step))
        self._health = Health(
            airspeed_error=p.airspeed_error,
            heading_rate_error=UNCONTROLLED * p.heading_rate_max,
            lag=p.lag,
            time_step=self._interval * p.time_step,
        )
        self._speed, self._steps, self._commanded = p.speed, self._interval - 1, 0.0
        self.fault = Fault.NONE

    def check(
        self, readings: Readings, airspeed_command: float, heading_rate_command: float
    ) -> bool:
        """Return whether a fault is found now; called once per guidance step, with the last
        commands [m/s, rad/s].
        """
        # The mean of the commands since the last check: of one that changes its sign at every step,
        # single ones would all have the same sign, and the vehicle would seem not to follow.
        self._commanded += heading_rate_command
        self._steps += 1
        if self._steps < self._interval:
            return False
        commanded = self._commanded / self._interval
        self._steps, self._commanded = 0, 0.0
        _, airspeed, _, _, heading_rate, servo_error = readings
        lack = min(airspeed_command, self._speed) - airspeed
        self.fault = self._health.check(lack, airspeed, heading_rate, commanded, servo_error)
        return self.fault is not Fault.NONE
