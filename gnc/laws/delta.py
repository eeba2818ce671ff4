"""The delta formulation: a look-ahead that grows with distance and takes the singularity out of
line-of-sight tracking.
"""

import math
from typing import NamedTuple

from gnc.errors import InfeasibleError
from gnc.numeric import wrap


class RelativeState(NamedTuple):
    """The four states of equation (19).

    Attributes
    ----------
    delta : length of the look-ahead vector [m]
    rho : length of z, from the vehicle to the end of the look-ahead vector [m]
    phi_r : reference course against that of z [rad]
    phi : vehicle course against that of z [rad]
    """

    delta: float
    rho: float
    phi_r: float
    phi: float


class LookAhead(NamedTuple):
    """Parameters of the look-ahead, delta = epsilon d^2 + R: equation (15).

    Attributes
    ----------
    epsilon : [1/m]
    radius : R [m], above 1/(4 epsilon)
    """

    epsilon: float
    radius: float


def look_ahead(epsilon: float, radius: float) -> LookAhead:
    """Return checked parameters.

    Raises
    ------
    InfeasibleError : R <= 1/(4 epsilon), where delta may be shorter than d and z may vanish
    """
    if not (math.isfinite(epsilon) and epsilon > 0.0):
        raise InfeasibleError(
            f"look-ahead epsilon is {epsilon:g} 1/m; it must be finite and above 0"
        )
    if not (math.isfinite(radius) and radius > 1.0 / (4.0 * epsilon)):
        raise InfeasibleError(
            f"look-ahead R is {radius:g} m; it must exceed 1/(4 epsilon) = {1.0 / (4.0 * epsilon):g} m: raise R or epsilon"
        )
    return LookAhead(epsilon, radius)


def delta_length(parameters: LookAhead, distance_squared: float) -> float:
    """Return delta [m] for a squared distance d^2 [m^2]: equation (15)."""
    return parameters.epsilon * distance_squared + parameters.radius


def relative_state(
    parameters: LookAhead,
    to_reference_north: float,
    to_reference_east: float,
    reference_course: float,
    course: float,
) -> RelativeState:
    """Return the relative state: equations (14), (16) and (19).

    Parameters
    ----------
    parameters : of the look-ahead
    to_reference_north, to_reference_east : d, from the vehicle to the reference [m]
    reference_course, course : chi_r and chi [rad]
    """
    return RelativeState(
        *bare_state(parameters, to_reference_north, to_reference_east, reference_course, course)
    )


def bare_state(
    parameters: LookAhead,
    to_reference_north: float,
    to_reference_east: float,
    reference_course: float,
    course: float,
) -> tuple[float, float, float, float]:
    """Return delta, rho, phi_r and phi, the relative state without names: equations (14), (15),
    (16) and (19).

    Parameters are those of ``relative_state``. The guidance asks at every step, and the names cost
    as much as the numbers.
    """
    epsilon, radius = parameters
    delta = (
        epsilon * (to_reference_north * to_reference_north + to_reference_east * to_reference_east)
        + radius
    )
    z_north = to_reference_north + delta * math.cos(reference_course)
    z_east = to_reference_east + delta * math.sin(reference_course)
    z_course = math.atan2(z_east, z_north)
    return (
        delta,
        math.hypot(z_north, z_east),
        wrap(reference_course - z_course),
        wrap(course - z_course),
    )


def distance_squared(state: RelativeState) -> float:
    """Return d^2 [m^2] from the relative state, by the law of cosines."""
    return state.rho**2 + state.delta**2 - 2.0 * state.rho * state.delta * math.cos(state.phi_r)


def distance_squared_rate(state: RelativeState, reference_speed: float, speed: float) -> float:
    """Return the rate of d^2 [m^2/s]: equation (20), which is this with both speeds V_r.

    Differs from the paper because a real aircraft's speed is V_r only on average: d . d-dot = d .
    (v_r - v), resolved along z.
    """
    delta, rho, phi_r, phi = state
    cos_r, sin_r = math.cos(phi_r), math.sin(phi_r)
    along = reference_speed * cos_r - speed * math.cos(phi)
    across = reference_speed * sin_r - speed * math.sin(phi)
    return 2.0 * ((rho - delta * cos_r) * along - delta * sin_r * across)


def relative_velocity(
    parameters: LookAhead,
    state: tuple[float, float, float, float],
    reference_speed: float,
    speed: float,
    reference_heading_rate: float,
) -> tuple[float, float]:
    """Return the rates of rho [m/s] and of the course of z, omega_rho [rad/s]: equations (17) and
    (18).

    Parameters
    ----------
    parameters : of the look-ahead
    state : the relative state, delta, rho [m], phi_r and phi [rad]
    reference_speed, speed : V_r for both in the paper [m/s]
    reference_heading_rate : omega_r [rad/s]
    """
    delta, rho, phi_r, phi = state
    cos_r, sin_r = math.cos(phi_r), math.sin(phi_r)
    along = reference_speed * cos_r - speed * math.cos(phi)
    across = reference_speed * sin_r - speed * math.sin(phi)
    # Equation (20) once more: calling distance_squared_rate would take every sine and cosine twice,
    # at each step of the guidance.
    delta_rate = parameters.epsilon * (
        2.0 * ((rho - delta * cos_r) * along - delta * sin_r * across)
    )
    swing = delta * reference_heading_rate
    return along - swing * sin_r + delta_rate * cos_r, (
        across + swing * cos_r + delta_rate * sin_r
    ) / rho
