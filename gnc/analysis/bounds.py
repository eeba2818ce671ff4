"""Bound on the commands of the cascade law, and the fastest law within a limit of commands.

The paper's abstract announces such conditions, but its text has none. The formulas are derived in
``docs/actuation_bounds.md``.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import Bounds, minimize

from gnc.errors import InfeasibleError
from gnc.numeric import clip
from gnc.paper import LookAhead, look_ahead

_Array = npt.NDArray[np.float64]

_TOLERANCE = 1e-4
"""Largest relative excess of the bound over the largest command [-]; half is for rounding."""

_SIGMA_MAX = 1.0 - 1e-9
"""Largest sigma [-]: above it the rounding error 1e-15/(1 - sigma) approaches the tolerance."""

_SETTLED = 0.1
"""|phi| below which the distance is taken to decay as with phi = 0 [rad]: cos(0.1) is 0.995."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundedSteering:
    """Parameters of the cascade law, with a bound on its command.

    Attributes
    ----------
    look_ahead : epsilon and R
    gain : slope of h(phi) [1/s]
    steering_max : largest |h| [rad/s]
    bound : bound on the command in every state [rad/s]
    convergence_time : estimated time of convergence [s]
    """

    look_ahead: LookAhead
    gain: float
    steering_max: float
    bound: float
    convergence_time: float


@functools.lru_cache(maxsize=64)
def heading_rate_bound(
    parameters: LookAhead,
    *,
    speed: float,
    reference_heading_rate_max: float,
    steering_max: float,
    tolerance: float = _TOLERANCE,
) -> float:
    """Return a bound on the command of the cascade law (30) in every state [rad/s].

    The bound holds for both signs of omega_r, and for the law at predicted states. If h saturates
    well below phi = pi/2, the bound equals the largest command within ``tolerance``.

    Parameters
    ----------
    parameters : of the look-ahead
    speed : V of vehicle and reference, or the larger one [m/s]
    reference_heading_rate_max : largest |omega_r| [rad/s]
    steering_max : largest |h(phi)| [rad/s]
    tolerance : largest relative excess of the bound on omega_rho [-]

    Raises
    ------
    InfeasibleError : a quantity is out of range, or R is too close to 1/(4 epsilon)
    """
    _check_positive(
        speed=(speed, "m/s"),
        steering_max=(steering_max, "rad/s"),
        tolerance=(tolerance, "of the bound"),
    )
    if not 0.0 <= reference_heading_rate_max < math.inf:
        raise InfeasibleError(
            f"reference_heading_rate_max is {reference_heading_rate_max:g} rad/s; it must be finite"
            " and at least 0"
        )
    sigma = _sigma(parameters)
    turn_at_reference = speed / parameters.radius

    def omega_rho(speed_factor: _Array, turn_factor: _Array) -> _Array:
        return turn_at_reference * speed_factor + reference_heading_rate_max * turn_factor

    return steering_max + worst_case_over_positions(omega_rho, sigma, tolerance)


def convergence_time(
    parameters: LookAhead,
    *,
    speed: float,
    distance_from: float,
    distance_to: float,
    gain: float,
    steering_max: float,
) -> float:
    """Return the estimated time of convergence between two distances, from the worst course [s].

    First h reduces phi from pi to 0.1 rad; the change of the distance meanwhile is neglected. Then
    d^2 decays at the rate V d^2/delta, the average for a reference that circles faster than V/(2
    R). With a slower reference convergence takes longer: along-track errors to a straight reference
    do not decay.

    Parameters
    ----------
    parameters : of the look-ahead
    speed : V [m/s]
    distance_from, distance_to : distances between which the time is estimated [m]
    gain : slope of h(phi) [1/s]
    steering_max : largest |h(phi)| [rad/s]

    Raises
    ------
    InfeasibleError : a quantity is out of range
    """
    _check_positive(speed=(speed, "m/s"), gain=(gain, "1/s"), steering_max=(steering_max, "rad/s"))
    _check_distances(distance_from, distance_to)
    linear_below = clip(steering_max / gain, _SETTLED, math.pi)
    turning = (math.pi - linear_below) / steering_max + math.log(linear_below / _SETTLED) / gain
    near = 2.0 * parameters.radius * math.log(distance_from / distance_to)
    far = parameters.epsilon * (distance_from**2 - distance_to**2)
    return turning + (near + far) / speed


