"""What a reference is, and which shapes its orbit about the centre of oscillation can have."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
import numpy.typing as npt

from common.registry import Registry

Array = npt.NDArray[np.float64]

Copied = TypeVar("Copied")

ETA_FREQUENCY = 0.2
"""Amplitude below which the frequency of a steered reference no longer rises [rad]: nearly straight
flight needs none.
"""


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
    share : part of its heading rate that it takes now [-]
    """

    share: float

    def spend(self, share: float) -> None:
        """Set the part of its heading rate that it takes from a passage of phase 0 on [-].

        There it turns least, and a slower orbit, which is a larger one, meets the other one.
        """


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceStart:
    """Where a reference starts.

    Attributes
    ----------
    north, east : [m]
    course : chi_r [rad]
    """

    north: float
    east: float
    course: float


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
        """Return where the reference is from the centre: along its course and to its right [m].

        ``time`` [s] counts from the passage through the centre at the largest course offset to the
        right, which is phase 0.
        """

    def half_widths(self) -> tuple[float, float]:
        """Return how far the orbit reaches from the centre, along its course and across [m]."""


class Orbit(PeriodicPath, Protocol):
    """A reference's periodic motion about the centre of oscillation."""

    @property
    def symmetric(self) -> bool:
        """Whether the second half of the orbit is the mirror image of the first one across the
        course of the centre.
        """

    def course(self, phase: float) -> float:
        """Return the course offset from that of the centre at a phase, omega_0 times the time of
        ``offset`` [rad].
        """

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course) over the phase, for each n of
        ``orders`` [-].
        """


class Swing(Protocol):
    """The courses of a shape for every amplitude eta, of which a steered reference flies one after
    the other.

    A course is eta at phase 0, -eta half a period later, and the negative of itself half a period
    later everywhere.
    """

    def eta(self, speed_ratio: float) -> float:
        """Return the amplitude of a mean speed over speed, from -0.2 to 1 [rad]."""

    def speed_ratio(self, eta: float) -> float:
        """Return the mean speed over speed of an amplitude [-]."""

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 within a heading rate and the roll rate, no more than that at
        ``ETA_FREQUENCY`` [rad/s].
        """

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the slope of the course offset over eta, from -1 to 1, and that over the phase
        divided by eta [-].
        """

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return where the reference is from the orbit's centre, along the mean course and to its
        right [V_r/omega_0].
        """


class ReferenceShape(Protocol):
    """A kind of orbit. A shape is a frozen dataclass that is registered by a name in a file of its
    own.
    """

    @property
    def joining_share(self) -> float:
        """Part of its heading rate that a reference takes as long as it is not tracked [-].

        What the reference takes is not left to whoever has to catch up with it, and its commands
        are cut at omega_max.
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
        """Return the courses of this shape for a reference that is steered.

        Parameters
        ----------
        speed : V_r [m/s]
        heading_rate : largest that the reference may have [rad/s]
        roll_rate_max : of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : a reference of this shape cannot be steered
        """


def with_state_of(reference: Any, other: Copied, names: Iterable[str]) -> Copied:
    """Return another reference in the state of this one, of which these are the names: for copies
    that Python cannot make.
    """
    for name in names:
        setattr(other, name, getattr(reference, name))
    return other


REFERENCE_SHAPES: Registry[Callable[..., ReferenceShape]] = Registry(
    "reference_shape", folder="gnc.reference.shapes", methods=("design", "swing")
)
"""Reference shapes by name; calling one with its parameters makes it."""

reference_shape = REFERENCE_SHAPES.register
"""Decorator that registers a reference shape by a name."""
