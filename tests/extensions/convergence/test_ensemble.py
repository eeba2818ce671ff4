"""The motion of an ensemble of trajectories against the equations of one, and what is refused."""

import math

import numpy as np
import pytest
from ensemble_cases import (
    GAIN,
    STEERING_MAX,
    TIGHT,
    VEHICLE,
    history,
    oscillating,
    references,
    wandering,
)
from gnc_cases import (
    HEADING_RATE_MAX,
    LOOK_AHEAD,
    OSCILLATION,
    SPEED,
    courses,
    delta_steering,
    examples,
    relative,
    tracking_motion,
)
from hypothesis import assume, given
from hypothesis import strategies as st
from lyapunov_cases import K_1
from scipy.integrate import solve_ivp

from extensions.convergence.ensemble import DISTANCE_CONVERGED, Outcome
from extensions.convergence.motion import MOTIONS, Steering
from gnc.numeric import wrap
from gnc.paper import cascade_law, lyapunov_law, relative_velocity, state_rates, v_2

pytestmark = pytest.mark.slow

LAWS = pytest.mark.parametrize("law", list(Steering))
offsets = st.floats(-3000.0, 3000.0)


def steer(law, there, omega_rho):
    if law is Steering.LYAPUNOV:
        return lyapunov_law(there, SPEED, omega_rho, K_1)
    command = cascade_law(there.phi, omega_rho, GAIN, STEERING_MAX)
    return (
        min(max(command, -HEADING_RATE_MAX), HEADING_RATE_MAX)
        if law is Steering.CASCADE_CUT
        else command
    )


@examples(50)
@given(time=st.floats(0.0, 1000.0), rate=st.floats(-0.5, 0.5))
def test_the_heading_rate_of_a_reference_is_the_rate_of_its_course(time, rate):
    refs = references(course=[0.4], rate=[rate], terms=[(0.2, 0.3, 1.0), (-0.1, 0.9, 2.0)])
    step = 1e-4
    numerical = (
        refs.course_at(np.array([time + step])) - refs.course_at(np.array([time - step]))
    ) / (2.0 * step)
    # Central difference: step^2/6 of omega_r's second derivative, below 1e-9; 500 rad of course
    # rounded, 1e-13, over the step.
    assert refs.heading_rate_at(np.array([time])) == pytest.approx(numerical, rel=0.0, abs=1e-8)
    assert refs.course_at(np.zeros(1)) == pytest.approx([0.4], abs=1e-15)


def test_an_oscillating_reference_is_the_one_of_equations_2_and_7():
    phase, time = 0.7, 33.0
    refs = oscillating(phase)
    angle = OSCILLATION.omega_0 * time + phase
    # Section III: chi_r = eta cos(omega_0 t + phi_0) on a vessel's course of 0, omega_r = -A
    # sin(omega_0 t + phi_0). Rounding.
    assert refs.course_at(np.array([time])) == pytest.approx(
        [OSCILLATION.eta * math.cos(angle)], abs=1e-13
    )
    assert refs.heading_rate_at(np.array([time])) == pytest.approx(
        [-OSCILLATION.amplitude * math.sin(angle)], abs=1e-13
    )
    assert refs.mean_course == pytest.approx([0.0], abs=1e-15)