@functools.lru_cache(maxsize=64)
def fastest_within(
    *,
    speed: float,
    heading_rate_max: float,
    reference_heading_rate_max: float,
    distance_from: float,
    distance_to: float,
    gain: float,
) -> BoundedSteering:
    """Return the parameters with the fastest convergence and no command above omega_max.

    ``convergence_time`` is minimised over sigma = 1/(2 sqrt(epsilon R)) and steering_max. The
    search uses the closed form of R for states head on to the reference, which makes the time
    longer by 0.2 %; the final R takes every state into account. R is at least V/(2 omega_r),
    because a shorter R does not converge faster.

    Parameters
    ----------
    speed : V of vehicle and reference [m/s]
    heading_rate_max : omega_max [rad/s]
    reference_heading_rate_max : largest |omega_r|, above 0 [rad/s]
    distance_from, distance_to : distances between which the time is minimised [m]
    gain : slope of h(phi), the steepest that the autopilot follows [1/s]

    Raises
    ------
    InfeasibleError : omega_r leaves nothing of omega_max, a quantity is out of range, or the search
        did not converge
    """
    _check_positive(
        speed=(speed, "m/s"),
        gain=(gain, "1/s"),
        heading_rate_max=(heading_rate_max, "rad/s"),
        reference_heading_rate_max=(reference_heading_rate_max, "rad/s"),
    )
    _check_distances(distance_from, distance_to)
    limit = heading_rate_max / (1.0 + 2.0 * _TOLERANCE)
    if not reference_heading_rate_max < limit:
        raise InfeasibleError(
            f"reference heading rate is {reference_heading_rate_max:g} rad/s; it must stay below"
            f" omega_max, about {limit:g} rad/s, or no look-ahead bounds the command:"
            " lower it, to leave more of omega_max in reserve"
        )
    turning = reference_heading_rate_max
    # With epsilon = 1/(4 sigma^2 R) the time has its minimum at R = quickest/sigma: a shorter R
    # would only increase epsilon.
    quickest = math.sqrt(
        (distance_from**2 - distance_to**2) / (8.0 * math.log(distance_from / distance_to))
    )

    def time(parameters: LookAhead, steering_max: float) -> float:
        return convergence_time(
            parameters,
            speed=speed,
            distance_from=distance_from,
            distance_to=distance_to,
            gain=gain,
            steering_max=steering_max,
        )

    def design(fractions: _Array, least_radius: _LeastRadius) -> tuple[LookAhead, float]:
        """Return look-ahead and steering_max from fractions of their largest values."""
        sigma_fraction, steering_fraction = fractions.tolist()
        steering_max = steering_fraction * min(limit - turning, gain * math.pi)
        room = limit - steering_max
        sigma = sigma_fraction * min(1.0 - turning / room, _SIGMA_MAX)
        radius = max(
            least_radius(sigma, speed, turning, room), quickest / sigma, speed / (2.0 * turning)
        )
        return look_ahead(1.0 / (4.0 * sigma**2 * radius), radius), steering_max

    def objective(fractions: _Array) -> float:
        return math.log(time(*design(fractions, _least_radius_head_on)))

    start = min((np.array([a, b]) for a in _FRACTIONS for b in _FRACTIONS), key=objective)
    found = minimize(objective, start, method="Nelder-Mead", bounds=Bounds(0.01, 0.99), tol=1e-4)
    if not found.success:
        raise InfeasibleError(
            f"the search for the fastest look-ahead did not converge: {found.message}; report these"
            " parameters"
        )
    parameters, steering_max = design(found.x, _least_radius)
    return BoundedSteering(
        look_ahead=parameters,
        gain=gain,
        steering_max=steering_max,
        bound=heading_rate_bound(
            parameters,
            speed=speed,
            reference_heading_rate_max=reference_heading_rate_max,
            steering_max=steering_max,
        ),
        convergence_time=time(parameters, steering_max),
    )


