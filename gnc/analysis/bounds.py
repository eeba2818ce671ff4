"""What the cascade law commands at most, over all states, and the fastest parameters that keep that
within a limit.

The abstract of the paper promises such conditions and its text omits them; docs/actuation_bounds.md
derives what is computed here.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.optimize import Bounds, minimize

from gnc.analysis.worst_position import worst_case_over_positions
from gnc.errors import InfeasibleError
from gnc.numeric import clip
from gnc.paper import LookAhead, look_ahead

_Array = npt.NDArray[np.float64]

_TOLERANCE = 1e-4
"""How far above the largest command the bound may lie, relative. Half of it is for rounding."""

_SIGMA_MAX = 1.0 - 1e-9
"""Above this, rounding, 1e-15/(1 - sigma) relative, is no longer small beside the tolerance."""

_SETTLED = 0.1
"""|phi| below which distance decays as if phi were 0 [rad]: cos(0.1) is 0.995."""


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundedSteering:
    """Parameters of the cascade law whose command is bounded.

    Attributes
    ----------
    look_ahead : epsilon and R
    gain : slope of h(phi) [1/s]
    steering_max : largest |h| [rad/s]
    bound : no command exceeds it, whatever the state [rad/s]
    convergence_time : estimated [s]
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
    """Return a heading rate [rad/s] that no command of the cascade law, equation (30), exceeds,
    whatever the state.

    Both signs of omega_r are covered, and so is the law evaluated at predicted states. The bound is
    the largest command itself, but for ``tolerance``, wherever h saturates well before phi is pi/2.

    Parameters
    ----------
    parameters : of the look-ahead
    speed : V, of vehicle and reference, or the larger of both [m/s]
    reference_heading_rate_max : largest |omega_r| [rad/s]
    steering_max : largest |h(phi)| [rad/s]
    tolerance : how far the bound on omega_rho may lie above its largest value [-]

    Raises
    ------
    InfeasibleError : a quantity is out of range, or R so close to 1/(4 epsilon) that the bound is
        worthless
    """
    _check_positive(
        speed=(speed, "m/s"),
        steering_max=(steering_max, "rad/s"),
        tolerance=(tolerance, "of the bound"),
    )
    _check_heading_rate(reference_heading_rate_max)
    sigma = _sigma(parameters)
    of_speed = speed / parameters.radius

    def omega_rho(speed_factor: _Array, turn_factor: _Array) -> _Array:
        return of_speed * speed_factor + reference_heading_rate_max * turn_factor

    return steering_max + worst_case_over_positions(omega_rho, sigma, tolerance)


def heading_rate_bound_least(
    parameters: LookAhead,
    *,
    speed: float,
    reference_heading_rate_max: float,
    gain: float,
    steering_max: float,
) -> float:
    """Return the largest command [rad/s] among states head on to the reference: no bound can be
    smaller. In closed form.

    There d points against the reference's course, phi is -pi/2 for omega_r > 0, and omega = (V +
    delta omega_r)/(delta - d) + h(pi/2), which is largest where lambda sigma u^2 + u = (1 + lambda)
    sigma: u = d sqrt(epsilon/R), lambda = omega_r R/V.

    Parameters
    ----------
    parameters, speed, reference_heading_rate_max, steering_max : as for ``heading_rate_bound``
    gain : slope of h(phi) [1/s]

    Raises
    ------
    InfeasibleError : a quantity is out of range
    """
    _check_positive(speed=(speed, "m/s"), gain=(gain, "1/s"), steering_max=(steering_max, "rad/s"))
    _check_heading_rate(reference_heading_rate_max)
    sigma = _sigma(parameters)
    ratio = reference_heading_rate_max * parameters.radius / speed
    u = (
        2.0
        * sigma
        * (1.0 + ratio)
        / (1.0 + math.sqrt(1.0 + 4.0 * sigma**2 * ratio * (1.0 + ratio)))
    )
    omega_rho = (
        speed
        / parameters.radius
        * (1.0 + ratio * (1.0 + u * u))
        / ((1.0 - u) ** 2 + 2.0 * (1.0 - sigma) * u)
    )
    return min(gain * 0.5 * math.pi, steering_max) + omega_rho


