import math

import numpy as np
import pytest
from gnc_cases import (
    LOOK_AHEAD,
    SPEED,
    courses,
    delta_steering,
    examples,
    moved,
    paper_oscillation,
    relative,
    tracking_motion,
)
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gnc.angles import wrap
from gnc.delta import RelativeState
from gnc.dynamics import equilibrium, state_rates, v_1, v_1_rate, v_2, v_2_acceleration, v_2_rate
from gnc.laws import lyapunov_law

K_1 = 0.001
K_2 = 1.0 / K_1

offsets = st.floats(-300.0, 300.0)
heading_rates = st.floats(-0.5, 0.5)

OSCILLATION = paper_oscillation(0.5)


def oscillating(time):
    """omega_r [rad/s] of equation (2), about a vessel on a straight course."""
    return -OSCILLATION.amplitude * math.sin(OSCILLATION.omega_0 * time)


def circling(time):
    """omega_r [rad/s] of the paper's Sim. 1, a circle."""
    return 0.2


def law_24(state, omega_rho):
    return lyapunov_law(state, SPEED, omega_rho, K_1)


REFERENCES = pytest.mark.parametrize("reference_heading_rate", [oscillating, circling])
# From behind, abeam, close by and almost opposite; not exactly opposite, where law (24) is singular.
STARTS = pytest.mark.parametrize("start", [(-250.0, 40.0, 0.5), (20.0, -150.0, -1.0), (3.0, 2.0, 2.5), (120.0, 5.0, 3.0)])


def fly_law_24(reference_heading_rate, start, duration):
    """Fly (24) in Cartesian coordinates; return times, relative states and the Cartesian ones."""
    course = OSCILLATION.eta if reference_heading_rate is oscillating else 0.0
    motion = tracking_motion(delta_steering(law_24, reference_heading_rate), reference_heading_rate)
    times = np.linspace(0.0, duration, 601)
    solution = solve_ivp(motion, (0.0, duration), [0.0, 0.0, course, *start], t_eval=times, max_step=0.25, rtol=1e-8, atol=1e-8)
    assert solution.success
    return times, [relative(state) for state in solution.y.T], solution.y.T


@pytest.mark.parametrize("start", [(-250.0, 40.0, 0.5), (60.0, -80.0, -2.0)])
def test_the_nominal_system_is_the_cartesian_motion_in_other_words(start):
    # Equation (21) integrated on its own against (1) and (13), both steered open loop.
    def heading_rate(time):
        return 0.3 * math.sin(0.15 * time + 1.0)

    begin = [0.0, 0.0, OSCILLATION.eta, *start]
    cartesian = solve_ivp(
        tracking_motion(lambda _, time: heading_rate(time), oscillating),
        (0.0, 40.0),
        begin,
        method="DOP853",
        rtol=1e-11,
        atol=1e-11,
    )
    nominal = solve_ivp(
        lambda time, state: state_rates(LOOK_AHEAD, RelativeState(*state), SPEED, oscillating(time), heading_rate(time)),
        (0.0, 40.0),
        relative(begin),
        method="DOP853",
        rtol=1e-11,
        atol=1e-11,
    )
    expected, got = relative(cartesian.y[:, -1]), RelativeState(*nominal.y[:, -1])
    # Integration tolerance 1e-11 over some hundred steps of lengths up to 5 km; (21) does not amplify much in 40 s.
    assert (got.delta, got.rho) == pytest.approx((expected.delta, expected.rho), rel=1e-7)
    assert wrap(got.phi_r - expected.phi_r) == pytest.approx(0.0, abs=1e-7)
    assert wrap(got.phi - expected.phi) == pytest.approx(0.0, abs=1e-7)


