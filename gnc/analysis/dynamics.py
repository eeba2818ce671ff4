"""The tracking problem as four states, and the Lyapunov functions that prove its stability."""

import math

from gnc.laws.delta import (
    LookAhead,
    RelativeState,
    distance_squared,
    distance_squared_rate,
    relative_velocity,
)


def state_rates(
    parameters: LookAhead,
    state: RelativeState,
    speed: float,
    reference_heading_rate: float,
    heading_rate: float,
) -> RelativeState:
    """Return the rates of the four states: equation (21).

    Parameters
    ----------
    parameters, state : look-ahead and relative state
    speed : V_r [m/s]
    reference_heading_rate, heading_rate : omega_r and omega [rad/s]
    """
    rho_rate, omega_rho = relative_velocity(parameters, state, speed, speed, reference_heading_rate)
    delta_rate = parameters.epsilon * distance_squared_rate(state, speed, speed)
    return RelativeState(
        delta_rate, rho_rate, reference_heading_rate - omega_rho, heading_rate - omega_rho
    )


def equilibrium(parameters: LookAhead) -> RelativeState:
    """Return x_d = [R, R, 0, 0], on the reference."""
    return RelativeState(parameters.radius, parameters.radius, 0.0, 0.0)


def v_1(state: RelativeState) -> float:
    """Return V_1 = d^2/2 [m^2]: equation (22). Positive definite about the equilibrium, where (15)
    holds, and not about 0.
    """
    return 0.5 * distance_squared(state)


def v_1_rate(state: RelativeState, speed: float) -> float:
    """Return the rate of V_1 [m^2/s] along (21), whatever the control: equation (23)."""
    delta, rho, phi_r, phi = state
    return speed * (
        -rho * (1.0 - math.cos(phi_r))
        - delta * (1.0 - math.cos(phi_r - phi))
        + rho * (1.0 - math.cos(phi))
    )


def v_2(state: RelativeState, k_2: float) -> float:
    """Return V_2 = V_1 + k_2 (1 - cos phi) [m^2]: equation (25)."""
    return v_1(state) + k_2 * (1.0 - math.cos(state.phi))


def v_2_rate(state: RelativeState, speed: float) -> float:
    """Return the rate of V_2 [m^2/s] under law (24) with k_1 k_2 = 1: equation (26). Never
    positive.

    Any other product adds (1 - k_1 k_2) rho V_r (1 - cos phi), so V_2 never rises for larger ones
    either.
    """
    delta, rho, phi_r, phi = state
    return -speed * (rho * (1.0 - math.cos(phi_r)) + delta * (1.0 - math.cos(phi_r - phi)))


def v_2_acceleration(state: RelativeState, rates: RelativeState, speed: float) -> float:
    """Return the second rate of V_2 [m^2/s^2] under law (24): equation (27), bounded and so V_2's
    rate goes to zero.
    """
    delta, rho, phi_r, phi = state
    return -speed * (
        rates.rho * (1.0 - math.cos(phi_r))
        + rho * rates.phi_r * math.sin(phi_r)
        + (rates.phi_r - rates.phi) * delta * math.sin(phi_r - phi)
        + rates.delta * (1.0 - math.cos(phi_r - phi))
    )
