"""A reference with a steered mean velocity, which follows a manoeuvring centre of oscillation.

The course is chi_r = chi_m + eta cos(theta), equation (3), or the course of another shape with the
same amplitude and phase. The mean course chi_m, the amplitude eta and the frequency omega_0 change
with time. Their rates share the vehicle's heading rate: the frequency is reduced so that |chi_m'| +
|eta'| plus the largest heading rate of the oscillation, eta omega_0 for the sinusoid, never exceeds
it.

The position of the orbit's centre follows from the present parameters by a series, equation (12)
for the sinusoid. Turning the mean course by dchi moves the centre by dchi times its distance from
the reference, up to a hundred metres per radian, and a change of eta moves it as well. Both
therefore change mostly while the reference passes the centre.
"""

import math

from gnc.numeric import limited, wrap
from gnc.reference.reference import Swing

_GATE = 0.2
"""Fraction of the rates of mean course and amplitude that remains far from the centre [-]."""

_RATE_GAIN = 0.8
"""Rate of mean course and amplitude over their error, in units of the heading rate [-]."""

_RATE_FRACTION = 0.3
"""Largest rate of mean course or of amplitude, over the heading rate [-]."""

_SMOOTHING = 0.25
"""Time constant of these rates times the heading rate [-]: an aircraft has to roll."""

_STATE = (
    "north",
    "east",
    "course",
    "heading_rate",
    "mean_course",
    "eta",
    "omega_0",
    "phase",
    "turn_rate_fraction",
    "_fraction_demand",
    "_mean_demand",
    "_eta_demand",
    "_mean_rate",
    "_eta_rate",
)
"""Attributes of a reference that change with time."""


class SteeredReference:
    """A reference moved in equal time steps, with a mean velocity set by ``steer``.

    Parameters
    ----------
    north, east : start position in the frame of its motion [m]
    mean_course : chi_m [rad]
    speed_ratio : mean speed over speed [-]
    phase : theta [rad]
    swing : courses of the shape
    speed : V_r [m/s]
    heading_rate : largest heading rate, omega_max minus the reserve [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : as in ``gnc.reference.reference.Reference``
    mean_course, eta, omega_0, phase : parameters of the oscillation [rad, rad, rad/s, rad]
    turn_rate_fraction : present fraction of the heading rate [-]
    """

    def __init__(
        self,
        *,
        north: float,
        east: float,
        mean_course: float,
        speed_ratio: float,
        phase: float,
        swing: Swing,
        speed: float,
        heading_rate: float,
        time_step: float,
    ) -> None:
        self.speed = speed
        self._swing = swing
        self._available = heading_rate
        self._time_step = time_step
        self._rate_gain = _RATE_GAIN * heading_rate
        self._rate_max = _RATE_FRACTION * heading_rate
        self._smoothing = min(1.0, time_step * heading_rate / _SMOOTHING)
        self.turn_rate_fraction = 1.0
        self._fraction_demand = 1.0
        self._mean_rate = 0.0
        self._eta_rate = 0.0
        self.north = north
        self.east = east
        self.mean_course = mean_course
        self._mean_demand = mean_course
        self.eta = swing.eta(speed_ratio)
        self._eta_demand = self.eta
        self.phase = phase
        self.omega_0 = swing.frequency(self.eta, heading_rate)
        self.course = mean_course + swing.course(self.eta, phase)
        self.heading_rate = self.eta * self.omega_0 * swing.slopes(self.eta, phase)[1]

    def __copy__(self) -> "SteeredReference":
        """Return a copy, which a law may move ahead; Python cannot copy a compiled object."""
        other = SteeredReference(
            north=self.north,
            east=self.east,
            mean_course=self.mean_course,
            speed_ratio=1.0,  # replaced by the state
            phase=self.phase,
            swing=self._swing,
            speed=self.speed,
            heading_rate=self._available,
            time_step=self._time_step,
        )
        for name in _STATE:
            setattr(other, name, getattr(self, name))
        return other

    def __deepcopy__(self, _memo: object) -> "SteeredReference":
        """Return a copy that shares the shape, which never changes."""
        return self.__copy__()

    def steer(self, mean_course: float, speed_ratio: float) -> None:
        """Set the demanded mean course [rad] and ratio of mean speed to speed [-]."""
        self._mean_demand = mean_course
        self._eta_demand = self._swing.eta(speed_ratio)

    def set_turn_rate_fraction(self, fraction: float) -> None:
        """Set the fraction of the heading rate from the next passage of the centre on [-]."""
        self._fraction_demand = fraction

    def step(self) -> None:
        """Advance one time step."""
        dt = self._time_step
        swing = self._swing
        eta = self.eta
        mean_course = self.mean_course
        phase = self.phase
        first = self.course
        # Mean course and amplitude approach their demands, mostly near the centre.
        cos_phase = math.cos(phase)
        gate = _GATE + (1.0 - _GATE) * cos_phase * cos_phase
        turn = limited(self._rate_gain * wrap(self._mean_demand - mean_course), self._rate_max)
        mean_rate = self._mean_rate + self._smoothing * (gate * turn - self._mean_rate)
        grow = limited(self._rate_gain * (self._eta_demand - eta), self._rate_max)
        eta_rate = self._eta_rate + self._smoothing * (gate * grow - self._eta_rate)
        self._mean_rate = mean_rate
        self._eta_rate = eta_rate
        half = 0.5 * dt
        middle_eta = eta + half * eta_rate
        middle_mean = mean_course + half * mean_rate
        eta = eta + dt * eta_rate
        mean_course = mean_course + dt * mean_rate
        # The oscillation uses the remaining heading rate.
        left = self.turn_rate_fraction * self._available - abs(mean_rate) - abs(eta_rate)
        omega_0 = swing.frequency(eta, left)
        middle = middle_mean + swing.course(middle_eta, phase + half * omega_0)
        before = phase
        phase = phase + dt * omega_0
        passed = math.floor(phase / math.pi) != math.floor(before / math.pi)
        if passed:
            self.turn_rate_fraction = self._fraction_demand
        last = mean_course + swing.course(eta, phase)
        # Simpson's rule over the step.
        sixth = self.speed * dt / 6.0
        self.north += sixth * (math.cos(first) + 4.0 * math.cos(middle) + math.cos(last))
        self.east += sixth * (math.sin(first) + 4.0 * math.sin(middle) + math.sin(last))
        by_eta, by_phase = swing.slopes(eta, phase)
        self.heading_rate = mean_rate + eta_rate * by_eta + eta * omega_0 * by_phase
        self.eta = eta
        self.mean_course = mean_course
        self.omega_0 = omega_0
        self.phase = phase
        self.course = last

    def centre(self) -> tuple[float, float]:
        """Return north and east of the centre of the orbit with the present parameters [m]."""
        along, right = self._swing.offset(self.eta, self.phase)
        scale = self.speed / self.omega_0
        cos_m = math.cos(self.mean_course)
        sin_m = math.sin(self.mean_course)
        north = self.north - scale * (along * cos_m - right * sin_m)
        east = self.east - scale * (along * sin_m + right * cos_m)
        return north, east
