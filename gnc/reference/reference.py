"""Protocols of the reference, its orbits and its shapes, and the registry of shapes."""

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from common.registry import Registry

Array = npt.NDArray[np.float64]


class Reference(Protocol):
    """A point of constant speed that is tracked, moved in equal time steps: equation (13).

    Attributes
    ----------
    north, east : position [m]
    course : chi_r [rad]
    heading_rate : omega_r [rad/s]
    speed : V_r [m/s]
    """

    north: float
    east: float
    course: float
    heading_rate: float
    speed: float

    def step(self) -> None:
        """Advance one time step."""


class OscillatingPoint(Reference, Protocol):
    """A reference on an orbit that can turn more slowly until a vehicle has reached it.

    Attributes
    ----------
    turn_rate_fraction : present fraction of the orbit's heading rate [-]
    """

    turn_rate_fraction: float

    def set_turn_rate_fraction(self, fraction: float) -> None:
        """Set the fraction of the orbit's heading rate from the next phase 0 on [-].

        At phase 0 the heading rate is smallest, and the slower, larger orbit meets the other one.
        """


class PeriodicPath(Protocol):
    """A periodic path about a centre that moves straight at the speed nu V_r."""

    @property
    def nu(self) -> float:
        """Speed ratio, the mean speed over the speed [-]."""

    @property
    def speed(self) -> float:
        """V_r [m/s]."""

    @property
    def eta(self) -> float:
        """Largest course offset from the centre's course [rad]."""

    @property
    def omega_0(self) -> float:
        """Angular frequency, 2 pi over the period [rad/s]."""

    @property
    def limit(self) -> str:
        """What limits the frequency, such as ``heading rate`` or ``roll rate``."""

    @property
    def amplitude(self) -> float:
        """Largest heading rate [rad/s]."""

    @property
    def period(self) -> float:
        """Time of one oscillation [s]."""

    @property
    def crossing_interval(self) -> float:
        """Time between passages through the centre of oscillation [s]."""

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the reference's offset from the centre, along the centre's course and right [m].

        ``time`` [s] counts from phase 0, the passage through the centre with the largest course
        offset to the right. Both offsets have the shape of ``time``.
        """

    @property
    def symmetric(self) -> bool:
        """Whether the second half of the orbit mirrors the first across the centre's course."""

    def half_widths(self) -> tuple[float, float]:
        """Return the orbit's largest offsets from the centre, along its course and across [m]."""


class Orbit(PeriodicPath, Protocol):
    """A periodic path of a reference, with course and heading rate over its phase."""

    def course(self, phase: float) -> float:
        """Return the course relative to the centre's at a phase, omega_0 times time [rad]."""

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course), for each order n [-]."""


class Swing(Protocol):
    """The courses of a shape at every amplitude eta, for a steered reference.

    A course is eta at phase 0, and changes its sign after every half period.
    """

    def eta(self, speed_ratio: float) -> float:
        """Return the amplitude for a ratio of mean speed to speed between -0.2 and 1 [rad]."""

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 for a heading rate [rad/s] and the limit of roll rate [rad/s].

        Below the amplitude ``gnc.reference.shapes.ETA_FREQUENCY`` omega_0 is constant.
        """

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the derivatives of the course offset by eta, and by phase over eta [-]."""

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the offset from the orbit's centre, along its course and right [V_r/omega_0]."""


class ReferenceShape(Protocol):
    """A kind of orbit: a frozen dataclass that is registered under a name."""

    @property
    def turn_rate_fraction_until_tracked(self) -> float:
        """Fraction of the orbit's heading rate until the reference is tracked [-].

        A vehicle limited to omega_max cannot catch up with a reference that uses all of omega_max.
        """

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> Orbit:
        """Return the fastest orbit that the vehicle can follow.

        Parameters
        ----------
        nu : speed ratio [-]
        speed : V_r [m/s]
        heading_rate_max : omega_max [rad/s]
        reserve : fraction of omega_max that the reference leaves to feedback [-]
        vessel_heading_rate : omega_V [rad/s]
        roll_rate_max : largest roll rate of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : the vehicle can follow no such orbit
        """

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the courses of this shape for a steered reference.

        Parameters
        ----------
        speed : V_r [m/s]
        heading_rate : largest heading rate of the reference [rad/s]
        roll_rate_max : largest roll rate of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : a reference of this shape cannot be steered
        """


REFERENCE_SHAPES: Registry[Callable[..., ReferenceShape]] = Registry(
    "reference_shape", folder="gnc.reference", methods=("design", "swing")
)
"""Reference shapes by name: classes that are called with the shape's parameters."""

reference_shape = REFERENCE_SHAPES.register
"""Decorator that registers a reference shape under a name."""


class CirclingReference:
    """The reference of the paper's Simulation 1, which turns steadily: (13) at constant omega_r.

    It starts at the origin on course 0. The motion is computed in closed form; time comes from the
    step count.

    Parameters
    ----------
    speed : V_r [m/s]
    heading_rate : omega_r, positive to the right, not 0 [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``Reference``
    """

    def __init__(self, *, speed: float, heading_rate: float, time_step: float) -> None:
        self.speed = speed
        self.heading_rate = heading_rate
        self.north = 0.0
        self.east = 0.0
        self.course = 0.0
        self._turn = heading_rate * time_step
        self._radius = speed / heading_rate
        self._steps = 0

    def step(self) -> None:
        """Advance one time step."""
        self._steps += 1
        self.course = self._steps * self._turn
        self.north = self._radius * math.sin(self.course)
        self.east = self._radius - self._radius * math.cos(self.course)
