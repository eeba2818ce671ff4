import pytest
from scipy.integrate import solve_ivp

from gnc.paper import unicycle_rates
from gnc.unicycle import lagged_move, unicycle_move


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
