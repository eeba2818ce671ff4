"""A reference point whose mean velocity is steered, so that it can follow a centre of oscillation
that manoeuvres.

The course is that of equation (3), chi_r = chi_m + eta cos(theta), or that of another shape of the
same amplitude and phase, but the mean course chi_m, the amplitude eta and the frequency omega_0
change with time. Their rates share the heading rate that the vehicle can fly: whatever turning the
mean course takes is taken from the frequency, so that |chi_m'| + |eta'| and the largest heading
rate of the oscillation, eta omega_0 of the sinusoid, together never exceed it.

Where the orbit's centre is follows from the present parameters by a series, that of equation (12)
of the sinusoid. Turning the mean course by dchi moves the centre by dchi times its distance from
the reference, up to a hundred metres per radian, and so does a change of eta. Both therefore move
mostly while the reference passes the centre.
"""

import math

from gnc.numeric import limited, wrap
from gnc.reference.reference import Swing, with_state_of

_GATE = 0.2
"""Fraction of their rates that mean course and amplitude keep where the reference is farthest from
the centre [-].
"""

_RATE_GAIN = 0.8
"""Rate of mean course and amplitude per difference from what is demanded, in units of the heading
rate [-].
"""

_RATE_FRACTION = 0.3
"""Fraction of the heading rate that either of them may take [-]."""

_SMOOTHING = 0.25
"""Time constant of their rates, over one through the heading rate [-]: that of a rolling aircraft
does not jump.
"""

_STATE = (
    "_available", "_cos_course", "_cos_phase", "_eta_demand", "_eta_rate", "_mean_demand", "_mean_rate", "_rate_gain",
    "_rate_max", "_share_demand", "_sin_course", "_smoothing", "_swing", "_time_step", "course", "east", "eta", "heading_rate",
    "mean_course", "north", "omega_0", "phase", "share", "speed",
)  # fmt: skip
"""Attributes of a reference."""


class SteeredReference:
    """The reference point, moved in equal time steps, with a mean velocity that ``steer`` sets.

    Parameters
    ----------
    north, east : where it starts, in the frame in which it moves [m]
    mean_course : chi_m [rad]
    speed_ratio : its mean speed over its speed [-]
    phase : theta [rad]
    swing : its courses, by shape
    speed : V_r [m/s]
    heading_rate : largest that it may have, omega_max less the reserve [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : as of ``gnc.reference.reference.Reference``
    mean_course, eta, omega_0, phase : of the oscillation [rad, rad, rad/s, rad]
    share : part of its heading rate that it takes now [-]
    """

    __slots__ = _STATE

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
        self.share = self._share_demand = 1.0
        self._time_step = time_step
        self._rate_max = _RATE_FRACTION * heading_rate
        self._smoothing = min(1.0, time_step * heading_rate / _SMOOTHING)
        self._rate_gain = _RATE_GAIN * heading_rate
        self._mean_rate = self._eta_rate = 0.0
        self.north, self.east = north, east
        self.mean_course = self._mean_demand = mean_course
        self.eta = self._eta_demand = swing.eta(speed_ratio)
        self.phase = phase
        self.omega_0 = swing.frequency(self.eta, heading_rate)
        self._cos_phase = math.cos(phase)
        self.course = mean_course + swing.course(self.eta, phase)
        self._cos_course, self._sin_course = math.cos(self.course), math.sin(self.course)
        self.heading_rate = self.eta * self.omega_0 * swing.slopes(self.eta, phase)[1]

    def __copy__(self) -> "SteeredReference":
        """Return a copy, which a law may move ahead. Python cannot make one of what is compiled."""
        other = SteeredReference(
            north=self.north,
            east=self.east,
            mean_course=self.mean_course,
            speed_ratio=self.speed_ratio,
            phase=self.phase,
            swing=self._swing,
            speed=self.speed,
            heading_rate=self._available,
            time_step=self._time_step,
        )
        return with_state_of(self, other, _STATE)

    def __deepcopy__(self, _memo: object) -> "SteeredReference":
        """Return a copy: its shape never changes."""
        return self.__copy__()

    def steer(self, mean_course: float, speed_ratio: float) -> None:
        """Set the mean course [rad] and the mean speed over the speed [-] that are demanded from
        now on.
        """
        self._mean_demand = mean_course
        self._eta_demand = self._swing.eta(speed_ratio)

    def spend(self, share: float) -> None:
        """Set the part of its heading rate that it takes from its next passage through the centre
        on [-].
        """
        self._share_demand = share

    def step(self) -> None:
        """Advance one time step."""
        dt, rate_max, smoothing = self._time_step, self._rate_max, self._smoothing
        swing = self._swing
        phase, eta, mean_course, cos_phase = self.phase, self.eta, self.mean_course, self._cos_phase
        gate = _GATE + (1.0 - _GATE) * cos_phase * cos_phase
        turn = limited(self._rate_gain * wrap(self._mean_demand - mean_course), rate_max)
        self._mean_rate = mean_rate = self._mean_rate + smoothing * (gate * turn - self._mean_rate)
        grow = limited(self._rate_gain * (self._eta_demand - eta), rate_max)
        self._eta_rate = eta_rate = self._eta_rate + smoothing * (gate * grow - self._eta_rate)
        half = 0.5 * dt
        middle_eta, middle_mean = eta + half * eta_rate, mean_course + half * mean_rate
        self.eta = eta = eta + dt * eta_rate
        self.mean_course = mean_course = mean_course + dt * mean_rate
        self.omega_0 = omega_0 = swing.frequency(
            eta, self.share * self._available - abs(mean_rate) - abs(eta_rate)
        )
        middle = middle_mean + swing.course(middle_eta, phase + half * omega_0)
        self.phase = after = phase + dt * omega_0
        if self.share != self._share_demand and math.floor(after / math.pi) != math.floor(
            phase / math.pi
        ):
            self.share = self._share_demand
        phase = after
        self._cos_phase = math.cos(phase)
        self.course = last = mean_course + swing.course(eta, phase)
        cos_first, sin_first = self._cos_course, self._sin_course
        self._cos_course, self._sin_course = cos_last, sin_last = math.cos(last), math.sin(last)
        distance = self.speed * dt / 6.0
        self.north += distance * (cos_first + 4.0 * math.cos(middle) + cos_last)
        self.east += distance * (sin_first + 4.0 * math.sin(middle) + sin_last)
        by_eta, by_phase = swing.slopes(eta, phase)
        self.heading_rate = mean_rate + eta_rate * by_eta + eta * omega_0 * by_phase

    @property
    def speed_ratio(self) -> float:
        """Return the mean speed over the speed [-]; of the sinusoid J_0(eta), equation (5)."""
        return self._swing.speed_ratio(self.eta)

    def centre(self) -> tuple[float, float]:
        """Return north and east of the orbit's centre, if the parameters stayed as they are [m]."""
        along, right = self._swing.offset(self.eta, self.phase)
        scale = self.speed / self.omega_0
        cos_m, sin_m = math.cos(self.mean_course), math.sin(self.mean_course)
        return self.north - scale * (along * cos_m - right * sin_m), self.east - scale * (
            along * sin_m + right * cos_m
        )
