"""The bound on the cascade law's command, the search for its worst states, and the fastest parameters
within a limit: docs/actuation_bounds.md.
"""

import math

import numpy as np
import pytest
from gnc_cases import (
    HEADING_RATE_MAX,
    LOOK_AHEAD,
    SPEED,
    courses,
    examples,
    fly,
    make_guidance,
    make_reference,
    paper_oscillation,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.analysis.bounds import (
    convergence_time,
    factors,
    factors_at_most,
    fastest_within,
    heading_rate_bound,
)
from gnc.analysis.worst_case_search import largest_heading_rate
from gnc.errors import InfeasibleError
from gnc.laws import CascadeLaw
from gnc.paper import cascade_law, look_ahead, relative_state, relative_velocity

# omega_max of the tables of docs/actuation_bounds.md; the paper has 0.503.
LIMIT = 0.505


@st.composite
def look_aheads(draw):
    """Look-aheads of 5 m to 5 km whose sigma is from 0.02 to 0.99."""
    radius = 5.0 * 1000.0 ** draw(st.floats(0.0, 1.0))
    sigma = draw(st.floats(0.02, 0.99))
    return look_ahead(1.0 / (4.0 * sigma**2 * radius), radius)


def fastest(reserve, *, limit=LIMIT):
    return fastest_within(
        speed=SPEED,
        heading_rate_max=limit,
        reference_heading_rate_max=(1.0 - reserve) * limit,
        distance_from=500.0,
        distance_to=5.0,
        gain=1.5,
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
    power=st.floats(-2.0, 6.0),
    direction=courses,
    course=courses,
    turn=st.floats(0.0, 1.0),
    factor=st.floats(-1.0, 1.0),
    speeds=st.tuples(st.floats(5.0, 40.0), st.floats(5.0, 40.0)),
    gain=st.floats(0.1, 5.0),
    steering_max=st.floats(0.01, 1.0),
)
def test_no_command_exceeds_the_bound_also_at_unequal_speeds(
    parameters, power, direction, course, turn, factor, speeds, gain, steering_max
):
    bound = heading_rate_bound(
        parameters,
        speed=max(speeds),
        reference_heading_rate_max=turn,
        steering_max=steering_max,
        tolerance=0.01,
    )
    # By the functions that fly, for a reference that heads north.
    north, east = 10.0**power * math.cos(direction), 10.0**power * math.sin(direction)
    state = relative_state(parameters, north, east, 0.0, course)
    _, omega_rho = relative_velocity(parameters, state, *speeds, factor * turn)
    assert abs(cascade_law(state.phi, omega_rho, gain, steering_max)) <= bound


@pytest.mark.parametrize(
    ("parameters", "turn", "steering_max"),
    [
        # As flown, close to the shortest R, a long look-ahead, and a slow reference.
        (LOOK_AHEAD, 0.497, 0.4),
        (look_ahead(0.005, 50.5), 0.497, 0.4),
        (look_ahead(0.01, 1000.0), 0.2, 0.1),
        (look_ahead(0.001, 260.0), 0.05, 0.1),
        (None, 0.7 * LIMIT, None),  # the fastest with a reserve of 0.3
    ],
)
def test_a_hundred_thousand_adverse_states_reach_the_bound_and_do_not_exceed_it(
    parameters, turn, steering_max
):
    if parameters is None:
        parameters, steering_max = (design := fastest(0.3)).look_ahead, design.steering_max
    task = {"speed": SPEED, "reference_heading_rate_max": turn, "steering_max": steering_max}
    generator = np.random.default_rng(14)
    found = largest_heading_rate(parameters, **task, gain=1.5, samples=100_000, generator=generator)
    bound = heading_rate_bound(parameters, **task)
    assert found <= bound
    # The bound may lie 1e-4 above the largest omega_rho. The search finds that to 1e-6.
    assert bound / found <= 1.0 + 1.1e-4


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


@pytest.mark.slow
@examples(15)
@given(
    limit=st.floats(0.1, 2.0),
    reserve=st.floats(0.1, 0.95),
    speed=st.floats(5.0, 50.0),
    distance_from=st.floats(20.0, 5000.0),
    gain=st.floats(0.1, 5.0),
)
def test_the_fastest_keeps_its_limit_and_with_a_shorter_look_ahead_would_not_or_would_be_slower(
    limit, reserve, speed, distance_from, gain
):
    turn = (1.0 - reserve) * limit
    task = {"speed": speed, "distance_from": distance_from, "distance_to": 10.0, "gain": gain}
    found = fastest_within(heading_rate_max=limit, reference_heading_rate_max=turn, **task)
    states = {
        "speed": speed,
        "reference_heading_rate_max": turn,
        "steering_max": found.steering_max,
    }
    assert found.bound <= limit
    assert found.bound == heading_rate_bound(found.look_ahead, **states)
    assert found.convergence_time == convergence_time(
        found.look_ahead, steering_max=found.steering_max, **task
    )
    epsilon, radius = found.look_ahead
    # At the same sigma; V/(2 omega_r) is the shortest R allowed. What tolerances leave unspent of
    # the limit, 2e-4 of it, is less than what 10 % of R bring, V/R being some hundredth of the
    # limit at least.
    shorter = look_ahead(epsilon / 0.9, 0.9 * radius)
    assert (
        shorter.radius < speed / (2.0 * turn)
        or convergence_time(shorter, steering_max=found.steering_max, **task)
        > found.convergence_time
        or heading_rate_bound(shorter, **states) > limit
    )


def test_the_guidance_flies_its_preview_without_a_command_above_the_bound():
    oscillation = paper_oscillation(0.5, reserve=0.3)
    found = fastest(0.3, limit=HEADING_RATE_MAX)
    law = CascadeLaw(
        epsilon_per_m=found.look_ahead.epsilon,
        look_ahead_m=found.look_ahead.radius,
        gain_per_s=found.gain,
        steering_max_rad_s=found.steering_max,
    )
    for start in ((-400.0, 300.0, 3.0), (0.0, 0.0, -1.5)):
        # Not to be cut at omega_max: the law itself keeps it.
        guidance = make_guidance(
            make_reference(oscillation), law=law, lag=0.5, heading_rate_max=10.0
        )
        flight = fly(guidance, start, duration=120.0, delay=0.5)
        assert np.abs(flight.command).max() <= found.bound <= HEADING_RATE_MAX
    # As flown, the command would pass omega_max ...
    guidance = make_guidance(make_reference(paper_oscillation(0.5)), heading_rate_max=10.0)
    flight = fly(guidance, (0.0, 0.0, 0.0), duration=60.0)
    assert np.abs(flight.command).max() > HEADING_RATE_MAX
    # ... and the bound says how far it may.
    assert np.abs(flight.command).max() <= heading_rate_bound(
        LOOK_AHEAD, speed=SPEED, reference_heading_rate_max=HEADING_RATE_MAX, steering_max=0.4
    )
