"""A reference whose mean velocity is steered, to follow a centre of oscillation that manoeuvres.

The course is that of equation (3), chi_r = chi_m + eta cos(theta), or that of another shape of the
same amplitude and phase, but the mean course chi_m, the amplitude eta and the frequency omega_0
change with time. Their rates share the heading rate that the vehicle can fly: what turning the mean
course takes is taken from the frequency, so that |chi_m'| + |eta'| and the largest heading rate of
the oscillation, eta omega_0 of the sinusoid, together never exceed it.

Where the orbit's centre is follows from the present parameters by a series, that of equation (12)
of the sinusoid. Turning the mean course by dchi moves the centre by dchi times its distance from
the reference, up to a hundred metres per radian, and so does a change of eta. Both therefore move
mostly while the reference passes the centre.
"""

import math

from gnc.numeric import limited, wrap
from gnc.reference.reference import Swing

_GATE = 0.2
"""Fraction of their rates that mean course and amplitude keep farthest from the centre [-]."""

_RATE_GAIN = 0.8
"""Rate of mean course and amplitude per difference from the demand, over the heading rate [-]."""

_RATE_FRACTION = 0.3
"""Fraction of the heading rate that either of them may take [-]."""

_SMOOTHING = 0.25
"""Time constant of their rates, over one through the heading rate [-]: an aircraft has to roll."""

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
    """A reference in equal time steps, with a mean velocity that ``steer`` sets.

    Parameters
    ----------
    north, east : where it starts, in the frame in which it moves [m]
    mean_course : chi_m [rad]
    speed_ratio : its mean speed over its speed [-]
    phase : theta [rad]
    swing : courses of its shape
    speed : V_r [m/s]
    heading_rate : largest, omega_max less the reserve [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``gnc.reference.reference.Reference``
    mean_course, eta, omega_0, phase : of the oscillation [rad, rad, rad/s, rad]
    turn_rate_fraction : fraction of its heading rate that it turns with now [-]
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
        """Return a copy, which a law may move ahead. Python cannot copy a compiled object."""
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
        """Return a copy: its shape never changes."""
        return self.__copy__()

    def steer(self, mean_course: float, speed_ratio: float) -> None:
        """Set the demanded mean course [rad] and mean speed over speed [-]."""
        self._mean_demand = mean_course
        self._eta_demand = self._swing.eta(speed_ratio)

    def set_turn_rate_fraction(self, fraction: float) -> None:
        """Set the fraction of its heading rate that it turns with from its next passage on [-]."""
        self._fraction_demand = fraction

    def step(self) -> None:
        """Advance one time step."""
        dt = self._time_step
        swing = self._swing
        eta = self.eta
        mean_course = self.mean_course
        phase = self.phase
        first = self.course
        # Mean course and amplitude move towards their demands, mostly while the centre is passed.
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
        # The oscillation takes what they leave of the heading rate.
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
        """Return north and east of the orbit's centre, if its parameters stayed as they are [m]."""
        along, right = self._swing.offset(self.eta, self.phase)
        scale = self.speed / self.omega_0
        cos_m = math.cos(self.mean_course)
        sin_m = math.sin(self.mean_course)
        north = self.north - scale * (along * cos_m - right * sin_m)
        east = self.east - scale * (along * sin_m + right * cos_m)
        return north, east
