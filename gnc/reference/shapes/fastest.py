"""The fastest oscillation: the reference turns as hard as it may, one way and then the other
(docs/fastest_oscillation.md).
"""

import functools
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from gnc.paper import available_heading_rate
from gnc.reference.reference import Array, Swing, reference_shape
from gnc.reference.shapes.bank_swing import BankSwing, bank_swing
from gnc.reference.shapes.course_path import CoursePath, fourier_coefficients

JOINING_SHARE = 0.8
"""Part of the heading rate that such a reference takes as long as it is not tracked [-].

Beside an orbit that takes nearly all of it, for most of the time, the cut commands of the steering
law have limit cycles: of 48 flights in still air from anywhere about the vessel 7 did not settle
with 0.985 of omega_max, 5 with 0.95, and none with 0.9.
"""

_ETA_MAX = 3.2
"""Amplitude whose mean speed is below 0 at any roll rate [rad]: sin(3.2)/3.2 = -0.02 at an infinite
one.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class FastestOscillation:
    """The oscillation of shortest period within a bank and a roll rate; attributes as of
    ``gnc.reference.reference.Orbit``.

    Attributes
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    eta : course amplitude [rad]
    crossing_interval : time between crossings of the centre of oscillation, half a period [s]
    omega_0 : angular frequency [rad/s]
    courses : of every amplitude
    """

    nu: float
    speed: float
    eta: float
    crossing_interval: float
    omega_0: float
    courses: BankSwing

    @property
    def symmetric(self) -> bool:
        """Return that the second half of the orbit is the mirror image of the first."""
        return True

    @property
    def period(self) -> float:
        """Time of one oscillation [s]."""
        return 2.0 * self.crossing_interval

    @property
    def amplitude(self) -> float:
        """Largest heading rate [rad/s]."""
        return self.courses.largest_heading_rate(self.eta)

    @property
    def limit(self) -> str:
        """Return ``heading rate`` where the largest bank is held, ``roll rate`` where it is not
        reached.
        """
        return "heading rate" if self.courses.holds_bank(self.eta) else "roll rate"

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return where the reference is from the centre of oscillation, along its course and to its
        right, within 1e-5 m [m].
        """
        along, right = _path(self.courses, self.eta).offset(
            self.omega_0 * np.asarray(time, dtype=np.float64)
        )
        unit = self.speed / self.omega_0
        return unit * along, unit * right

    def half_widths(self) -> tuple[float, float]:
        """Return how far the orbit reaches from the centre, along its course and across [m]."""
        along, across = _path(self.courses, self.eta).half_widths()
        unit = self.speed / self.omega_0
        return unit * along, unit * across

    def course(self, phase: float) -> float:
        """Return the course offset from that of the centre at a phase [rad]."""
        return self.courses.course(self.eta, phase)

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""
        return self.courses.heading_rate(self.eta, phase)

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course) [-]."""
        return np.asarray(np.abs(fourier_coefficients(self.course)[orders]) ** 2)


@reference_shape("fastest")
@dataclass(frozen=True, slots=True)
class Fastest:
    """The reference whose bank is a trapezoid: the shortest crossing interval within the heading
    rate and the roll rate.

    Differs from equation (2), whose heading rate is a sinusoid, because that reaches its limit for
    moments alone.
    """

    @property
    def joining_share(self) -> float:
        """Return the part of the heading rate that is taken while the reference is not tracked [-]."""
        return JOINING_SHARE

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> FastestOscillation:
        """Return the fastest oscillation that the vehicle can follow; parameters are those of
        ``ReferenceShape``.
        """
        available = available_heading_rate(
            nu=nu,
            speed=speed,
            heading_rate_max=heading_rate_max,
            reserve=reserve,
            vessel_heading_rate=vessel_heading_rate,
            roll_rate_max=roll_rate_max,
        )
        courses = bank_swing(speed, available, roll_rate_max)
        eta = float(
            brentq(lambda eta: courses.speed_ratio(eta) - nu, 0.0, _ETA_MAX, xtol=1e-15, rtol=1e-14)
        )
        interval = courses.half_period(eta)
        return FastestOscillation(
            nu=nu,
            speed=speed,
            eta=eta,
            crossing_interval=interval,
            omega_0=math.pi / interval,
            courses=courses,
        )

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the courses of every amplitude; parameters are those of ``ReferenceShape``."""
        return bank_swing(speed, heading_rate, roll_rate_max)


@functools.lru_cache(maxsize=128)
def _path(courses: BankSwing, eta: float) -> CoursePath:
    return CoursePath(functools.partial(courses.course, eta))
