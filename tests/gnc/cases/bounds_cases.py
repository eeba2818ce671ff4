"""What the tests of the actuation bounds share."""

from gnc_cases import SPEED
from hypothesis import strategies as st

from gnc.analysis.bounds import convergence_time, fastest_within
from gnc.paper import cascade_law, look_ahead, relative_state, relative_velocity

# omega_max of the tables of docs/actuation_bounds.md; paper-notes give 0.503.
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
