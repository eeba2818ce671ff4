"""The Lyapunov-based law, equation (24)."""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.delta import RelativeState, bare_state, relative_velocity
from gnc.laws.delta_law import DeltaLaw
from gnc.laws.steering_law import steering_law
from gnc.reference.reference import Reference


def lyapunov_law(state: RelativeState, speed: float, omega_rho: float, k_1: float) -> float:
    """Return omega [rad/s] by the Lyapunov-based law, equation (24). Singular at phi = pi.

    Parameters
    ----------
    state : relative state
    speed : V_r [m/s]
    omega_rho : rate of the course of z [rad/s]
    k_1 : gain [1/m^2]; with k_2 = 1/k_1 the function V_2 never rises
    """
    return -k_1 * state.rho * speed * math.tan(0.5 * state.phi) + omega_rho


@steering_law("lyapunov")
@dataclass(frozen=True, slots=True, kw_only=True)
class LyapunovLaw(DeltaLaw):
    """The Lyapunov-based law on the relative state of the delta formulation. What it demands has no
    bound.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as of ``DeltaLaw``
    lyapunov_gain_per_m2 : k_1 [1/m^2]

    Raises
    ------
    ValueError : as of ``DeltaLaw``
    """

    given: ClassVar[str] = "the reference itself, and its turn rate"
    lyapunov_gain_per_m2: float = 0.001

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        state = bare_state(self._look_ahead, to_north, to_east, reference.course, course)
        _, omega_rho = relative_velocity(
            self._look_ahead, state, reference.speed, speed, reference.heading_rate
        )
        return lyapunov_law(RelativeState(*state), speed, omega_rho, self.lyapunov_gain_per_m2)
