import math

import pytest
from gnc_cases import HEADING_RATE_MAX, SPEED, examples, paper_oscillation
from hypothesis import given
from hypothesis import strategies as st

from common.physics import STANDARD_GRAVITY
from gnc.errors import InfeasibleError


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
    ("ratios", "words"),
    [
        ((1.0, 1.2, math.inf), "must be below 1.*never crosses.*outruns.*fly faster"),
        ((-0.1, math.nan, -math.inf), "must lie within 0 and 1"),
    ],
    ids=["as fast as the UAV", "no ratio"],
)
def test_a_speed_ratio_that_cannot_be_flown_is_refused(ratios, words):
    for nu in ratios:
        with pytest.raises(InfeasibleError, match=rf"speed ratio nu is {nu:g}.*{words}"):
            paper_oscillation(nu)


@pytest.mark.parametrize(
    ("vessel_heading_rate", "reserve", "limit"),
    [
        (0.503, 0.0, "0.503"),
        (-0.6, 0.0, "0.503"),
        (0.3, 0.5, "0.2515"),
        (math.nan, 0.0, "0.503"),
        (-math.inf, 0.0, "0.503"),
    ],
)
def test_a_vessel_that_turns_as_fast_as_the_uav_can_is_refused(vessel_heading_rate, reserve, limit):
    # The limit is (1 - reserve) omega_max, from equation (8).
    with pytest.raises(
        InfeasibleError, match=r"vessel heading rate is .*raise omega_max or lower the reserve"
    ) as refusal:
        paper_oscillation(0.5, vessel_heading_rate=vessel_heading_rate, reserve=reserve)
    message = str(refusal.value)
    assert f"is {vessel_heading_rate:g} rad/s" in message
    assert f"below {limit} rad/s" in message