_FRACTIONS = np.linspace(0.05, 0.95, 19)
"""Grid of possible start points, as fractions of the largest sigma and steering_max [-]."""

_LeastRadius = Callable[[float, float, float, float], float]
"""Function from sigma, V, omega_r and the limit of omega_rho to the least R."""


def _least_radius(
    sigma: float, speed: float, reference_heading_rate_max: float, room: float
) -> float:
    """Return the least R that keeps |omega_rho| within ``room`` [rad/s] in every state [m]."""

    def radius(speed_factor: _Array, turn_factor: _Array) -> _Array:
        left = room - reference_heading_rate_max * turn_factor
        return np.divide(
            speed * speed_factor, left, out=np.full_like(left, np.inf), where=left > 0.0
        )

    return worst_case_over_positions(radius, sigma, _TOLERANCE)


def _least_radius_head_on(
    sigma: float, speed: float, reference_heading_rate_max: float, room: float
) -> float:
    """Return the least R that keeps |omega_rho| within ``room`` [rad/s] in states head on [m]."""
    left = room - reference_heading_rate_max
    return speed * left / (left**2 - (sigma * room) ** 2)


# ---------------------------------------------------------------- The worst position

_CELLS = 24
"""Number of cells per side of the initial grid."""


def worst_case_over_positions(
    value: Callable[[_Array, _Array], _Array], sigma: float, tolerance: float
) -> float:
    """Return an upper bound of a value over all positions, at most ``tolerance`` too high.

    Branch and bound: cells are quartered until no cell can hold a value above the largest value
    found at the centre of a cell, within the tolerance. The search ends because the bounds of
    ``factors_at_most`` converge to ``factors`` as cells shrink.

    Parameters
    ----------
    value : function of the two ``factors`` that increases in both
    sigma : largest d/delta, below 1 [-]
    tolerance : relative tolerance [-]
    """
    edges = np.linspace(0.0, math.pi, _CELLS + 1)
    low, high = (
        np.stack(np.meshgrid(ends, ends)).reshape(2, -1) for ends in (edges[:-1], edges[1:])
    )
    largest = 0.0
    while low.size:
        middle = 0.5 * (low + high)
        largest = max(largest, float(np.max(value(*factors(sigma, *middle)))))
        may_hold = value(*factors_at_most(sigma, low, high)) > largest * (1.0 + 0.5 * tolerance)
        low = low[:, may_hold]
        middle = middle[:, may_hold]
        high = high[:, may_hold]
        corners = (
            [(low[0], middle[0]), (middle[0], high[0])],
            [(low[1], middle[1]), (middle[1], high[1])],
        )
        quarters = [(*across, *along) for across in corners[0] for along in corners[1]]
        low = np.concatenate([np.stack([quarter[0], quarter[2]]) for quarter in quarters], axis=1)
        high = np.concatenate([np.stack([quarter[1], quarter[3]]) for quarter in quarters], axis=1)
    return largest * (1.0 + tolerance)


def factors(sigma: float, alpha: _Array, beta: _Array) -> tuple[_Array, _Array]:
    """Return the factors of V/R and of omega_r in the largest |omega_rho| at a position.

    |omega_rho| is the largest over all courses. The factors are (R/rho)(|w_x| + |w|) and
    (delta/rho) cos(phi_r) of ``docs/actuation_bounds.md``.

    Parameters
    ----------
    sigma : 1/(2 sqrt(epsilon R)), the largest d/delta, below 1 [-]
    alpha : 2 atan(d sqrt(epsilon/R)), so that d/delta = sigma sin(alpha), from 0 to pi [rad]
    beta : angle between -d and the reference's course, from 0 to pi [rad]
    """
    sin_a, cos_a, sin_b = np.sin(alpha), np.cos(alpha), np.sin(beta)
    x, k = sigma * sin_a, 1.0 - np.cos(beta)
    rho_squared = (1.0 - x) ** 2 + 2.0 * x * k
    across = np.sqrt(np.maximum(rho_squared - (sin_a * sin_b) ** 2, 0.0))
    along = sin_a * sin_b * np.abs(sigma * (1.0 + cos_a) + sin_a * (k - 1.0))
    return 0.5 * (along + (1.0 + cos_a) * across) / rho_squared, (1.0 - x + x * k) / rho_squared


