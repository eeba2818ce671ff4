"""A reference point whose mean velocity is steered, so that it can follow a centre of oscillation that manoeuvres.

The course is that of equation (3), chi_r = chi_m + eta cos(theta), but the mean course chi_m, the amplitude eta and the frequency
omega_0 change with time. Their rates share the heading rate that the vehicle can fly: whatever turning the mean course takes is
taken from the frequency, so that |chi_m'| + |eta'| + eta omega_0 never exceeds it.

Where the orbit's centre is follows from the present parameters in closed form, the series of equation (12). Turning the mean course
by dchi moves the centre by dchi times its distance from the reference, up to a hundred metres per radian, and so does a change of
eta. Both therefore move mostly while the reference passes the centre.
"""

import math

from common.units import STANDARD_GRAVITY
from gnc.numeric import wrap
from gnc.reference.orbit_tables import eta_for_mean_speed, unit_offset

_ETA_FREQUENCY = 0.2
"""Amplitude below which the frequency no longer rises [rad]: nearly straight flight needs no fast oscillation."""

_GATE = 0.2
"""Fraction of their rates that mean course and amplitude keep where the reference is farthest from the centre [-]."""

_RATE_GAIN = 0.8
"""Rate of mean course and amplitude per difference from what is demanded, in units of the heading rate [-]."""

_RATE_FRACTION = 0.3
"""Fraction of the heading rate that either of them may take [-]."""

_SMOOTHING = 0.25
"""Time constant of their rates, over one through the heading rate [-]: that of a rolling aircraft does not jump."""


class SteeredReference:
    """The reference point, moved in equal time steps, with a mean velocity that ``steer`` sets.

    Parameters
    ----------
    north, east : where it starts, in the frame in which it moves [m]
    mean_course : chi_m [rad]
    speed_ratio : its mean speed over its speed [-]
    phase : theta [rad]
    speed : V_r [m/s]
    heading_rate : largest that it may have, omega_max less the reserve [rad/s]
    roll_rate_max : of the vehicle; bounds eta omega_0^2 by g/V times it [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : as of ``gnc.reference.reference.Reference``
    mean_course, eta, omega_0, phase : of the oscillation [rad, rad, rad/s, rad]
    """

    __slots__ = (
        "_acceleration",
        "_available",
        "_cos_course",
        "_cos_phase",
        "_eta_demand",
        "_eta_rate",
        "_mean_demand",
        "_mean_rate",
        "_rate_gain",
        "_rate_max",
        "_sin_course",
        "_smoothing",
        "_time_step",
        "course",
        "east",
        "eta",
        "heading_rate",
        "mean_course",
        "north",
        "omega_0",
        "phase",
        "speed",
    )

    def __init__(
        self,
        *,
        north: float,
        east: float,
        mean_course: float,
        speed_ratio: float,
        phase: float,
        speed: float,
        heading_rate: float,
        roll_rate_max: float,
        time_step: float,
    ) -> None:
        self.speed = speed
        self._available = heading_rate
        self._acceleration = STANDARD_GRAVITY * roll_rate_max / speed
        self._time_step = time_step
        self._rate_max = _RATE_FRACTION * heading_rate
        self._smoothing = min(1.0, time_step * heading_rate / _SMOOTHING)
        self._rate_gain = _RATE_GAIN * heading_rate
        self._mean_rate = self._eta_rate = 0.0
        self.north, self.east = north, east
        self.mean_course = self._mean_demand = mean_course
        self.eta = self._eta_demand = eta_for_mean_speed(speed_ratio)
        self.phase = phase
        self.omega_0 = self._frequency()
        self._cos_phase = math.cos(phase)
        self.course = mean_course + self.eta * self._cos_phase
        self._cos_course, self._sin_course = math.cos(self.course), math.sin(self.course)
        self.heading_rate = -self.eta * self.omega_0 * math.sin(phase)

    def steer(self, mean_course: float, speed_ratio: float) -> None:
        """Set the mean course [rad] and the mean speed over the speed [-] that are demanded from now on."""
        self._mean_demand = mean_course
        self._eta_demand = eta_for_mean_speed(speed_ratio)

    def step(self) -> None:
        """Advance one time step."""
        cos, sin, dt, rate_max, smoothing = math.cos, math.sin, self._time_step, self._rate_max, self._smoothing
        phase, eta, mean_course, cos_phase = self.phase, self.eta, self.mean_course, self._cos_phase
        gate = _GATE + (1.0 - _GATE) * cos_phase * cos_phase
        turn = self._rate_gain * wrap(self._mean_demand - mean_course)
        if not -rate_max < turn < rate_max:
            turn = math.copysign(rate_max, turn)
        self._mean_rate = mean_rate = self._mean_rate + smoothing * (gate * turn - self._mean_rate)
        grow = self._rate_gain * (self._eta_demand - eta)
        if not -rate_max < grow < rate_max:
            grow = math.copysign(rate_max, grow)
        self._eta_rate = eta_rate = self._eta_rate + smoothing * (gate * grow - self._eta_rate)
        half = 0.5 * dt
        middle_eta, middle_mean = eta + half * eta_rate, mean_course + half * mean_rate
        self.eta = eta = eta + dt * eta_rate
        self.mean_course = mean_course = mean_course + dt * mean_rate
        self.omega_0 = omega_0 = self._frequency()
        middle = middle_mean + middle_eta * cos(phase + half * omega_0)
        self.phase = phase = phase + dt * omega_0
        self._cos_phase = cos_phase = cos(phase)
        self.course = last = mean_course + eta * cos_phase
        cos_first, sin_first = self._cos_course, self._sin_course
        self._cos_course, self._sin_course = cos_last, sin_last = cos(last), sin(last)
        distance = self.speed * dt / 6.0
        self.north += distance * (cos_first + 4.0 * cos(middle) + cos_last)
        self.east += distance * (sin_first + 4.0 * sin(middle) + sin_last)
        self.heading_rate = mean_rate + eta_rate * cos_phase - eta * omega_0 * sin(phase)

    @property
    def speed_ratio(self) -> float:
        """Return the mean speed over the speed, J_0(eta) [-]: equation (5)."""
        # The power series of J_0 in (eta/2)^2, whose k-th term is -x/k^2 of the one before: good to 5e-7 up to eta = 2.4.
        x = 0.25 * self.eta * self.eta
        return 1.0 - x * (1.0 - x / 4.0 * (1.0 - x / 9.0 * (1.0 - x / 16.0 * (1.0 - x / 25.0 * (1.0 - x / 36.0)))))

    def centre(self) -> tuple[float, float]:
        """Return north and east of the orbit's centre, if the parameters stayed as they are [m]."""
        along, right = unit_offset(self.eta, self.phase)
        scale = self.speed / self.omega_0
        cos_m, sin_m = math.cos(self.mean_course), math.sin(self.mean_course)
        return self.north - scale * (along * cos_m - right * sin_m), self.east - scale * (along * sin_m + right * cos_m)

    def _frequency(self) -> float:
        """Return omega_0 by the heading rate that is left and by the roll rate, as ``gnc.reference.oscillation`` does [rad/s]."""
        eta = self.eta if self.eta > _ETA_FREQUENCY else _ETA_FREQUENCY
        by_heading_rate = (self._available - abs(self._mean_rate) - abs(self._eta_rate)) / eta
        by_roll_rate = math.sqrt(self._acceleration / eta)
        return by_heading_rate if by_heading_rate < by_roll_rate else by_roll_rate
