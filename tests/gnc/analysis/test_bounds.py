"""The bound on the cascade law's command: docs/actuation_bounds.md."""

import math

import numpy as np
import pytest
from bounds_cases import distances, look_aheads, steering
from gnc_cases import LOOK_AHEAD, SPEED, courses, examples
from hypothesis import given
from hypothesis import strategies as st

from gnc.analysis.bounds import factors, factors_at_most, heading_rate_bound
from gnc.analysis.worst_case_search import heading_rates
from gnc.errors import InfeasibleError
from gnc.paper import cascade_law, relative_state, relative_velocity

turns = st.floats(0.0, 1.0)


def command(
    parameters, north, east, course, turn, gain, steering_max, *, reference_speed=SPEED, speed=SPEED
):
    """Return the command by the functions that fly, for a reference that heads north."""
    state = relative_state(parameters, north, east, 0.0, course)
    _, omega_rho = relative_velocity(parameters, state, reference_speed, speed, turn)
    return cascade_law(state.phi, omega_rho, gain, steering_max)


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


@examples(100)
@given(
    parameters=look_aheads(), alpha=st.floats(0.0, 3.1), beta=st.floats(0.0, math.pi), turn=turns
)
def test_at_each_position_the_worst_course_and_turn_give_the_two_factors(
    parameters, alpha, beta, turn
):
    sigma = 0.5 / math.sqrt(parameters.epsilon * parameters.radius)
    distance = math.sqrt(parameters.radius / parameters.epsilon) * math.tan(0.5 * alpha)
    course = np.linspace(-math.pi, math.pi, 3601)
    worst = max(
        np.abs(
            heading_rates(
                parameters,
                north=-distance * math.cos(beta),
                east=distance * math.sin(beta),
                reference_course=0.0,
                course=course,
                speed=SPEED,
                reference_heading_rate=sign * turn,
                gain=1.0,
                steering_max=0.0,
            )
        ).max()
        for sign in (1.0, -1.0)
    )
    speed_factor, turn_factor = (
        float(factor) for factor in factors(sigma, np.array(alpha), np.array(beta))
    )
    # Courses every 0.1 degrees miss the crest of a cosine by (0.1 degrees)^2/8 = 4e-7 of its
    # amplitude.
    assert worst == pytest.approx(
        SPEED / parameters.radius * speed_factor + turn * turn_factor, rel=1e-6
    )


@examples(300)
@given(
    sigma=st.floats(0.01, 0.999),
    alpha=st.floats(0.0, math.pi),
    beta=st.floats(0.0, math.pi),
    size=st.floats(-4.0, 0.3).map(lambda power: 10.0**power),
    inside=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)),
)
def test_no_point_of_a_cell_exceeds_the_cells_bounds_which_close_in(
    sigma, alpha, beta, size, inside
):
    low = np.array([[alpha], [beta]])
    high = np.minimum(low + size, math.pi)
    at = low + np.array(inside)[:, None] * (high - low)
    for factor, at_most in zip(factors(sigma, *at), factors_at_most(sigma, low, high), strict=True):
        # The bounds use the same sines and cosines: roundings, amplified by at most 1/(1 - sigma) =
        # 1000 in rho.
        assert factor[0] <= at_most[0] * (1.0 + 1e-12)
    for factor, at_most in zip(factors(sigma, *low), factors_at_most(sigma, low, low), strict=True):
        # A root of the rounding of (1 - sigma)^-2 where the vehicle's factor vanishes.
        assert at_most[0] == pytest.approx(factor[0], rel=1e-9, abs=1e-5)


@examples(150)
@given(
    parameters=look_aheads(),
    distance=distances,
    direction=courses,
    course=courses,
    turn=turns,
    factor=st.floats(-1.0, 1.0),
    speeds=st.tuples(st.floats(5.0, 40.0), st.floats(5.0, 40.0)),
    gain=st.floats(0.1, 5.0),
    steering_max=steering,
)
def test_no_command_exceeds_the_bound_also_at_unequal_speeds(
    parameters, distance, direction, course, turn, factor, speeds, gain, steering_max
):
    bound = heading_rate_bound(
        parameters,
        speed=max(speeds),
        reference_heading_rate_max=turn,
        steering_max=steering_max,
        tolerance=0.01,
    )
    north, east = distance * math.cos(direction), distance * math.sin(direction)
    reference_speed, speed = speeds
    omega = command(
        parameters,
        north,
        east,
        course,
        factor * turn,
        gain,
        steering_max,
        reference_speed=reference_speed,
        speed=speed,
    )
    assert abs(omega) <= bound


@examples(200)
@given(parameters=look_aheads(), turn=turns, gain=st.floats(0.1, 5.0), steering_max=steering)
def test_the_least_bound_is_a_command_that_is_met_and_no_larger_one_is_met_head_on(
    parameters, turn, gain, steering_max
):
    least = largest_head_on(
        parameters,
        speed=SPEED,
        reference_heading_rate_max=turn,
        gain=gain,
        steering_max=steering_max,
    )
    scale = math.sqrt(parameters.radius / parameters.epsilon)
    distances_over = scale * np.tan(0.5 * np.linspace(0.0, 3.0, 20001))
    omega = heading_rates(
        parameters,
        north=-distances_over,
        east=0.0,
        reference_course=0.0,
        course=-0.5 * math.pi,
        speed=SPEED,
        reference_heading_rate=turn,
        gain=gain,
        steering_max=steering_max,
    )
    worst = distances_over[np.argmax(omega)]
    # Steps of 1.5e-4 in alpha miss the crest by some (1.5e-4/(1 - sigma))^2/8 = 3e-5 at sigma =
    # 0.99; elsewhere by far less.
    assert omega.max() == pytest.approx(least, rel=5e-5)
    assert omega.max() <= least * (1.0 + 1e-12)
    # The functions that fly command the same. Roundings, amplified by 1/(1 - sigma)^2 at most.
    assert command(
        parameters, -worst, 0.0, -0.5 * math.pi, turn, gain, steering_max
    ) == pytest.approx(omega.max(), rel=1e-10)
    bound = heading_rate_bound(
        parameters,
        speed=SPEED,
        reference_heading_rate_max=turn,
        steering_max=steering_max,
        tolerance=0.01,
    )
    assert least <= bound


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("speed", 0.0),
        ("speed", math.nan),
        ("reference_heading_rate_max", -0.1),
        ("reference_heading_rate_max", math.inf),
        ("steering_max", 0.0),
    ],
)
def test_bounds_of_what_cannot_be_are_refused(name, value):
    arguments = {"speed": SPEED, "reference_heading_rate_max": 0.3, "steering_max": 0.4}
    with pytest.raises(InfeasibleError, match=f"{name} is {value:g} "):
        heading_rate_bound(LOOK_AHEAD, **(arguments | {name: value}))
