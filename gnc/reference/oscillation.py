"""How fast the reference may oscillate."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.special import jv

from common.physics.units import STANDARD_GRAVITY
from gnc.errors import InfeasibleError
from gnc.reference.bessel import eta_for_speed_ratio
from gnc.reference.orbit import half_widths, offset
from gnc.reference.reference import Array


@dataclass(frozen=True, slots=True, kw_only=True)
class Oscillation:
    """The paper's orbit: the reference's course oscillates about the vessel's as a sinusoid.

    Attributes
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    eta : course amplitude [rad]
    omega_0 : frequency [rad/s]
    limit : what set the frequency, ``heading rate`` or ``roll rate``
    """

    nu: float
    speed: float
    eta: float
    omega_0: float
    limit: str

    @property
    def amplitude(self) -> float:
        """A, the amplitude of the reference's heading rate [rad/s]."""
        return self.eta * self.omega_0

    @property
    def symmetric(self) -> bool:
        """Return that the second half of the orbit is the mirror image of the first."""
        return True

    @property
    def period(self) -> float:
        """T = 2 pi/omega_0 [s]."""
        return 2.0 * math.pi / self.omega_0

    @property
    def crossing_interval(self) -> float:
        """Time between crossings of the centre of oscillation, half a period [s]."""
        return math.pi / self.omega_0

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return where the reference is from the centre of oscillation, by
        ``gnc.reference.orbit.offset`` [m].
        """
        return offset(self, time)

    def half_widths(self) -> tuple[float, float]:
        """Return the orbit's half-widths along and across the vessel's course, by
        ``gnc.reference.orbit.half_widths`` [m].
        """
        return half_widths(self)

    def course(self, phase: float) -> float:
        """Return the course offset from the vessel's, eta cos(theta) [rad]: equation (3)."""
        return self.eta * math.cos(phase)

    def heading_rate(self, phase: float) -> float:
        """Return omega_r = -A sin(theta) [rad/s]: equation (2)."""
        return -self.amplitude * math.sin(phase)

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return J_n(eta)^2, by the Jacobi-Anger expansion [-]."""
        return np.asarray(jv(orders, self.eta) ** 2)


def design_oscillation(
    *,
    nu: float,
    speed: float,
    heading_rate_max: float,
    reserve: float = 0.0,
    vessel_heading_rate: float = 0.0,
    roll_rate_max: float = math.inf,
) -> Oscillation:
    """Return the fastest oscillation that the vehicle can follow.

    Equation (8) bounds omega_0 by the heading rate: eta omega_0 <= (1 - reserve) omega_max -
    |omega_V|. As nu approaches 1, eta approaches 0 and that bound grows without limit, so omega_0 also respects the roll rate: near level flight g/V times the roll
    rate is the heading acceleration, whose amplitude is eta omega_0^2.

    Parameters and errors are those of ``available_heading_rate``.
    """
    available = available_heading_rate(
        nu=nu,
        speed=speed,
        heading_rate_max=heading_rate_max,
        reserve=reserve,
        vessel_heading_rate=vessel_heading_rate,
        roll_rate_max=roll_rate_max,
    )
    eta = eta_for_speed_ratio(nu)
    by_heading_rate = available / eta
    by_roll_rate = math.sqrt(STANDARD_GRAVITY * roll_rate_max / (speed * eta))
    limit = "heading rate" if by_heading_rate <= by_roll_rate else "roll rate"
    return Oscillation(
        nu=nu, speed=speed, eta=eta, omega_0=min(by_heading_rate, by_roll_rate), limit=limit
    )


def available_heading_rate(
    *,
    nu: float,
    speed: float,
    heading_rate_max: float,
    reserve: float,
    vessel_heading_rate: float,
    roll_rate_max: float,
) -> float:
    """Return what an oscillation may take of the heading rate, (1 - reserve) omega_max - |omega_V|
    [rad/s]: equation (8).

    Parameters
    ----------
    nu : speed ratio [-]
    speed : V_r [m/s]
    heading_rate_max : omega_max [rad/s]
    reserve : fraction of omega_max that the reference leaves to feedback, 0 for the paper's bound
    vessel_heading_rate : omega_V [rad/s]
    roll_rate_max : [rad/s]

    Raises
    ------
    InfeasibleError : nu below 0, or of 1 or more, a limit that is not above 0, or nothing left of
        omega_max
    """
    for name, value, unit in (
        ("speed", speed, "m/s"),
        ("heading_rate_max", heading_rate_max, "rad/s"),
        ("roll_rate_max", roll_rate_max, "rad/s"),
    ):
        if not value > 0.0:
            raise InfeasibleError(
                f"{name} is {value:g} {unit}; it must be above 0: give what the vehicle can fly"
            )
    if not 0.0 <= reserve < 1.0:
        raise InfeasibleError(
            f"reserve is {reserve:g} of omega_max; it must be at least 0 and below 1: a tenth is plenty"
        )
    if nu >= 1.0:
        raise InfeasibleError(
            f"speed ratio nu is {nu:g}; it must be below 1: at 1 the reference flies straight and never crosses the plume,"
            " above 1 the vessel outruns the UAV; fly faster"
        )
    if not nu >= 0.0:
        raise InfeasibleError(
            f"speed ratio nu is {nu:g}; it must lie within 0 and 1: give the vessel a speed up to that of the UAV"
        )
    available = (1.0 - reserve) * heading_rate_max - abs(vessel_heading_rate)
    if not available > 0.0:
        raise InfeasibleError(
            f"vessel heading rate is {vessel_heading_rate:g} rad/s; with a reserve of {reserve:g} it must stay below"
            f" {(1.0 - reserve) * heading_rate_max:g} rad/s: raise omega_max or lower the reserve"
        )
    return available
