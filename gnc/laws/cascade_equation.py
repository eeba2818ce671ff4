"""Equation (30) for the delta formulation, in numbers alone: they can be compiled."""

from gnc.laws.delta import LookAhead, bare_state, relative_velocity
from gnc.numeric import limited


def h(phi: float, gain: float, rate_max: float) -> float:
    """Return h(phi) [rad/s] of equation (30): gain phi, kept within ``rate_max``. It is 0 at 0 and
    has the sign of phi elsewhere.

    Parameters
    ----------
    phi : vehicle course against that of z [rad], within -pi and pi
    gain : [1/s], above 0
    rate_max : largest |h| [rad/s], above 0
    """
    return limited(gain * phi, rate_max)


def cascade_law(phi: float, omega_rho: float, gain: float, rate_max: float) -> float:
    """Return omega [rad/s] by the cascade law, equation (30), with h = gain phi within
    ``rate_max``.

    Parameters
    ----------
    phi : vehicle course against that of z [rad], within -pi and pi
    omega_rho : rate of the course of z [rad/s]
    gain : [1/s], above 0
    rate_max : largest |h| [rad/s], above 0: what h may take of omega_max
    """
    return -h(phi, gain, rate_max) + omega_rho


def cascade_heading_rate(
    look_ahead: LookAhead,
    to_north: float,
    to_east: float,
    course: float,
    speed: float,
    reference_course: float,
    reference_speed: float,
    reference_heading_rate: float,
    gain: float,
    rate_max: float,
) -> float:
    """Return omega [rad/s] by the cascade law on the relative state.

    Parameters
    ----------
    look_ahead : its parameters
    to_north, to_east : from the vehicle to the reference [m]
    course, speed : of the vehicle [rad, m/s]
    reference_course, reference_speed, reference_heading_rate : [rad, m/s, rad/s]
    gain, rate_max : as of ``cascade_law``
    """
    state = bare_state(look_ahead, to_north, to_east, reference_course, course)
    _, omega_rho = relative_velocity(
        look_ahead, state, reference_speed, speed, reference_heading_rate
    )
    return cascade_law(state[3], omega_rho, gain, rate_max)
