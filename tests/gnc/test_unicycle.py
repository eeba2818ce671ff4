import math

import pytest
from gnc_cases import courses, examples
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gnc.paper import unicycle_rates
from gnc.unicycle import lagged_move, unicycle_move

speeds = st.floats(1.0, 40.0)
heading_rates = st.floats(-1.0, 1.0)


@examples(100)
@given(speed=speeds, course=courses, heading_rate=heading_rates)
def test_the_vehicle_moves_along_its_course_at_its_speed(speed, course, heading_rate):
    north_rate, east_rate, course_rate = unicycle_rates(speed, course, heading_rate)
    # Below equation (1): the nonholonomic constraint. Tolerances are roundings of numbers up to 40.
    assert north_rate * math.sin(course) - east_rate * math.cos(course) == pytest.approx(
        0.0, abs=1e-13
    )
    assert math.hypot(north_rate, east_rate) == pytest.approx(speed, rel=1e-14)
    assert north_rate * math.cos(course) + east_rate * math.sin(course) > 0.0
    assert course_rate == heading_rate


@pytest.mark.parametrize("heading_rate", [-0.9, -0.1, 0.0, 1e-9, 0.503])
def test_a_move_equals_the_integral_of_the_rates(heading_rate):
    course, speed, duration = 2.5, 19.42, 30.0
    solution = solve_ivp(
        lambda _, state: unicycle_rates(speed, state[2], heading_rate),
        (0.0, duration),
        [5.0, -7.0, course],
        rtol=1e-10,
        atol=1e-10,
    )
    # Integration tolerance 1e-10 of 583 m, over some dozens of steps.
    assert unicycle_move(5.0, -7.0, course, speed, heading_rate, duration) == pytest.approx(
        solution.y[:, -1], rel=0.0, abs=1e-5
    )


@pytest.mark.parametrize("step", [0.05, 1.0])
@pytest.mark.parametrize("lag", [0.001, 0.02, 0.3, 2.0])
def test_a_lagged_move_equals_the_integral_of_a_first_order_lag(lag, step):
    north, east, course, rate, command, speed = 5.0, -7.0, 2.5, -0.4, 0.5, 19.42

    def rates(_, state):
        return [
            *unicycle_rates(speed, state[2], state[3])[:2],
            state[3],
            (command - state[3]) / lag,
        ]

    state = (north, east, course, rate)
    for _ in range(round(2.0 / step)):
        state = lagged_move(*state, speed, command, lag, step)
    solution = solve_ivp(
        rates, (0.0, 2.0), [north, east, course, rate], rtol=1e-12, atol=1e-12, method="LSODA"
    )
    # Quadrature over pieces of half a lag or 0.1 s errs by some 1e-7 m in the first lag, where the
    # rate changes most; course and rate are in closed form, integration 1e-12 a step.
    assert state[:2] == pytest.approx(solution.y[:2, -1], rel=0.0, abs=5e-7)
    assert state[2:] == pytest.approx(solution.y[2:, -1], rel=0.0, abs=1e-9)


@examples(100)
@given(course=courses, heading_rate=heading_rates, speed=speeds, duration=st.floats(0.001, 0.05))
def test_a_lagged_move_at_its_commanded_rate_is_a_move_without_lag(
    course, heading_rate, speed, duration
):
    # Nothing to lag behind. Quadrature of 1e-9 m, as above.
    moved = lagged_move(1.0, 2.0, course, heading_rate, speed, heading_rate, 0.3, duration)
    assert moved[:3] == pytest.approx(
        unicycle_move(1.0, 2.0, course, speed, heading_rate, duration), rel=0.0, abs=1e-9
    )
    assert moved[3] == heading_rate
