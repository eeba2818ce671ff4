"""Section IV.D by machine: the cascade of equations (31) to (35), and what is true of its argument
for bounded trajectories.
"""

import math

import numpy as np
import pytest
from cascade_cases import cartesian_v_1_rate, fly_law_30, gains, rates_max
from gnc_cases import (
    LOOK_AHEAD,
    OSCILLATION,
    SPEED,
    courses,
    examples,
    moved,
    oscillating,
    relative,
    tracking_starts,
)
from hypothesis import given
from hypothesis import strategies as st

from gnc.paper import (
    DrivenState,
    RelativeState,
    cascade_law,
    driven_rates,
    driving_rate,
    relative_velocity,
    state_rates,
    unforced_rates,
    v_1_rate,
    v_1_rate_split,
    v_1_unforced_rate,
    v_1_unforced_second_rate,
)

heading_rates = st.floats(-0.5, 0.5)
speeds = st.floats(5.0, 40.0)
# Any numbers, also those that no place of vehicle and reference has: as algebra the equations do
# not know of (15).
any_driven = st.builds(DrivenState, st.floats(60.0, 3000.0), st.floats(10.0, 3000.0), courses)


@examples(200)
@given(
    driven=any_driven,
    phi=courses,
    speed=speeds,
    reference_heading_rate=heading_rates,
    gain=gains,
    rate_max=rates_max,
)
def test_under_law_30_the_system_21_is_the_cascade_31(
    driven, phi, speed, reference_heading_rate, gain, rate_max
):
    state = RelativeState(*driven, phi)
    _, omega_rho = relative_velocity(LOOK_AHEAD, state, speed, speed, reference_heading_rate)
    whole = state_rates(
        LOOK_AHEAD,
        state,
        speed,
        reference_heading_rate,
        cascade_law(phi, omega_rho, gain, rate_max),
    )
    # (31a) is exact: the same lines. In (31b) omega_rho cancels but for its rounding; it reaches
    # some 1e4 rad/s where rho is short and delta long.
    assert whole[:3] == driven_rates(LOOK_AHEAD, driven, phi, speed, reference_heading_rate)
    assert whole.phi == pytest.approx(
        driving_rate(phi, gain, rate_max), rel=0.0, abs=1e-15 * abs(omega_rho) + 1e-15
    )


@examples(100)
@given(driven=any_driven, speed=speeds, reference_heading_rate=heading_rates)
def test_equation_32_is_as_printed_but_for_the_factor_v_r_that_its_first_line_lacks(
    driven, speed, reference_heading_rate
):
    delta, rho, phi_r = driven
    epsilon, c_r, s_r = LOOK_AHEAD.epsilon, math.cos(phi_r), math.sin(phi_r)
    printed = (
        -2.0 * epsilon * (rho + delta) * (1.0 - c_r),
        -speed * (1.0 - c_r)
        - delta * reference_heading_rate * s_r
        - 2.0 * epsilon * speed * c_r * (rho + delta) * (1.0 - c_r),
        reference_heading_rate
        - (
            speed * s_r
            + delta * reference_heading_rate * c_r
            - 2.0 * epsilon * speed * s_r * (rho + delta) * (1.0 - c_r)
        )
        / rho,
    )
    rates = unforced_rates(LOOK_AHEAD, driven, speed, reference_heading_rate)
    # Roundings of terms up to 1e4 m/s, over no less than 10 m.
    assert rates == pytest.approx((speed * printed[0], printed[1], printed[2]), rel=0.0, abs=1e-10)


@examples(200)
@given(driven=any_driven, speed=speeds)
def test_equation_33_is_23_at_phi_zero_and_never_positive(driven, speed):
    unforced = v_1_unforced_rate(driven, speed)
    # Rounding of 40 m/s * 6 km * 2.
    assert unforced == pytest.approx(
        v_1_rate(RelativeState(*driven, 0.0), speed), rel=0.0, abs=1e-9
    )
    assert unforced <= 0.0


@examples(150)
@given(start=tracking_starts(phi_max=0.0), time=st.floats(0.0, 20.0))
def test_equation_34_is_the_numerical_rate_of_33_along_the_unforced_system(start, time):
    def motion(moment, driven):
        return np.array(
            unforced_rates(LOOK_AHEAD, DrivenState(*driven), SPEED, oscillating(moment))
        )

    here = DrivenState(*relative(start)[:3])
    step = 1e-5
    ahead, behind = (DrivenState(*moved(motion, time, here, way)) for way in (step, -step))
    numerical = (v_1_unforced_rate(ahead, SPEED) - v_1_unforced_rate(behind, SPEED)) / (2.0 * step)
    acceleration = v_1_unforced_second_rate(here, DrivenState(*motion(time, here)), SPEED)
    # Over 3,000 random states it erred by 1.3e-5 m^2/s^2, a hundred times more at ten times the
    # step; corners are allowed some ten times that. The second rate itself reaches 6e3.
    assert acceleration == pytest.approx(numerical, rel=0.0, abs=2e-4)


@examples(300)
@given(start=tracking_starts(), share=st.floats(-1.0, 1.0))
def test_distance_does_not_rise_where_phi_is_within_phi_r(start, share):
    # Turn the vehicle so that |phi| <= |phi_r|.
    there = relative(start)
    state = [*start[:5], start[5] - there.phi + share * there.phi_r]
    # Equation (35): no term is positive there. First in Cartesian coordinates, where roundings
    # reach 1e-16 of 424 m * 39 m/s and of the angles through z, 5e-16 of delta's 1 km times 39 m/s;
    # then by the equation, without.
    assert cartesian_v_1_rate(state) <= 1e-10
    assert v_1_rate_split(there._replace(phi=share * there.phi_r), SPEED) <= 0.0


def test_the_distance_can_rise_again_after_phi_was_first_within_phi_r():
    # Section IV.D says that it cannot, from the first such instant on. But phi_r passes through
    # zero while phi still dies out.
    start = [0.0, 0.0, OSCILLATION.eta, -150.0, 0.0, 2.0]
    times, states, distances = fly_law_30(
        start, oscillating, gain=0.1, rate_max=0.4, duration=40.0, interval=0.02
    )
    within = np.array([abs(state.phi) <= abs(state.phi_r) for state in states])
    first = int(np.argmax(within))
    after = distances[first:]
    # Measured once, to the tenth: phi is first within phi_r after 9.0 s, later outside again, and d
    # rises by 1.5 m.
    assert times[first] == pytest.approx(9.0, abs=0.1)
    assert np.count_nonzero(~within[first:]) > 0
    assert np.max(after - np.minimum.accumulate(after)) == pytest.approx(1.5, abs=0.1)
