"""A reference point whose mean velocity is steered, so that it can follow a centre of oscillation that manoeuvres.

The course is that of equation (3), chi_r = chi_m + eta cos(theta), but the mean course chi_m, the amplitude eta and the frequency
omega_0 change with time. Their rates share the heading rate that the vehicle can fly: whatever turning the mean course takes is
taken from the frequency, so that |chi_m'| + |eta'| + eta omega_0 never exceeds it.

Where the orbit's centre is follows from the present parameters in closed form, the series of equation (12). Turning the mean course
by dchi moves the centre by dchi times its distance from the reference, up to a hundred metres per radian, and so does a change of
eta. Both therefore move mostly while the reference passes the centre.
"""

import bisect
import math
from functools import lru_cache

import numpy as np
from scipy.special import j0, jv

from gnc.angles import wrap
from gnc.reference.oscillation import GRAVITY

_ORDERS = 4
"""Pairs of Bessel functions in the series of the orbit; what is left out is below 1e-4 of its width at the largest eta."""

_ETA_TOP = 2.9
_ETA_STEP = 0.005
_ETA_FREQUENCY = 0.2
"""Amplitude below which the frequency no longer rises [rad]: nearly straight flight needs no fast weave."""

_GATE = 0.2
"""Share of their rates that mean course and amplitude keep where the reference is farthest from the centre [-]."""

_RATE_GAIN = 0.8
"""Rate of mean course and amplitude per difference from what is wanted, in units of the heading rate [-]."""

_RATE_SHARE = 0.3
"""Share of the heading rate that either of them may take [-]."""

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
    heading_rate : what it may turn at most, reserve taken off [rad/s]
    roll_rate_max : of the vehicle; bounds eta omega_0^2 by g/V times it [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : as of ``gnc.reference.oscillating.Reference``
    mean_course, eta, omega_0, phase : of the oscillation [rad, rad, rad/s, rad]
    """

    __slots__ = (
        "_acceleration",
        "_available",
        "_cos_course",
        "_cos_phase",
        "_eta_rate",
        "_eta_wanted",
        "_mean_rate",
        "_mean_wanted",
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
        self._acceleration = GRAVITY * roll_rate_max / speed
        self._time_step = time_step
        self._rate_max = _RATE_SHARE * heading_rate
        self._smoothing = min(1.0, time_step * heading_rate / _SMOOTHING)
        self._rate_gain = _RATE_GAIN * heading_rate
        self._mean_rate = self._eta_rate = 0.0
        self.north, self.east = north, east
        self.mean_course = self._mean_wanted = mean_course
        self.eta = self._eta_wanted = eta_for_mean_speed(speed_ratio)
        self.phase = phase
        self.omega_0 = self._frequency()
        self._cos_phase = math.cos(phase)
        self.course = mean_course + self.eta * self._cos_phase
        self._cos_course, self._sin_course = math.cos(self.course), math.sin(self.course)
        self.heading_rate = -self.eta * self.omega_0 * math.sin(phase)

    def steer(self, mean_course: float, speed_ratio: float) -> None:
        """Set the mean course [rad] and the mean speed over the speed [-] that are wanted from now on."""
        self._mean_wanted = mean_course
        self._eta_wanted = eta_for_mean_speed(speed_ratio)

    def step(self) -> None:
        """Advance one time step."""
        cos, sin, dt, rate_max, smoothing = math.cos, math.sin, self._time_step, self._rate_max, self._smoothing
        phase, eta, mean_course, cos_phase = self.phase, self.eta, self.mean_course, self._cos_phase
        gate = _GATE + (1.0 - _GATE) * cos_phase * cos_phase
        turn = self._rate_gain * wrap(self._mean_wanted - mean_course)
        if not -rate_max < turn < rate_max:
            turn = math.copysign(rate_max, turn)
        self._mean_rate = mean_rate = self._mean_rate + smoothing * (gate * turn - self._mean_rate)
        grow = self._rate_gain * (self._eta_wanted - eta)
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


def eta_for_mean_speed(speed_ratio: float) -> float:
    """Return eta [rad] for a mean speed over speed, by a table of J_0: equation (6), within 1e-5.

    Differs from ``gnc.reference.bessel.eta_for_speed_ratio`` because a steered reference asks often, and may have to back
    away: ratios down to -0.2 are those of eta beyond the first zero of J_0. Ratios outside -0.2 to 1 are those of the nearest end.
    """
    ratios, etas = _inverse_table()
    if speed_ratio >= 1.0:
        return 0.0
    # Near 1 the ratio is 1 - eta^2/4, so that eta is smooth over the root of what is missing.
    missing = math.sqrt(1.0 - speed_ratio)
    i = min(max(bisect.bisect(ratios, missing), 1), len(ratios) - 1)
    share = min(1.0, (missing - ratios[i - 1]) / (ratios[i] - ratios[i - 1]))
    return etas[i - 1] + share * (etas[i] - etas[i - 1])


def unit_offset(eta: float, phase: float) -> tuple[float, float]:
    """Return where the reference is from the orbit's centre, along the mean course and to its right, in units of V_r/omega_0.

    The series of ``gnc.reference.orbit.offset`` with its Bessel functions from a table, and with theta = ``phase`` [rad].
    """
    table = _bessel_table()
    place = min(max(eta, 0.0), _ETA_TOP - 2.0 * _ETA_STEP) / _ETA_STEP
    i = int(place)
    share = place - i
    low, high = table[i], table[i + 1]
    along = right = 0.0
    for k in range(_ORDERS):
        odd = low[2 * k] + share * (high[2 * k] - low[2 * k])
        even = low[2 * k + 1] + share * (high[2 * k + 1] - low[2 * k + 1])
        right += odd * math.sin((2 * k + 1) * phase)
        along += even * math.sin((2 * k + 2) * phase)
    return along, right


@lru_cache(maxsize=1)
def _inverse_table() -> tuple[list[float], list[float]]:
    etas = np.arange(0.0, _ETA_TOP, _ETA_STEP)
    missing = np.sqrt(np.maximum(0.0, 1.0 - j0(etas)))
    kept = missing <= math.sqrt(1.2)
    return missing[kept].tolist(), etas[kept].tolist()


@lru_cache(maxsize=1)
def _bessel_table() -> list[list[float]]:
    """Coefficients of sin(theta), sin(2 theta), ... by eta, rightward and along in turn."""
    etas = np.arange(0.0, _ETA_TOP + _ETA_STEP, _ETA_STEP)
    columns = []
    for k in range(1, _ORDERS + 1):
        columns.append(2.0 * (-1.0) ** (k - 1) * jv(2 * k - 1, etas) / (2 * k - 1))
        columns.append((-1.0) ** k * jv(2 * k, etas) / k)
    return np.stack(columns, axis=-1).tolist()  # type: ignore[no-any-return]
