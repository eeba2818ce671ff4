"""Elevon servos in a step: lag, rate limit, clip, mixing."""

import numpy as np
import pytest

from aircraft.state import RigidBodyState

TIME_STEP = 1.0 / 120.0
LAG = 40.0  # rad/s, of the model file: 25 ms, a digital servo
RATE_LIMIT = 3.49  # rad/s, 200 deg/s
FULL = 0.5236  # rad

LEVEL = RigidBodyState(altitude=100.0, roll=0.0, pitch=0.0, velocity_body=(20.0, 0.0, 0.0))


def step_answer(fdm, inputs, steps, name="fcs/elevator-pos-rad"):
    """Positions after each step [rad], from rest at zero."""
    fdm.command({"elevator": 0.0, "aileron": 0.0, "throttle": 0.5})
    positions = []
    with fdm.frozen():
        fdm.place(LEVEL)
        fdm.step(120)
        fdm.command(inputs)
        for _ in range(steps):
            fdm.step()
            positions.append(fdm.read(name))
    return np.array(positions)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_small_step_is_followed_with_a_lag_of_40_rad_a_second(x8_fdm, sign):
    # 0.05 of full deflection asks for 1.05 rad/s at most: well below the rate limit.
    size = sign * 0.05 * FULL
    share = step_answer(x8_fdm, {"elevator": sign * 0.05}, 24) / size
    # JSBSim's lag takes the mean of old and new input over a step, which is half a step of delay;
    # with dt/T = 1/3 the trapezoidal rule is then within 0.012 of the exponential (its series
    # differs from order (dt/T)^3/12 on).
    time = TIME_STEP * (np.arange(1, 25) - 0.5)
    np.testing.assert_allclose(share, 1.0 - np.exp(-LAG * time), atol=0.012)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_large_step_is_followed_at_200_degrees_a_second(x8_fdm, sign):
    size = 0.8 * FULL
    positions = sign * step_answer(x8_fdm, {"elevator": sign * 0.8}, 60)
    # JSBSim's actuator lags first and limits the rate of what comes out, so it goes at full rate
    # until it meets the lagged command.
    time = TIME_STEP * np.arange(1, 61)
    lagged = size * (1.0 - np.exp(-LAG * (time - 0.5 * TIME_STEP)))
    # Tolerance of the lag: as above. It is met at 0.12 s, when 1 % of the step is left, so the
    # limit is what shows until then.
    np.testing.assert_allclose(positions, np.minimum(RATE_LIMIT * time, lagged), atol=0.012 * size)
    # A clip: rounding alone.
    assert np.diff(positions).max() == pytest.approx(RATE_LIMIT * TIME_STEP, rel=1e-9)


@pytest.mark.parametrize(
    ("elevator", "aileron", "left", "right"),
    [
        (1.0, 0.0, 1.0, 1.0),
        (2.0, 0.0, 1.0, 1.0),
        (-3.0, 0.0, -1.0, -1.0),
        (1.0, 1.0, 1.0, 0.0),
        (-0.5, -0.9, -1.0, 0.4),
    ],
)
def test_each_elevon_stops_at_full_deflection_on_its_own(x8_fdm, elevator, aileron, left, right):
    # left = elevator + aileron, right = elevator - aileron, each within -1 and 1.
    inputs = {"elevator": elevator, "aileron": aileron}
    assert step_answer(x8_fdm, inputs, 240, "fcs/left-elevon-pos-rad")[-1] == pytest.approx(
        left * FULL, abs=1e-9
    )
    assert step_answer(x8_fdm, inputs, 240, "fcs/right-elevon-pos-rad")[-1] == pytest.approx(
        right * FULL, abs=1e-9
    )


def test_elevator_and_aileron_are_the_symmetric_and_antisymmetric_part(x8_fdm):
    inputs = {"elevator": 0.2, "aileron": -0.3}
    # Twenty time constants leave 1e-9 of the step.
    assert step_answer(x8_fdm, inputs, 60, "fcs/elevator-pos-rad")[-1] == pytest.approx(
        0.2 * FULL, abs=1e-8
    )
    assert step_answer(x8_fdm, inputs, 60, "fcs/aileron-pos-rad")[-1] == pytest.approx(
        -0.3 * FULL, abs=1e-8
    )


def test_positive_aileron_rolls_right_and_positive_elevator_pitches_down(x8_fdm):
    # Trailing edge down is positive: C_mde < 0, and the left elevon down (C_lda > 0) lifts the left
    # wing. The sizes have their own tests; C_m0 works against the elevator.
    with x8_fdm.frozen():
        x8_fdm.command({"elevator": 0.3, "aileron": 0.2, "throttle": 0.5})
        x8_fdm.place(LEVEL)
        assert x8_fdm.settle()
        p_dot, q_dot, _ = x8_fdm.angular_acceleration()
    assert p_dot > 10.0
    assert q_dot < -5.0
