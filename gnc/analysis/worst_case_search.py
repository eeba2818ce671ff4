"""Search for the largest command of the cascade law, for comparison with the bound."""

import math

import numpy as np
import numpy.typing as npt
from scipy.optimize import minimize

from gnc.paper import LookAhead

_Array = npt.NDArray[np.float64]

_REFINED = 4
"""Number of largest samples that are refined."""

_GATHERED = 0.5
"""Fraction of samples near the geometry of the largest commands; the others cover all [-]."""

_GATHERED_SIGMA = 0.3
"""Standard deviation of these samples in the log of distance [-] and in course [rad]."""

_LOG_DISTANCES = (-7.0, 5.0)
"""Range of the other samples in the log of distance over sqrt(R/epsilon) [-].

The distance ratio goes from 0.001, near the reference, to 150, where delta is much longer than d.
"""

_LOG10_ANGLES = (-3.0, 0.0)
"""Range of the decimal log of the gathered samples' angle from head on [rad].

The refinement finds angles below 0.001 rad.
"""


def largest_heading_rate(
    parameters: LookAhead,
    *,
    speed: float,
    reference_heading_rate_max: float,
    gain: float,
    steering_max: float,
    samples: int,
    generator: np.random.Generator,
) -> float:
    """Return the largest |omega| of the cascade law that a random search finds [rad/s].

    Half of the random states cover all geometries. The other half lie where commands are largest:
    at d = sqrt(R/epsilon), nearly head on to the reference, and across z. The worst states are
    refined. The supremum may be larger than the result.

    Parameters
    ----------
    parameters : of the look-ahead
    speed : V of vehicle and reference [m/s]
    reference_heading_rate_max : |omega_r| in all states [rad/s]
    gain : slope of h(phi) [1/s]
    steering_max : largest |h(phi)| [rad/s]
    samples : number of random states, at least 1
    generator : random generator of the states
    """
    states = _random_states(parameters, samples, generator)
    turns = generator.choice([-reference_heading_rate_max, reference_heading_rate_max], samples)

    def commands(state: _Array, turn: _Array | float) -> _Array:
        log_distance, direction, course = state
        distance = np.exp(log_distance)
        return np.abs(
            heading_rates(
                parameters,
                north=distance * np.cos(direction),
                east=distance * np.sin(direction),
                reference_course=0.0,
                course=course,
                speed=speed,
                reference_heading_rate=turn,
                gain=gain,
                steering_max=steering_max,
            )
        )

    found = commands(states, turns)
    largest = float(found.max())
    for worst in np.argsort(found)[-_REFINED:]:
        turn = float(turns[worst])

        def negative(state: _Array, turn: float = turn) -> float:
            return -float(commands(state, turn))

        refined = minimize(
            negative,
            states[:, worst],
            method="Nelder-Mead",
            options={"xatol": 1e-9, "fatol": 1e-10, "maxiter": 2000},
        )
        # A refinement counts even if it has not converged: every state's command is a lower bound
        # of the largest command.
        largest = max(largest, -float(refined.fun))
    return largest


def heading_rates(
    parameters: LookAhead,
    *,
    north: npt.ArrayLike,
    east: npt.ArrayLike,
    reference_course: npt.ArrayLike,
    course: npt.ArrayLike,
    speed: float,
    reference_heading_rate: npt.ArrayLike,
    gain: float,
    steering_max: float,
) -> _Array:
    """Return commands of the cascade law for arrays of states [rad/s]: (14), (15), (17) and (30).

    The computation is independent of ``gnc.paper``: omega_rho is the cross product of z and its
    rate over rho^2, not (18) in the frame of z.

    Parameters
    ----------
    parameters : of the look-ahead
    north, east : d, from vehicle to reference [m]
    reference_course, course : chi_r and chi [rad]
    speed : V of vehicle and reference [m/s]
    reference_heading_rate : omega_r [rad/s]
    gain : slope of h(phi) [1/s]
    steering_max : largest |h(phi)| [rad/s]
    """
    north = np.asarray(north, dtype=np.float64)
    east = np.asarray(east, dtype=np.float64)
    turn = np.asarray(reference_heading_rate, dtype=np.float64)
    ahead_north, ahead_east = np.cos(reference_course), np.sin(reference_course)
    own_north, own_east = np.cos(course), np.sin(course)
    closing_north = speed * (ahead_north - own_north)
    closing_east = speed * (ahead_east - own_east)
    delta = parameters.epsilon * (north * north + east * east) + parameters.radius
    delta_rate = 2.0 * parameters.epsilon * (north * closing_north + east * closing_east)
    z_north, z_east = north + delta * ahead_north, east + delta * ahead_east
    rate_north = closing_north + delta_rate * ahead_north - delta * turn * ahead_east
    rate_east = closing_east + delta_rate * ahead_east + delta * turn * ahead_north
    omega_rho = (z_north * rate_east - z_east * rate_north) / (z_north * z_north + z_east * z_east)
    phi = np.arctan2(
        z_north * own_east - z_east * own_north, z_north * own_north + z_east * own_east
    )
    return np.asarray(omega_rho - np.clip(gain * phi, -steering_max, steering_max))


def _random_states(parameters: LookAhead, samples: int, generator: np.random.Generator) -> _Array:
    """Return random states, shape (3, samples).

    The rows are the log of the distance, the direction of d, and the vehicle's course; both angles
    are relative to the reference's course [rad].
    """
    critical = 0.5 * math.log(parameters.radius / parameters.epsilon)
    gathered = generator.random(samples) < _GATHERED
    near = generator.normal(0.0, _GATHERED_SIGMA, samples)
    anywhere = generator.uniform(*_LOG_DISTANCES, samples)
    log_distance = critical + np.where(gathered, near, anywhere)
    # Directions gather around half a turn, at every scale.
    angle = 10.0 ** generator.uniform(*_LOG10_ANGLES, samples)
    nearly = angle * generator.choice([-1.0, 1.0], samples)
    direction = math.pi + np.where(gathered, nearly, generator.uniform(-math.pi, math.pi, samples))
    # Head on to the reference, z points along the reference's course.
    side = generator.choice([-1.0, 1.0], samples)
    across = 0.5 * math.pi * side + generator.normal(0.0, _GATHERED_SIGMA, samples)
    course = np.where(gathered, across, generator.uniform(-math.pi, math.pi, samples))
    return np.stack([log_distance, direction, course])
