"""The paper's shape: the reference's course is a sinusoid."""

import functools
import math
from dataclasses import dataclass

import numpy as np
from scipy.special import j0, jv

from common.physics.units import STANDARD_GRAVITY
from gnc.paper import Oscillation, design_oscillation
from gnc.reference.orbit_tables import ETA_STEP, OrbitTables
from gnc.reference.reference import ETA_FREQUENCY, Swing, reference_shape

_ORDERS = 4
"""Pairs of Bessel functions in the series of the orbit; what is left out is below 1e-4 of its width
at the largest eta.
"""

_ETA_MAX = 2.9
"""Largest amplitude in the tables [rad]: J_0(2.9) = -0.224 is beyond the least ratio."""


@dataclass(frozen=True, slots=True)
class SinusoidSwing:
    """Courses eta cos(theta), as of ``gnc.reference.reference.Swing``.

    Differs from ``gnc.paper`` in that eta comes from a table, because a steered reference needs it
    often, and may have to back away: ratios down to -0.2 are those of eta beyond the first zero of
    J_0.

    Attributes
    ----------
    heading_rate : largest [rad/s]
    acceleration : largest rate of the heading rate, g/V_r times the roll rate [rad/s^2]
    """

    heading_rate: float
    acceleration: float

    def eta(self, speed_ratio: float) -> float:
        """Return eta [rad] for a mean speed over speed, by a table of J_0: equation (6), within
        1e-5.
        """
        return _tables().eta(speed_ratio)

    def speed_ratio(self, eta: float) -> float:
        """Return the mean speed over the speed, J_0(eta) [-]: equation (5)."""
        # The power series of J_0 in (eta/2)^2, whose k-th term is -x/k^2 of the one before: good to
        # 5e-7 up to eta = 2.4.
        x = 0.25 * eta * eta
        return 1.0 - x * (
            1.0 - x / 4.0 * (1.0 - x / 9.0 * (1.0 - x / 16.0 * (1.0 - x / 25.0 * (1.0 - x / 36.0))))
        )

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return omega_0 by the heading rate that is left and by the roll rate, as ``gnc.paper``
        does [rad/s].
        """
        eta = eta if eta > ETA_FREQUENCY else ETA_FREQUENCY
        by_heading_rate = (
            heading_rate if heading_rate < self.heading_rate else self.heading_rate
        ) / eta
        by_roll_rate = math.sqrt(self.acceleration / eta)
        return by_heading_rate if by_heading_rate < by_roll_rate else by_roll_rate

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset eta cos(theta) [rad]."""
        return eta * math.cos(phase)

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:  # noqa: ARG002 - of the Protocol
        """Return the slope of the course over eta, and that over theta per eta [-]."""
        return math.cos(phase), -math.sin(phase)

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return where the reference is from the orbit's centre, by the series of
        ``gnc.paper.offset`` [V_r/omega_0].
        """
        return _tables().offset(eta, phase)


@reference_shape("sinusoid")
@dataclass(frozen=True, slots=True)
class Sinusoid:
    """The paper's reference: its course oscillates about the vessel's as a sinusoid."""

    @property
    def joining_share(self) -> float:
        """Return all of the heading rate: it is taken at the peaks alone [-]."""
        return 1.0

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> Oscillation:
        """Return the fastest oscillation that the vehicle can follow; parameters are those of
        ``ReferenceShape``.
        """
        return design_oscillation(
            nu=nu,
            speed=speed,
            heading_rate_max=heading_rate_max,
            reserve=reserve,
            vessel_heading_rate=vessel_heading_rate,
            roll_rate_max=roll_rate_max,
        )

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the sinusoids of every amplitude; parameters are those of ``ReferenceShape``."""
        return SinusoidSwing(heading_rate, STANDARD_GRAVITY * roll_rate_max / speed)


@functools.lru_cache(maxsize=1)
def _tables() -> OrbitTables:
    etas = np.arange(0.0, _ETA_MAX + ETA_STEP, ETA_STEP)
    columns = []
    for k in range(1, _ORDERS + 1):
        columns.append(2.0 * (-1.0) ** (k - 1) * jv(2 * k - 1, etas) / (2 * k - 1))
        columns.append((-1.0) ** k * jv(2 * k, etas) / k)
    return OrbitTables(j0(etas), np.stack(columns, axis=-1))
