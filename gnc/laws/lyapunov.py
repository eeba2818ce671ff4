"""The Lyapunov-based law, equation (24)."""

import math
from dataclasses import dataclass, field

from gnc.laws.delta import LookAhead, RelativeState, bare_state, look_ahead, relative_velocity
from gnc.laws.steering_law import check_parameters, steering_law
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
class LyapunovLaw:
    """The Lyapunov-based law on the relative state of the delta formulation. What it demands has no bound.

    Attributes
    ----------
    epsilon_per_m : growth of the look-ahead with the squared distance [1/m]
    look_ahead_m : look-ahead on the reference, R [m], above 1/(4 epsilon)
    lyapunov_gain_per_m2 : k_1 [1/m^2]

    Raises
    ------
    ValueError : a parameter is not finite and above 0, or R is too short
    """

    epsilon_per_m: float = 0.005
    look_ahead_m: float = 60.0
    lyapunov_gain_per_m2: float = 0.001
    _look_ahead: LookAhead = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_parameters(self)
        object.__setattr__(self, "_look_ahead", look_ahead(self.epsilon_per_m, self.look_ahead_m))

    def heading_rate(self, reference: Reference, to_north: float, to_east: float, course: float, speed: float) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        state = bare_state(self._look_ahead, to_north, to_east, reference.course, course)
        _, omega_rho = relative_velocity(self._look_ahead, state, reference.speed, speed, reference.heading_rate)
        return lyapunov_law(RelativeState(*state), speed, omega_rho, self.lyapunov_gain_per_m2)
