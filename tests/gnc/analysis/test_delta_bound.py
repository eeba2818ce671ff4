"""The bound on the look-ahead delta along flights under law (30): EQUATIONS.md, "Why trajectories
are bounded".
"""

import math

import numpy as np
import pytest
from cascade_cases import LAW_30_FLIGHTS, cartesian_v_1_rate, fly_law_30, gains, rates_max
from gnc_cases import LOOK_AHEAD, SPEED, courses, examples, relative, tracking_starts
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from gnc.paper import delta_bound, excursion_time, h, look_ahead


@examples(100)
@given(phi=st.floats(-math.pi, math.pi), gain=gains, rate_max=rates_max)
def test_the_excursion_time_is_the_integral_of_one_minus_cos_phi_along_31b(phi, gain, rate_max):
    # Time runs as -dphi/h(phi) along (31b); the integrand is 0/0 at 0, where it goes to 0, and has
    # a kink where h is held.
    expected, _ = quad(
        lambda angle: (1.0 - math.cos(angle)) / h(angle, gain, rate_max) if angle > 0.0 else 0.0,
        0.0,
        abs(phi),
        points=[min(rate_max / gain, abs(phi))],
        epsabs=1e-11,
        epsrel=1e-11,
    )
    # Quadrature's tolerance.
    assert excursion_time(phi, gain, rate_max) == pytest.approx(expected, rel=1e-9, abs=1e-10)


@examples(200)
@given(start=tracking_starts(), epsilon=st.floats(1e-3, 0.1), excess=st.floats(1.001, 50.0))
def test_delta_grows_no_faster_than_the_bound_says(start, epsilon, excess):
    parameters = look_ahead(epsilon, excess / (4.0 * epsilon))
    state = relative(start, parameters)
    # EQUATIONS.md, "Why trajectories are bounded": delta-dot = 2 epsilon V_1-dot, V_1-dot <= rho
    # V_r (1 - cos phi) by (35), and rho <= delta + d <= delta (1 + 1/(2 sqrt(epsilon R))). Relative
    # roundings, of delta 100 times the least.
    share = 1.0 + 0.5 / math.sqrt(epsilon * parameters.radius)
    assert state.rho <= share * state.delta * (1.0 + 1e-14)
    rate = 2.0 * epsilon * cartesian_v_1_rate(start)
    limit = 2.0 * epsilon * SPEED * share * state.delta * (1.0 - math.cos(state.phi))
    assert rate <= limit + 1e-12 * epsilon * SPEED * state.delta


@examples(100)
@given(epsilon=st.floats(1e-3, 0.1), excess=st.floats(1.001, 50.0), reference_course=courses)
def test_rho_reaches_its_largest_share_of_delta_right_behind_the_reference(
    epsilon, excess, reference_course
):
    parameters = look_ahead(epsilon, excess / (4.0 * epsilon))
    # d/(epsilon d^2 + R) is largest at d = sqrt(R/epsilon), and rho = delta + d with the vehicle
    # right behind.
    d = math.sqrt(parameters.radius / epsilon)
    place = -d * math.cos(reference_course), -d * math.sin(reference_course)
    state = relative([0.0, 0.0, reference_course, *place, 0.0], parameters)
    assert state.rho / state.delta == pytest.approx(
        1.0 + 0.5 / math.sqrt(epsilon * parameters.radius), rel=1e-13
    )


@examples(25)
@given(**LAW_30_FLIGHTS)
def test_along_flights_under_law_30_delta_stays_below_its_bound(
    start, gain, rate_max, reference_heading_rate
):
    _, states, _ = fly_law_30(
        start, reference_heading_rate, gain=gain, rate_max=rate_max, duration=60.0, interval=0.25
    )
    # At every instant, for what is left to come from there; 1e-6 for the integration's 1e-8 over
    # some hundred steps.
    left = np.array([delta_bound(LOOK_AHEAD, state, SPEED, gain, rate_max) for state in states])
    deltas = np.array([state.delta for state in states])
    ever_after = np.maximum.accumulate(deltas[::-1])[::-1]
    assert np.all(ever_after <= left * (1.0 + 1e-6))
    # And the bound itself never rises along a flight, as it grows in delta and phi just as fast as
    # they may.
    assert np.all(np.diff(left) <= 1e-6 * left[:-1])
