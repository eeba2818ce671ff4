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

DESIGNS = {
    "as flown": (LOOK_AHEAD, 0.497, 1.5, 0.4),
    "close to the shortest R": (look_ahead(0.005, 50.5), 0.497, 1.5, 0.4),
    "reference in a gentle circle": (look_ahead(0.005, 200.0), 0.15, 1.5, 0.1),
    "long look-ahead": (look_ahead(0.01, 1000.0), 0.2, 1.5, 0.1),
    "medium look-ahead": (look_ahead(0.01, 600.0), 0.3, 1.5, 0.1),
    "slow reference": (look_ahead(0.001, 260.0), 0.05, 1.5, 0.1),
    "steep epsilon": (look_ahead(0.1, 100.0), 0.3, 1.5, 0.05),
}


def design(name):
    if name in DESIGNS:
        return DESIGNS[name]
    reserve = float(name.removeprefix("fastest with a reserve of "))
    found = fastest(reserve)
    return found.look_ahead, (1.0 - reserve) * LIMIT, found.gain, found.steering_max


def found_and_bound(parameters, turn, gain, steering_max, *, samples, seed):
    task = {"speed": SPEED, "reference_heading_rate_max": turn, "steering_max": steering_max}
    found = largest_heading_rate(
        parameters, **task, gain=gain, samples=samples, generator=np.random.default_rng(seed)
    )
    return found, heading_rate_bound(parameters, **task)


@pytest.mark.parametrize(
    "name", [*DESIGNS, *(f"fastest with a reserve of {reserve}" for reserve in (0.1, 0.3, 0.6))]
)
def test_a_hundred_thousand_adverse_states_reach_the_bound_and_do_not_exceed_it(name):
    found, bound = found_and_bound(*design(name), samples=100_000, seed=14)
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