@examples(100)
@given(
    north=offsets,
    east=offsets,
    reference_course=courses,
    course=courses,
    reference_heading_rate=heading_rates,
    heading_rate=heading_rates,
)
def test_equation_21_is_as_printed(north, east, reference_course, course, reference_heading_rate, heading_rate):
    state = relative([north, east, reference_course, 0.0, 0.0, course])
    delta, rho, phi_r, phi = state
    c, c_r, s, s_r, c_both = math.cos(phi), math.cos(phi_r), math.sin(phi), math.sin(phi_r), math.cos(phi - phi_r)
    epsilon = LOOK_AHEAD.epsilon
    both = rho * (c - c_r) + delta * (1.0 - c_both)
    turn = -(SPEED * s_r - SPEED * s + delta * reference_heading_rate * c_r) / rho + 2.0 * epsilon * SPEED * s_r * (
        c - c_r + delta / rho * (1.0 - c_both)
    )
    printed = (
        -2.0 * epsilon * SPEED * both,
        SPEED * (c_r - c) - delta * reference_heading_rate * s_r - 2.0 * epsilon * SPEED * c_r * both,
        reference_heading_rate + turn,
        heading_rate + turn,
    )
    # Roundings of up to 1e3 m/s, over no less than 10 m.
    assert state_rates(LOOK_AHEAD, state, SPEED, reference_heading_rate, heading_rate) == pytest.approx(printed, rel=0.0, abs=1e-10)


@examples(100)
@given(reference_heading_rate=heading_rates)
def test_on_the_reference_and_with_its_heading_rate_nothing_changes(reference_heading_rate):
    # Section IV.C: x_d = [R, R, 0, 0]. Rounding of R omega_r/R.
    rates = state_rates(LOOK_AHEAD, equilibrium(LOOK_AHEAD), SPEED, reference_heading_rate, reference_heading_rate)
    assert rates == pytest.approx((0.0, 0.0, 0.0, 0.0), abs=1e-15)
    assert equilibrium(LOOK_AHEAD) == (60.0, 60.0, 0.0, 0.0)


@examples(100)
@given(north=offsets, east=offsets, reference_course=courses, course=courses)
def test_v_1_is_half_the_squared_distance(north, east, reference_course, course):
    state = relative([north, east, reference_course, 0.0, 0.0, course])
    # Equation (22). The squares of rho and delta cancel but for their rounding.
    assert v_1(state) == pytest.approx(0.5 * (north**2 + east**2), rel=0.0, abs=1e-14 * state.delta**2)


@examples(100)
@given(north=offsets, east=offsets, reference_course=courses, course=courses)
def test_v_2_is_positive_everywhere_but_on_the_reference(north, east, reference_course, course):
    state = relative([north, east, reference_course, 0.0, 0.0, course])
    # paper-notes, care 10: positive definite about x_d; a metre away or 0.1 rad off course is away from it.
    assume(math.hypot(north, east) > 1.0 or abs(state.phi) > 0.1)
    # The lesser of the two: K_2 (1 - cos 0.1) = 5, and half of 1 m squared.
    assert v_2(state, K_2) > 0.49
    assert v_2(equilibrium(LOOK_AHEAD), K_2) == 0.0


@examples(100)
@given(
    north=offsets,
    east=offsets,
    reference_course=courses,
    course=courses,
    reference_heading_rate=heading_rates,
    heading_rate=heading_rates,
)
def test_the_rate_of_v_1_is_equation_23_whatever_the_control(
    north, east, reference_course, course, reference_heading_rate, heading_rate
):
    cartesian = [north, east, reference_course, 0.0, 0.0, course]
    motion = tracking_motion(lambda *_: heading_rate, lambda _: reference_heading_rate)
    step = 1e-4
    ahead, behind = moved(motion, 0.0, cartesian, step), moved(motion, 0.0, cartesian, -step)
    numerical = (v_1(relative(ahead)) - v_1(relative(behind))) / (2.0 * step)
    # step^2/6 = 2e-9 of d^3(d^2/2)/dt^3, some 1e4 m^2/s^3; the rounding of rho^2, 1e6 m^2 times 2e-16, over the step.
    assert v_1_rate(relative(cartesian), SPEED) == pytest.approx(numerical, rel=0.0, abs=1e-4)


