"""What a reference is, and which shapes its orbit about the centre of oscillation can have."""

from collections.abc import Callable
from dataclasses import dataclass
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


class Orbit(Protocol):
    """A reference's periodic motion about the centre of oscillation, while that moves at nu V_r on a straight course."""

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

        ``time`` [s] counts from the passage through the centre at the largest course offset to the right, which is phase 0.
        """

    def half_widths(self) -> tuple[float, float]:
        """Return how far the orbit reaches from the centre, along its course and across [m]."""


class ReferenceShape(Protocol):
    """A kind of orbit. A shape is a frozen dataclass that is registered by a name in a file of its own."""

    def design(
        self, *, nu: float, speed: float, heading_rate_max: float, reserve: float, vessel_heading_rate: float, roll_rate_max: float
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

    def reference(
        self, orbit: Orbit, *, phase: float, centre_north: float, centre_east: float, vessel_course: float, time_step: float
    ) -> Reference:
        """Return a reference on an orbit of this shape.

        Parameters
        ----------
        orbit : as designed
        phase : at the start, omega_0 times the time of ``Orbit.offset`` [rad]
        centre_north, centre_east : centre of oscillation at the start [m]
        vessel_course : course of the centre [rad]
        time_step : [s]
        """


REFERENCE_SHAPES: Registry[Callable[..., ReferenceShape]] = Registry(
    "reference_shape", folder="gnc.reference", methods=("design", "reference")
)
"""Reference shapes by name; calling one with its parameters makes it."""

reference_shape = REFERENCE_SHAPES.register
"""Decorator that registers a reference shape by a name."""
