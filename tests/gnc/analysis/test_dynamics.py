"""The nominal system, equations (19) to (21), and half the squared distance V_1, equations (22) and
(23).
"""

import math

import pytest
from gnc_cases import (
    LOOK_AHEAD,
    SPEED,
    circling,
    courses,
    delta_steering,
    examples,
    moved,
    oscillating,
    relative,
    tracking_motion,
    tracking_starts,
)
from hypothesis import given
from hypothesis import strategies as st
from lyapunov_cases import law_24
from scipy.integrate import solve_ivp

from gnc.numeric import wrap
from gnc.paper import (
    RelativeState,
    cascade_law,
    distance_squared_rate,
    equilibrium,
    relative_velocity,
    state_rates,
    v_1,
    v_1_rate,
    v_1_rate_split,
    v_2_rate,
)

offsets = st.floats(-300.0, 300.0)
heading_rates = st.floats(-0.5, 0.5)
ANY_MOTION = given(
    north=offsets,
    east=offsets,
    reference_course=courses,
    course=courses,
    reference_heading_rate=heading_rates,
    heading_rate=heading_rates,
)


def law_30(state, omega_rho):
    return cascade_law(state.phi, omega_rho, 1.5, 0.4)


def open_loop(state, omega_rho):
    return 0.2


@examples(16)
@given(
    start=tracking_starts(phi_max=2.8),
    reference_heading_rate=st.sampled_from([oscillating, circling]),
)
@pytest.mark.parametrize("law", [open_loop, law_24, law_30])
def test_the_nominal_system_is_the_cartesian_motion_in_other_words(
    law, start, reference_heading_rate
):
    # Equation (21) integrated on its own, with the integral of (35) beside it, against (1) and
    # (13).
    def nominal_rates(time, row):
        state, omega_r = RelativeState(*row[:4]), reference_heading_rate(time)
        _, omega_rho = relative_velocity(LOOK_AHEAD, state, SPEED, SPEED, omega_r)
        rates = state_rates(LOOK_AHEAD, state, SPEED, omega_r, law(state, omega_rho))
        return [*rates, v_1_rate_split(state, SPEED)]

    motion = tracking_motion(delta_steering(law, reference_heading_rate), reference_heading_rate)
    accuracy = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-10, "max_step": 0.25}
    cartesian = solve_ivp(motion, (0.0, 20.0), start, **accuracy)
    nominal = solve_ivp(
        nominal_rates, (0.0, 20.0), [*relative(start), v_1(relative(start))], **accuracy
    )
    assert cartesian.success
    assert nominal.success
    expected, got = relative(cartesian.y[:, -1]), RelativeState(*nominal.y[:4, -1])
    north, east = cartesian.y[0, -1] - cartesian.y[3, -1], cartesian.y[1, -1] - cartesian.y[4, -1]
    # Integrated to 1e-10 over some hundred steps; over 60 random starts of each law they came apart
    # by 1.2e-9 of the lengths, 1.7e-9 rad and 1.6e-5 m^2 of up to 1e5. Some starts amplify more:
    # where z is shortest and turns by 10 rad/s.
    assert (got.delta, got.rho) == pytest.approx((expected.delta, expected.rho), rel=1e-7)
    assert wrap(got.phi_r - expected.phi_r) == pytest.approx(0.0, abs=1e-7)
    assert wrap(got.phi - expected.phi) == pytest.approx(0.0, abs=1e-7)
    assert nominal.y[4, -1] == pytest.approx(0.5 * (north**2 + east**2), rel=1e-6, abs=1e-3)