@LAWS
@examples(100)
@given(
    north=offsets, east=offsets, course=courses, reference_course=courses, rate=st.floats(-0.5, 0.5)
)
def test_the_rates_and_commands_of_an_ensemble_are_those_of_the_four_states(
    law, north, east, course, reference_course, rate
):
    there = relative([north, east, reference_course, 0.0, 0.0, course])
    # Near pi, tan(phi/2) magnifies the rounding of phi.
    assume(abs(there.phi) < 3.1)
    motion = MOTIONS[law](VEHICLE, references(course=[reference_course], rate=[rate]))
    time = np.zeros(1)
    state = motion.start(np.array([[north], [east]]), np.array([course]))
    rates = motion.rates(time, state)
    _, omega_rho = relative_velocity(LOOK_AHEAD, there, SPEED, SPEED, rate)
    expected = steer(law, there, omega_rho)
    # Equation (1), twice; the rounding of d = 3 km over z at its shortest, 10 m.
    assert rates[0, 0] == pytest.approx(
        SPEED * (math.cos(reference_course) - math.cos(course)), abs=1e-8
    )
    assert rates[1, 0] == pytest.approx(
        SPEED * (math.sin(reference_course) - math.sin(course)), abs=1e-8
    )
    # Law (24) turns at up to k_1 rho V tan(phi/2) = 4e4 rad/s here; its rounding.
    assert motion.command(time, state, rates)[0] == pytest.approx(expected, rel=1e-9, abs=1e-8)
    assert motion.phi(time, state)[0] == pytest.approx(there.phi, abs=1e-9)
    phi_rate = state_rates(LOOK_AHEAD, there, SPEED, rate, expected).phi
    if law is Steering.LYAPUNOV:
        # sin(phi/2) = sin(phi_0/2) exp(-s), so that the rate of phi is -2 tan(phi/2) times that of
        # s.
        assert -2.0 * math.tan(0.5 * there.phi) * rates[2, 0] == pytest.approx(
            phi_rate, rel=1e-8, abs=1e-8
        )
    elif law is Steering.CASCADE_CUT:
        assert rates[2, 0] == pytest.approx(phi_rate, abs=1e-8)


@LAWS
@pytest.mark.parametrize(
    "refs",
    [references(rate=[0.3]), oscillating(), wandering()],
    ids=["circle", "oscillation", "random"],
)
@pytest.mark.parametrize("start", [(1500.0, -900.0, -2.9), (3.0, 2.0, 0.5)])
def test_an_ensemble_flies_as_the_cartesian_equations_integrated_by_scipy(law, refs, start):
    north, east, course = start
    duration = 12.0
    _, times, states, phis, _ = history(
        law, refs, (-north, -east), course, time_max=duration, tolerances=TIGHT
    )

    def reference_heading_rate(time):
        return float(refs.heading_rate_at(np.array([time]))[0])

    motion = tracking_motion(
        delta_steering(
            lambda there, omega_rho: steer(law, there, omega_rho), reference_heading_rate
        ),
        reference_heading_rate,
    )
    begin = [0.0, 0.0, refs.course[0], north, east, course]
    # Law (24) is stiff in Cartesian coordinates: k_1 rho V = 300 1/s at 1.7 km.
    method = "LSODA" if law is Steering.LYAPUNOV else "DOP853"
    scipy = solve_ivp(
        motion, (0.0, duration), begin, method=method, rtol=1e-9, atol=1e-8, max_step=0.5
    )
    assert scipy.success
    end = scipy.y[:, -1]
    assert times[-1] == duration
    # Two integrations at 1e-9 of up to 2 km; kinks of the cut command cost SciPy's some digits.
    assert states[-1][:2] == pytest.approx([end[0] - end[3], end[1] - end[4]], abs=1e-3)
    assert wrap(phis[-1] - relative(end).phi) == pytest.approx(0.0, abs=1e-4)


@pytest.mark.parametrize(
    "refs",
    [references(rate=[-0.2]), oscillating(), wandering()],
    ids=["circle", "oscillation", "random"],
)
@pytest.mark.parametrize("start", [(-400.0, 250.0, 2.0), (2.0, 1.0, 3.0)])
def test_v_2_never_rises_along_an_ensembles_trajectory_under_law_24(refs, start):
    result, _, states, phis, _ = history(
        Steering.LYAPUNOV, refs, start[:2], start[2], tolerances=TIGHT
    )
    values = 0.5 * (states[:, 0] ** 2 + states[:, 1] ** 2) + (1.0 - np.cos(phis)) / K_1
    # Below equation (26); each step errs by TIGHT's 1e-10 of d, or 1e-9 m.
    assert np.max(np.diff(values) - 2e-10 * values[:-1]) <= 1e-8
    assert result.outcome == (Outcome.CONVERGED,)
    assert values[-1] <= 0.5 * DISTANCE_CONVERGED**2 + 0.5 * 2e-4**2 / K_1
    there = relative([*states[0][:2], refs.course[0], 0.0, 0.0, start[2]])
    # And it is V_2 of equation (25). The squares of rho and delta cancel but for their rounding.
    assert values[0] == pytest.approx(v_2(there, 1.0 / K_1), rel=1e-6)
