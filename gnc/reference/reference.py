"""The point that is tracked: what it is, and which orbits it can have."""

import math
from collections.abc import Callable
from typing import Protocol

import numpy as np
import numpy.typing as npt

from common.registry import Registry

Array = npt.NDArray[np.float64]


class Reference(Protocol):
    """A point of constant speed to be tracked, moved in equal time steps: equation (13).

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
    """A reference on an orbit, which can be slowed down while a vehicle is on its way to it.

    Attributes
    ----------
    turn_rate_fraction : fraction of its heading rate that it turns with now [-]
    """

    turn_rate_fraction: float

    def set_turn_rate_fraction(self, fraction: float) -> None:
        """Set the fraction of its heading rate that it turns with from a passage of phase 0 on [-].

        There it turns least, and the slower orbit, which is larger, meets the other one.
        """


class PeriodicPath(Protocol):
    """A periodic motion about a centre that moves at nu V_r on a straight course."""

    @property
    def nu(self) -> float:
        """Speed ratio, mean speed over speed [-]."""

    @property
    def speed(self) -> float:
        """V_r [m/s]."""

    @property
    def eta(self) -> float:
        """Largest course offset from that of the centre [rad]."""

    @property
    def omega_0(self) -> float:
        """Angular frequency, 2 pi over the period [rad/s]."""

    @property
    def limit(self) -> str:
        """What set the frequency, such as ``heading rate`` or ``roll rate``."""

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
        """Return the reference's offset from the centre, along its course and to its right [m].

        ``time`` [s] counts from phase 0, the passage through the centre at the largest course
        offset to the right. Both have its shape.
        """

    @property
    def symmetric(self) -> bool:
        """Whether the second half of the orbit mirrors the first across the centre's course."""

    def half_widths(self) -> tuple[float, float]:
        """Return how far the orbit reaches from the centre, along its course and across [m]."""


class Orbit(PeriodicPath, Protocol):
    """A reference's periodic motion about the centre of oscillation."""

    def course(self, phase: float) -> float:
        """Return the course offset from that of the centre at a phase, omega_0 times time [rad]."""

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course) at each order n, same shape [-]."""


class Swing(Protocol):
    """The courses of a shape at every amplitude eta, through which a steered reference moves.

    A course is eta at phase 0, -eta half a period later, and everywhere the negative of itself half
    a period later.
    """

    def eta(self, speed_ratio: float) -> float:
        """Return the amplitude for a mean speed over speed between -0.2 and 1 [rad]."""

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 within a heading rate [rad/s] and the roll rate [rad/s].

        Below ``gnc.reference.shapes.ETA_FREQUENCY`` it no longer rises.
        """

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the slopes of the course offset: over eta, and over the phase per eta [-]."""

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the offset from the orbit's centre, along its course and right [V_r/omega_0]."""


class ReferenceShape(Protocol):
    """A kind of orbit: a frozen dataclass, registered by a name."""

    @property
    def turn_rate_fraction_until_tracked(self) -> float:
        """Fraction of its heading rate that a reference turns with until it is tracked [-].

        A vehicle whose commands are cut at omega_max cannot catch up with a reference that takes
        all of it.
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
        roll_rate_max : of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : there is none
        """

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the courses of this shape for a steered reference.

        Parameters
        ----------
        speed : V_r [m/s]
        heading_rate : largest of the reference [rad/s]
        roll_rate_max : of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : a reference of this shape cannot be steered
        """


REFERENCE_SHAPES: Registry[Callable[..., ReferenceShape]] = Registry(
    "reference_shape", folder="gnc.reference", methods=("design", "swing")
)
"""Reference shapes by name; calling one with its parameters makes it."""

reference_shape = REFERENCE_SHAPES.register
"""Decorator that registers a reference shape by a name."""


class CirclingReference:
    """A reference that turns steadily, that of the paper's Simulation 1: (13) at constant omega_r.

    It starts at the origin on course 0. Its motion is in closed form; time comes from the step
    count.

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