def factors_at_most(sigma: float, low: _Array, high: _Array) -> tuple[_Array, _Array]:
    """Return upper bounds of both ``factors`` over cells, with each term at its worst in the cell.

    Parameters
    ----------
    sigma : same as ``factors``
    low, high : alpha and beta at the corners of the cells, shape (2, n) [rad]
    """
    a_1, b_1 = low
    a_2, b_2 = high
    s_1, s_2 = _sine_range(a_1, a_2)
    sin_b_1, sin_b_2 = _sine_range(b_1, b_2)
    c_1, c_2 = 1.0 + np.cos(a_2), 1.0 + np.cos(a_1)
    k_1, k_2 = 1.0 - np.cos(b_1), 1.0 - np.cos(b_2)
    x_1, x_2 = sigma * s_1, sigma * s_2
    # (1 - x)^2 + 2 x k increases with k and is a parabola in x with the vertex 1 - k.
    nearest = np.clip(1.0 - k_1, x_1, x_2)
    rho_squared_1 = (1.0 - nearest) ** 2 + 2.0 * nearest * k_1
    rho_squared_2 = np.maximum(
        (1.0 - x_1) ** 2 + 2.0 * x_1 * k_2, (1.0 - x_2) ** 2 + 2.0 * x_2 * k_2
    )
    # With y = 1/rho^2, sqrt(rho^2 - p)/rho^2 is the square root of y - p y^2, a parabola with the
    # vertex 1/(2 p).
    p = (s_1 * sin_b_1) ** 2
    y = np.clip(1.0 / np.maximum(2.0 * p, 1e-300), 1.0 / rho_squared_2, 1.0 / rho_squared_1)
    across = np.sqrt(np.maximum(y - p * y * y, 0.0))
    along = np.maximum(
        sigma * c_2 + np.maximum(s_1 * (k_2 - 1.0), s_2 * (k_2 - 1.0)),
        -sigma * c_1 - np.minimum(s_1 * (k_1 - 1.0), s_2 * (k_1 - 1.0)),
    )
    speed_factor = 0.5 * (s_2 * sin_b_2 * along / rho_squared_1 + c_2 * across)
    return speed_factor, (1.0 + np.maximum(x_1 * (k_2 - 1.0), x_2 * (k_2 - 1.0))) / rho_squared_1


def _sine_range(low: _Array, high: _Array) -> tuple[_Array, _Array]:
    """Return the least and the largest sine over angles within 0 and pi."""
    at_low, at_high = np.sin(low), np.sin(high)
    holds_crest = (low <= 0.5 * math.pi) & (high >= 0.5 * math.pi)
    return np.minimum(at_low, at_high), np.where(holds_crest, 1.0, np.maximum(at_low, at_high))


# ---------------------------------------------------------------- Checks


def _sigma(parameters: LookAhead) -> float:
    """Return sigma = 1/(2 sqrt(epsilon R)), the largest ratio of distance to look-ahead [-]."""
    epsilon, radius = look_ahead(*parameters)
    sigma = 0.5 / math.sqrt(epsilon * radius)
    if not sigma < _SIGMA_MAX:
        raise InfeasibleError(
            f"look-ahead R is {radius:g} m, within rounding of 1/(4 epsilon) ="
            f" {1.0 / (4.0 * epsilon):g} m, where commands have no bound: raise R or epsilon"
        )
    return sigma


def _check_positive(**quantities: tuple[float, str]) -> None:
    for name, (value, unit) in quantities.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InfeasibleError(f"{name} is {value:g} {unit}; it must be finite and above 0")


def _check_distances(distance_from: float, distance_to: float) -> None:
    if not 0.0 < distance_to < distance_from < math.inf:
        raise InfeasibleError(
            f"distance_to is {distance_to:g} m and distance_from {distance_from:g} m; they must be"
            " finite, above 0 and the first the smaller: convergence goes from far to near"
        )