def convergence_time(
    parameters: LookAhead,
    *,
    speed: float,
    distance_from: float,
    distance_to: float,
    gain: float,
    steering_max: float,
) -> float:
    """Return the estimated time [s] in which the distance to the reference shrinks, from the worst
    course.

    First h brings phi from pi to 0.1 rad; how far the vehicle strays meanwhile is left out. Then
    d^2 shrinks by V d^2/delta, the average about a reference that circles faster than V/(2 R).
    Slower ones take longer: on a straight one, along-track errors stay.

    Parameters
    ----------
    parameters : of the look-ahead
    speed : V [m/s]
    distance_from, distance_to : [m]
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
    by_radius = 2.0 * parameters.radius * math.log(distance_from / distance_to)
    return turning + (by_radius + parameters.epsilon * (distance_from**2 - distance_to**2)) / speed


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
    """Return the parameters that converge fastest, by ``convergence_time``, while no command
    exceeds omega_max in any state.

    Sigma = 1/(2 sqrt(epsilon R)) and steering_max are chosen by the closed form for states head on
    to the reference, which costs 0.2 % of the time; the R that goes with them respects every state.
    It is kept at V/(2 omega_r) at least: a shorter one no longer speeds up convergence.

    Parameters
    ----------
    speed : V, of vehicle and reference [m/s]
    heading_rate_max : omega_max [rad/s]
    reference_heading_rate_max : largest |omega_r|, above 0 [rad/s]
    distance_from, distance_to : between which convergence counts [m]
    gain : slope of h(phi), as steep as the autopilot follows [1/s]

    Raises
    ------
    InfeasibleError : the reference leaves nothing of omega_max, a quantity is out of range, or the
        search did not converge
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
            f"reference heading rate is {reference_heading_rate_max:g} rad/s; it must stay below omega_max, {limit:g} rad/s but for"
            " tolerances, or no look-ahead bounds the command: lower it, to leave more of omega_max in reserve"
        )
    task = _Task(speed, limit, reference_heading_rate_max, distance_from, distance_to, gain)

    def time(parameters: LookAhead, steering_max: float) -> float:
        return convergence_time(
            parameters,
            speed=speed,
            distance_from=distance_from,
            distance_to=distance_to,
            gain=gain,
            steering_max=steering_max,
        )

    def objective(fractions: _Array) -> float:
        return math.log(time(*_design(fractions, task, _least_radius_head_on)))

    start = min((np.array([a, b]) for a in _FRACTIONS for b in _FRACTIONS), key=objective)
    found = minimize(objective, start, method="Nelder-Mead", bounds=Bounds(0.01, 0.99), tol=1e-4)
    if not found.success:
        raise InfeasibleError(
            f"the search for the fastest look-ahead did not converge: {found.message}; report these parameters"
        )
    parameters, steering_max = _design(found.x, task, _least_radius)
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


class _Task(NamedTuple):
    """The arguments of ``fastest_within``, in its units; ``limit`` is omega_max less tolerances."""

    speed: float
    limit: float
    reference_heading_rate_max: float
    distance_from: float
    distance_to: float
    gain: float


_LeastRadius = Callable[[float, float, float, float], float]
"""From sigma, V, omega_r and the limit of omega_rho to the least R."""

_FRACTIONS = np.linspace(0.05, 0.95, 19)


def _design(fractions: _Array, task: _Task, least_radius: _LeastRadius) -> tuple[LookAhead, float]:
    """Return look-ahead and steering_max for fractions, within 0 and 1, of the largest sigma and of
    the largest steering_max.
    """
    sigma_fraction, steering_fraction = fractions.tolist()
    turning = task.reference_heading_rate_max
    steering_max = steering_fraction * min(task.limit - turning, task.gain * math.pi)
    room = task.limit - steering_max
    sigma = sigma_fraction * min(1.0 - turning / room, _SIGMA_MAX)
    # With epsilon = 1/(4 sigma^2 R) the time has a minimum over R, this over sigma: a shorter R
    # would only raise epsilon.
    quickest = math.sqrt(
        (task.distance_from**2 - task.distance_to**2)
        / (8.0 * math.log(task.distance_from / task.distance_to))
    )
    radius = max(
        least_radius(sigma, task.speed, turning, room),
        quickest / sigma,
        task.speed / (2.0 * turning),
    )
    return look_ahead(1.0 / (4.0 * sigma**2 * radius), radius), steering_max


def _least_radius(
    sigma: float, speed: float, reference_heading_rate_max: float, room: float
) -> float:
    """Return an R [m] with which |omega_rho| stays within ``room`` [rad/s], the least but for the
    tolerance.
    """

    def radius(speed_factor: _Array, turn_factor: _Array) -> _Array:
        left = room - reference_heading_rate_max * turn_factor
        return np.divide(
            speed * speed_factor, left, out=np.full_like(left, np.inf), where=left > 0.0
        )

    return worst_case_over_positions(radius, sigma, _TOLERANCE)


def _least_radius_head_on(
    sigma: float, speed: float, reference_heading_rate_max: float, room: float
) -> float:
    """Return the least R [m] with which |omega_rho| stays within ``room`` [rad/s] head on to the
    reference. In closed form.
    """
    left = room - reference_heading_rate_max
    return speed * left / (left**2 - (sigma * room) ** 2)


def _sigma(parameters: LookAhead) -> float:
    """Return sigma = 1/(2 sqrt(epsilon R)), the largest ratio of distance to look-ahead [-]."""
    epsilon, radius = look_ahead(*parameters)
    sigma = 0.5 / math.sqrt(epsilon * radius)
    if not sigma < _SIGMA_MAX:
        raise InfeasibleError(
            f"look-ahead R is {radius:g} m, within rounding of 1/(4 epsilon) = {1.0 / (4.0 * epsilon):g} m, where commands have no"
            " bound: raise R or epsilon"
        )
    return sigma


def _check_positive(**quantities: tuple[float, str]) -> None:
    for name, (value, unit) in quantities.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InfeasibleError(f"{name} is {value:g} {unit}; it must be finite and above 0")


def _check_heading_rate(reference_heading_rate_max: float) -> None:
    if not (math.isfinite(reference_heading_rate_max) and reference_heading_rate_max >= 0.0):
        raise InfeasibleError(
            f"reference_heading_rate_max is {reference_heading_rate_max:g} rad/s; it must be finite and at least 0"
        )


def _check_distances(distance_from: float, distance_to: float) -> None:
    if not 0.0 < distance_to < distance_from < math.inf:
        raise InfeasibleError(
            f"distance_to is {distance_to:g} m and distance_from {distance_from:g} m; they must be finite, above 0 and the first"
            " the smaller: convergence goes from far to near"
        )
