"""The tracking problem as a cascade: the course error dies out on its own and drives the geometry
(section IV.D).
"""

import math
from typing import NamedTuple

from gnc.analysis.dynamics import state_rates
from gnc.laws.cascade_equation import h
from gnc.laws.delta import LookAhead, RelativeState


class DrivenState(NamedTuple):
    """x_1 of equations (22) and (31a): the relative state (19) but for phi.

    Attributes
    ----------
    delta : length of the look-ahead vector [m]
    rho : length of z [m]
    phi_r : reference course against that of z [rad]
    """

    delta: float
    rho: float
    phi_r: float


def driven_rates(
    parameters: LookAhead,
    driven: DrivenState,
    phi: float,
    speed: float,
    reference_heading_rate: float,
) -> DrivenState:
    """Return the rates of the driven subsystem, whose input is phi: equation (31a), the first three
    lines of (21).

    Parameters
    ----------
    parameters, driven : look-ahead and driven state
    phi : vehicle course against that of z [rad]
    speed : V_r [m/s]
    reference_heading_rate : omega_r [rad/s]
    """
    # The heading rate enters the fourth line of (21) only.
    rates = state_rates(parameters, RelativeState(*driven, phi), speed, reference_heading_rate, 0.0)
    return DrivenState(rates.delta, rates.rho, rates.phi_r)


def driving_rate(phi: float, gain: float, rate_max: float) -> float:
    """Return the rate of phi [rad/s], the driving subsystem: equation (31b), (21) under law (30).
    Parameters as of ``h``.
    """
    return -h(phi, gain, rate_max)


def unforced_rates(
    parameters: LookAhead, driven: DrivenState, speed: float, reference_heading_rate: float
) -> DrivenState:
    """Return the rates of the driven subsystem at phi = 0, written out: equation (32).

    Differs from the paper because its first line lacks the factor V_r that (21) has, and without
    which it is no speed.

    Parameters
    ----------
    parameters, driven : look-ahead and driven state
    speed : V_r [m/s]
    reference_heading_rate : omega_r [rad/s]
    """
    delta, rho, phi_r = driven
    cos_r, sin_r = math.cos(phi_r), math.sin(phi_r)
    swing = delta * reference_heading_rate
    shrinking = 2.0 * parameters.epsilon * speed * (rho + delta) * (1.0 - cos_r)
    return DrivenState(
        -shrinking,
        -speed * (1.0 - cos_r) - swing * sin_r - cos_r * shrinking,
        reference_heading_rate - (speed * sin_r + swing * cos_r - sin_r * shrinking) / rho,
    )


def v_1_unforced_rate(driven: DrivenState, speed: float) -> float:
    """Return the rate of V_1 [m^2/s] along the unforced system (32): equation (33). Never positive."""
    return -speed * (driven.rho + driven.delta) * (1.0 - math.cos(driven.phi_r))


def v_1_unforced_acceleration(driven: DrivenState, rates: DrivenState, speed: float) -> float:
    """Return the second rate of V_1 [m^2/s^2] along (32): equation (34), bounded and so V_1's rate
    goes to zero.

    Parameters
    ----------
    driven, rates : driven state and its rates by (32)
    speed : V_r [m/s]
    """
    delta, rho, phi_r = driven
    return -speed * (
        (rates.rho + rates.delta) * (1.0 - math.cos(phi_r))
        + (rho + delta) * rates.phi_r * math.sin(phi_r)
    )


def v_1_rate_split(state: RelativeState, speed: float) -> float:
    """Return the rate of V_1 [m^2/s] along (21): equation (35), (23) gathered so that |phi| <=
    |phi_r| makes no term positive.
    """
    delta, rho, phi_r, phi = state
    return -speed * (
        rho * (math.cos(phi) - math.cos(phi_r)) + delta * (1.0 - math.cos(phi - phi_r))
    )


def excursion_time(phi: float, gain: float, rate_max: float) -> float:
    """Return the integral of 1 - cos(phi) over time [s] along (31b) from ``phi`` to rest.
    Parameters as of ``h``.

    Source: ``EQUATIONS.md``, "Why trajectories are bounded". Time is -dphi/h, so that h = gain phi
    leaves the entire cosine integral of the angle where h stops being held, and h = rate_max an
    elementary one of the angle above that.
    """
    size = abs(phi)
    free = min(size, rate_max / gain)
    # Fourteen terms are exact to rounding up to pi.
    entire_cosine = sum(
        (-1.0) ** (k + 1) * free ** (2 * k) / (2 * k * math.factorial(2 * k)) for k in range(1, 15)
    )
    return entire_cosine / gain + (size - free - math.sin(size) + math.sin(free)) / rate_max


def delta_bound(
    parameters: LookAhead, state: RelativeState, speed: float, gain: float, rate_max: float
) -> float:
    """Return what delta [m] cannot exceed under law (30), ever, and whatever the reference does: it
    bounds d through (15).

    Source: ``EQUATIONS.md``, "Why trajectories are bounded", from equation (35). Differs from the
    paper because its own argument, that d no longer rises from some time on, does not hold.
    Parameters as of ``driven_rates`` and ``h``.
    """
    rho_to_delta = 1.0 + 0.5 / math.sqrt(parameters.epsilon * parameters.radius)
    exponent = (
        2.0 * parameters.epsilon * speed * rho_to_delta * excursion_time(state.phi, gain, rate_max)
    )
    return state.delta * math.exp(exponent)
