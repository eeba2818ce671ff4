import math

import numpy as np
import pytest
from gnc_cases import SPEED, examples, paper_oscillation
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gnc.paper import half_widths, offset

RATIOS = [0.0, 0.1, 0.5, 0.9]
ratios = st.floats(0.0, 0.99)


@pytest.mark.parametrize("nu", RATIOS)
def test_the_orbit_is_equation_2_integrated_less_the_motion_of_the_centre(nu):
    oscillation = paper_oscillation(nu)

    def rates(time, state):
        # Equation (2), phi_0 = 0 and omega_V = 0, the vessel going north.
        return (
            SPEED * math.cos(state[2]),
            SPEED * math.sin(state[2]),
            -oscillation.amplitude * math.sin(oscillation.omega_0 * time),
        )

    times = np.linspace(0.0, 3.0 * oscillation.period, 97)
    solution = solve_ivp(
        rates,
        (0.0, times[-1]),
        [0.0, 0.0, oscillation.eta],
        t_eval=times,
        method="DOP853",
        rtol=1e-11,
        atol=1e-11,
    )
    along, across = offset(oscillation, times)
    # Integration tolerance, 1e-11 of up to 800 m in each of a hundred steps.
    np.testing.assert_allclose(along, solution.y[0] - nu * SPEED * times, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(across, solution.y[1], rtol=0.0, atol=1e-6)


@examples(14)
@given(nu=ratios)
def test_the_half_widths_are_the_largest_offsets_of_the_orbit(nu):
    oscillation = paper_oscillation(nu)
    times = np.linspace(0.0, oscillation.period, 40001)
    along, across = offset(oscillation, times)
    d_x, d_y = half_widths(oscillation)
    # A sample lies within T/80,000 of the extremum, where the offset falls short by half its second
    # derivative times that squared: V_r A (T/80,000)^2/2 = V_r A T pi/(80,000^2 omega_0), below
    # 1e-6 m.
    assert np.max(np.abs(along)) == pytest.approx(d_x, rel=0.0, abs=1e-6)
    assert np.max(np.abs(across)) == pytest.approx(d_y, rel=0.0, abs=1e-6)
    assert np.max(np.abs(along)) <= d_x + 1e-12
    assert np.max(np.abs(across)) <= d_y + 1e-12
