"""The search for the worst states of the cascade law's command, and how nearly its bound is
reached.
"""

import math

import numpy as np
import pytest
from bounds_cases import LIMIT, distances, fastest, look_aheads, steering
from gnc_cases import LOOK_AHEAD, SPEED, courses, examples, relative
from hypothesis import assume, given
from hypothesis import strategies as st

from gnc.analysis.bounds import heading_rate_bound
from gnc.analysis.worst_case_search import heading_rates, largest_heading_rate
from gnc.paper import cascade_law, look_ahead, relative_velocity


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


@examples(300)
@given(
    parameters=look_aheads(),
    distance=distances,
    direction=courses,
    reference_course=courses,
    course=courses,
    turn=st.floats(-1.0, 1.0),
    gain=st.floats(0.1, 5.0),
    steering_max=steering,
)
def test_the_worst_case_search_commands_what_the_guidance_does(
    parameters, distance, direction, reference_course, course, turn, gain, steering_max
):
    north, east = distance * math.cos(direction), distance * math.sin(direction)
    state = relative([north, east, reference_course, 0.0, 0.0, course], parameters)
    # At half a turn the sign of h is a matter of rounding.
    assume(abs(state.phi) < math.pi - 1e-6)
    _, omega_rho = relative_velocity(parameters, state, SPEED, SPEED, turn)
    vectors = heading_rates(
        parameters,
        north=north,
        east=east,
        reference_course=reference_course,
        course=course,
        speed=SPEED,
        reference_heading_rate=turn,
        gain=gain,
        steering_max=steering_max,
    )
    # Roundings of z, amplified by 1/(1 - sigma) = 100 twice, in commands of up to 1,000 rad/s.
    assert float(vectors) == pytest.approx(
        cascade_law(state.phi, omega_rho, gain, steering_max), rel=1e-9, abs=1e-9
    )