@examples(150)
@given(north=offsets, east=offsets, reference_course=courses, course=courses, time=st.floats(0.0, 20.0))
def test_under_law_24_the_rates_of_v_2_are_equations_26_and_27(north, east, reference_course, course, time):
    cartesian = [north, east, reference_course, 0.0, 0.0, course]
    here = relative(cartesian)
    # Towards phi = pi law (24) is singular, and no difference quotient is good.
    assume(abs(here.phi) < 2.0)
    motion = tracking_motion(delta_steering(law_24, oscillating), oscillating)
    step = 1e-5
    ahead, behind = (relative(moved(motion, time, cartesian, way)) for way in (step, -step))
    omega_r = oscillating(time)
    heading_rate = motion(time, cartesian)[5]
    rates = state_rates(LOOK_AHEAD, here, SPEED, omega_r, heading_rate)
    first = (v_2(ahead, K_2) - v_2(behind, K_2)) / (2.0 * step)
    second = (v_2_rate(ahead, SPEED) - v_2_rate(behind, SPEED)) / (2.0 * step)
    # Central differences err by step^2/6 of the next but one derivative; phi moves at up to k_1 rho V_r tan(1) = 30 rad/s. Over
    # 3,000 random states they erred by 3e-4 m^2/s and 1e-2 m^2/s^2, a hundred times more at ten times the step. Corners are allowed
    # ten times that; the rates themselves reach some 1e4 and 1e6.
    assert v_2_rate(here, SPEED) == pytest.approx(first, rel=0.0, abs=3e-3)
    assert v_2_acceleration(here, rates, SPEED) == pytest.approx(second, rel=0.0, abs=0.1)


@examples(200)
@given(north=offsets, east=offsets, reference_course=courses, course=courses)
def test_the_rate_of_v_2_is_never_positive(north, east, reference_course, course):
    # Equation (26).
    assert v_2_rate(relative([north, east, reference_course, 0.0, 0.0, course]), SPEED) <= 0.0


@REFERENCES
@STARTS
def test_v_2_never_rises_under_law_24(reference_heading_rate, start):
    _, states, _ = fly_law_24(reference_heading_rate, start, 120.0)
    values = np.array([v_2(state, K_2) for state in states])
    # Below equation (26). At the end, where nothing changes any more, there is the squares' rounding: 1e-16 of (60 m)^2.
    assert np.max(np.diff(values)) <= 1e-12 * values[0]
    # And it does fall, to rounding: convergence is exponential.
    assert values[-1] < 1e-10 * values[0]


@REFERENCES
@STARTS
def test_under_law_24_the_states_converge_as_the_proof_says(reference_heading_rate, start):
    times, states, cartesian = fly_law_24(reference_heading_rate, start, 250.0)
    final, time = states[-1], times[-1]
    motion = tracking_motion(delta_steering(law_24, reference_heading_rate), reference_heading_rate)
    rates = state_rates(LOOK_AHEAD, final, SPEED, reference_heading_rate(time), motion(time, cartesian[-1])[5])
    # (28): phi_r and phi go to zero, and with them V_2's rate; (29): so does phi_r's rate; so rho goes to delta, and delta to R.
    # Convergence is exponential, and 250 s are ample: all is rounding by then, 1e-12. Of the look-ahead's 60 m, 1e-6 is 0.06 mm.
    assert abs(v_2_rate(final, SPEED)) < 1e-6
    assert abs(final.phi_r) < 1e-6
    assert abs(final.phi) < 1e-6
    assert abs(rates.phi_r) < 1e-6
    assert final.rho == pytest.approx(final.delta, rel=1e-6)
    assert final.delta == pytest.approx(LOOK_AHEAD.radius, rel=1e-6)
    # And at the start they were not there already.
    assert max(abs(states[0].phi_r), abs(states[0].phi)) > 0.01
