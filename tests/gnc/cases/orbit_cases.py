"""What the tests of orbits of any shape share."""

import math

import numpy as np
import pytest
from gnc_cases import SPEED
from scipy.integrate import solve_ivp


def assert_a_point_that_turns_so_flies(orbit, nu, start):
    """Integrate a point from a place and course, turning at the orbit's heading rate; its path is
    that of the orbit's offsets.
    """

    def motion(time, state):
        return (
            SPEED * math.cos(state[2]),
            SPEED * math.sin(state[2]),
            orbit.heading_rate(orbit.omega_0 * time),
        )

    times = np.linspace(0.0, orbit.period, 41)
    along, right = orbit.offset(times)
    flown = solve_ivp(
        motion, (0.0, orbit.period), start, t_eval=times, max_step=0.02, rtol=1e-9, atol=1e-9
    ).y
    # Steps of 0.02 s over corners of the roll rate of 0.7 rad/s^2: 1e-5 m each, and that of the
    # path's spline.
    assert along + nu * SPEED * times == pytest.approx(flown[0], rel=0.0, abs=1e-3)
    assert right == pytest.approx(flown[1], rel=0.0, abs=1e-3)
