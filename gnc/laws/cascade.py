"""Steering laws: what heading rate to command."""

import math

from gnc.analysis.cascade_system import h
from gnc.angles import wrap
from gnc.laws.delta import RelativeState


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


def cascade_law(phi: float, omega_rho: float, gain: float, rate_max: float) -> float:
    """Return omega [rad/s] by the cascade law, equation (30), with h = gain phi within ``rate_max``.

    Parameters
    ----------
    phi : vehicle course against that of z [rad], within -pi and pi
    omega_rho : rate of the course of z [rad/s]
    gain : [1/s], above 0
    rate_max : largest |h| [rad/s], above 0: what h may take of omega_max
    """
    return -h(phi, gain, rate_max) + omega_rho


def line_of_sight_law(to_reference_north: float, to_reference_east: float, course: float, gain: float) -> float:
    """Return omega [rad/s] that turns the course to the line of sight, proportionally: the baseline of the paper's Sim. 2.

    Undefined on the reference itself, where it commands nothing; close by, the line of sight and so the command turn arbitrarily
    fast.
    """
    if to_reference_north == 0.0 and to_reference_east == 0.0:
        return 0.0
    return gain * wrap(math.atan2(to_reference_east, to_reference_north) - course)
