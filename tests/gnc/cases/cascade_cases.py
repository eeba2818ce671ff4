"""What the tests of the cascade (31) share."""

import math

import numpy as np
from gnc_cases import (
    SPEED,
    circling,
    delta_steering,
    oscillating,
    relative,
    tracking_motion,
    tracking_starts,
)
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from gnc.paper import cascade_law

gains = st.floats(0.05, 5.0)
rates_max = st.floats(0.05, 1.0)

LAW_30_FLIGHTS = {
    "start": tracking_starts(phi_max=3.1),
    "gain": st.floats(0.1, 2.0),
    "rate_max": st.floats(0.1, 0.5),
    "reference_heading_rate": st.sampled_from([oscillating, circling]),
}
"""Starts, parameters and references of flights under law (30)."""


def cascade_steering(gain, rate_max, reference_heading_rate):
    return delta_steering(
        lambda state, omega_rho: cascade_law(state.phi, omega_rho, gain, rate_max),
        reference_heading_rate,
    )


def fly_law_30(start, reference_heading_rate, *, gain, rate_max, duration, interval):
    """Fly (30) in Cartesian coordinates; return times, relative states and distances [m] every
    ``interval`` seconds.
    """
    motion = tracking_motion(
        cascade_steering(gain, rate_max, reference_heading_rate), reference_heading_rate
    )
    times = np.linspace(0.0, duration, round(duration / interval) + 1)
    solution = solve_ivp(
        motion, (0.0, duration), start, t_eval=times, max_step=0.25, rtol=1e-8, atol=1e-8
    )
    assert solution.success
    north, east = solution.y[0] - solution.y[3], solution.y[1] - solution.y[4]
    return times, [relative(state) for state in solution.y.T], np.hypot(north, east)


def cartesian_v_1_rate(state):
    """d . (v_r - v) [m^2/s], nothing of the delta formulation."""
    return (state[0] - state[3]) * SPEED * (math.cos(state[2]) - math.cos(state[5])) + (
        state[1] - state[4]
    ) * SPEED * (math.sin(state[2]) - math.sin(state[5]))