@examples(200)
@given(
    state=st.builds(
        RelativeState, st.floats(60.0, 3000.0), st.floats(10.0, 3000.0), courses, courses
    ),
    reference_heading_rate=heading_rates,
    heading_rate=heading_rates,
)
def test_equation_20_follows_from_21_by_the_law_of_cosines_and_keeps_delta_what_15_says(
    state, reference_heading_rate, heading_rate
):
    delta, rho, phi_r, _ = state
    rates = state_rates(LOOK_AHEAD, state, SPEED, reference_heading_rate, heading_rate)
    # d^2 = rho^2 + delta^2 - 2 rho delta cos(phi_r), differentiated: the four states know of the
    # distance by three of them, and any four numbers keep their delta - epsilon d^2 for good, which
    # is R where (15) is met at the start.
    chain = (
        2.0 * (rho - delta * math.cos(phi_r)) * rates.rho
        + 2.0 * (delta - rho * math.cos(phi_r)) * rates.delta
        + 2.0 * rho * delta * math.sin(phi_r) * rates.phi_r
    )
    # Roundings of 2 * 6 km * up to 2e3 m/s, of terms that cancel.
    assert chain == pytest.approx(distance_squared_rate(state, SPEED, SPEED), rel=0.0, abs=1e-7)
    assert rates.delta == pytest.approx(LOOK_AHEAD.epsilon * chain, rel=0.0, abs=1e-9)


@examples(100)
@given(north=offsets, east=offsets, reference_course=courses, course=courses)
def test_v_1_is_half_the_squared_distance(north, east, reference_course, course):
    state = relative([north, east, reference_course, 0.0, 0.0, course])
    # Equation (22). The squares of rho and delta cancel but for their rounding.
    assert v_1(state) == pytest.approx(
        0.5 * (north**2 + east**2), rel=0.0, abs=1e-14 * state.delta**2
    )


@examples(100)
@ANY_MOTION
def test_the_rate_of_v_1_is_equation_23_whatever_the_control(
    north, east, reference_course, course, reference_heading_rate, heading_rate
):
    cartesian = [north, east, reference_course, 0.0, 0.0, course]
    motion = tracking_motion(lambda *_: heading_rate, lambda _: reference_heading_rate)
    step = 1e-4
    ahead, behind = moved(motion, 0.0, cartesian, step), moved(motion, 0.0, cartesian, -step)
    numerical = (v_1(relative(ahead)) - v_1(relative(behind))) / (2.0 * step)
    # step^2/6 = 2e-9 of d^3(d^2/2)/dt^3, some 1e4 m^2/s^3; the rounding of rho^2, 1e6 m^2 times
    # 2e-16, over the step.
    assert v_1_rate(relative(cartesian), SPEED) == pytest.approx(numerical, rel=0.0, abs=1e-4)


@examples(200)
@given(
    north=offsets,
    east=offsets,
    course=courses,
    reference_heading_rate=heading_rates,
    heading_rate=heading_rates,
)
def test_where_phi_equals_phi_r_distance_is_at_a_maximum_or_a_minimum_unless_both_are_zero(
    north, east, course, reference_heading_rate, heading_rate
):
    # Section V, on figure 5: there (23) vanishes, not (26), for both move alike; and the second
    # rate is d . (v_r-dot - v-dot) = rho V_r sin(phi) (omega - omega_r), which makes a maximum or a
    # minimum.
    cartesian = [north, east, course, 0.0, 0.0, course]
    state = relative(cartesian)
    # Rounding of angles times 2 * 19 m/s * 1.5 km.
    assert v_1_rate(state, SPEED) == pytest.approx(0.0, abs=1e-9)
    motion = tracking_motion(lambda *_: heading_rate, lambda _: reference_heading_rate)
    step = 1e-3
    ahead, behind = (
        v_1_rate(relative(moved(motion, 0.0, cartesian, way)), SPEED) for way in (step, -step)
    )
    expected = state.rho * SPEED * math.sin(state.phi) * (heading_rate - reference_heading_rate)
    # step^2/6 of the fourth rate: over 3,000 random states it erred by 4e-4 m^2/s^2, a hundred
    # times more at ten times the step. The second rate itself reaches some 1e4.
    assert (ahead - behind) / (2.0 * step) == pytest.approx(expected, rel=0.0, abs=4e-3)
    assert v_2_rate(state, SPEED) == pytest.approx(
        -SPEED * state.rho * (1.0 - math.cos(state.phi)), abs=1e-9
    )


def test_v_1_is_zero_off_x_d_too_where_delta_is_not_what_15_says():
    # Equation (22) with phi_r = 0 is (rho - delta)^2/2, whatever their length; (15) at d = 0 leaves
    # delta = R alone.
    assert v_1(RelativeState(100.0, 100.0, 0.0, 0.0)) == 0.0
    assert RelativeState(100.0, 100.0, 0.0, 0.0) != equilibrium(LOOK_AHEAD)
