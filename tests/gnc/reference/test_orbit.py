"""The paper's oscillation, equations (8) and (12): its frequency and its orbit."""

import math

import numpy as np
import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, examples, paper_oscillation
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from common.physics import STANDARD_GRAVITY
from gnc.errors import InfeasibleError
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


@pytest.mark.parametrize("nu", [0.0, 0.1, 0.5, 0.9])
@pytest.mark.parametrize("vessel_heading_rate", [0.0, 0.02, -0.02])
def test_the_reference_spends_what_equation_8_allows(nu, vessel_heading_rate):
    oscillation = paper_oscillation(nu, vessel_heading_rate=vessel_heading_rate)
    # Equation (8) with equality. Tolerances are roundings.
    assert oscillation.omega_0 == pytest.approx(
        (HEADING_RATE_MAX - 0.02 * (vessel_heading_rate != 0.0)) / oscillation.eta, rel=1e-14
    )
    assert oscillation.amplitude + abs(vessel_heading_rate) == pytest.approx(
        HEADING_RATE_MAX, rel=1e-14
    )
    assert oscillation.limit == "heading rate"


@examples(200)
@given(
    nu=st.floats(0.0, 0.9999),
    reserve=st.floats(0.0, 0.9),
    vessel_heading_rate=st.floats(-0.04, 0.04),
    roll_rate_max=st.floats(0.01, 10.0),
)
def test_the_oscillation_is_the_fastest_within_heading_rate_and_roll_rate(
    nu, reserve, vessel_heading_rate, roll_rate_max
):
    oscillation = paper_oscillation(
        nu, reserve=reserve, vessel_heading_rate=vessel_heading_rate, roll_rate_max=roll_rate_max
    )
    heading_rate_use = (oscillation.amplitude + abs(vessel_heading_rate)) / (
        (1.0 - reserve) * HEADING_RATE_MAX
    )
    # By (2), the heading acceleration's amplitude is eta omega_0^2 = g/V times the
    # roll rate.
    roll_rate_use = (
        oscillation.eta * oscillation.omega_0**2 / (STANDARD_GRAVITY / SPEED * roll_rate_max)
    )
    # Neither bound is exceeded and one of them is met, to rounding.
    assert max(heading_rate_use, roll_rate_use) == pytest.approx(1.0, rel=1e-12)
    assert (oscillation.limit == "heading rate") == (heading_rate_use >= roll_rate_use)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"nu": 1.0}, "nu is 1; it must be below 1"),
        ({"nu": math.inf}, "nu is inf; it must be below 1"),
        ({"nu": -0.1}, "nu is -0.1; it must lie within 0 and 1"),
        ({"nu": math.nan}, "nu is nan; it must lie within 0 and 1"),
        # The limit is (1 - reserve) omega_max, from equation (8).
        ({"vessel_heading_rate": 0.503}, "is 0.503 rad/s.* below 0.503 rad/s"),
        ({"vessel_heading_rate": -0.6}, "is -0.6 rad/s.* below 0.503 rad/s"),
        ({"vessel_heading_rate": 0.3, "reserve": 0.5}, "is 0.3 rad/s.* below 0.2515 rad/s"),
        ({"vessel_heading_rate": math.nan}, "is nan rad/s"),
        ({"reserve": 1.0}, "reserve is 1 "),
        ({"speed": 0.0}, "speed is 0 m/s"),
    ],
)
def test_what_cannot_be_flown_is_refused(changes, message):
    with pytest.raises(InfeasibleError, match=message):
        paper_oscillation(**({"nu": 0.5} | changes))
