"""What the tests of the actuation bounds share."""

import math

from gnc_cases import SPEED
from hypothesis import strategies as st

from gnc.analysis.bounds import convergence_time, fastest_within
from gnc.paper import cascade_law, look_ahead, relative_state, relative_velocity

# omega_max of the tables of docs/actuation_bounds.md; the paper has 0.503.
LIMIT = 0.505

distances = st.floats(0.0, 8.0).map(lambda power: 10.0 ** (power - 2.0))
turns = st.floats(0.0, 1.0)
steering = st.floats(0.01, 1.0)


@st.composite
def look_aheads(draw):
    """Look-aheads of 5 m to 5 km whose sigma is from 0.02 to 0.99."""
    radius = 5.0 * 1000.0 ** draw(st.floats(0.0, 1.0))
    sigma = draw(st.floats(0.02, 0.99))
    return look_ahead(1.0 / (4.0 * sigma**2 * radius), radius)


def command(
    parameters, north, east, course, turn, gain, steering_max, *, reference_speed=SPEED, speed=SPEED
):
    """Return the command by the functions that fly, for a reference that heads north."""
    state = relative_state(parameters, north, east, 0.0, course)
    _, omega_rho = relative_velocity(parameters, state, reference_speed, speed, turn)
    return cascade_law(state.phi, omega_rho, gain, steering_max)


def fastest(reserve, *, distance_from=500.0, limit=LIMIT):
    return fastest_within(
        speed=SPEED,
        heading_rate_max=limit,
        reference_heading_rate_max=(1.0 - reserve) * limit,
        distance_from=distance_from,
        distance_to=5.0,
        gain=1.5,
    )


def time_of(parameters, steering_max, *, distance_from=500.0):
    return convergence_time(
        parameters,
        speed=SPEED,
        distance_from=distance_from,
        distance_to=5.0,
        gain=1.5,
        steering_max=steering_max,
    )


def largest_head_on(parameters, *, speed, reference_heading_rate_max, gain, steering_max):
    """Return the largest command of states head on to the reference, in closed form [rad/s].

    No bound can be smaller. There d points against the reference's course, phi is -pi/2 for omega_r
    > 0, and omega = (V + delta omega_r)/(delta - d) + h(pi/2), which is largest where lambda sigma
    u^2 + u = (1 + lambda) sigma: u = d sqrt(epsilon/R), lambda = omega_r R/V.
    """
    sigma = 0.5 / math.sqrt(parameters.epsilon * parameters.radius)
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
