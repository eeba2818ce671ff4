import math

import numpy as np
import pytest
from gnc_cases import examples
from hypothesis import example, given
from hypothesis import strategies as st

from gnc.numeric import clip, limited, wrap, wrapped

# The last floating-point number below pi, and the first beyond -pi: where wrap functions go wrong.
BELOW_HALF_TURN = math.nextafter(math.pi, 0.0)
BEYOND_HALF_TURN = math.nextafter(-math.pi, -4.0)
ULP = math.ulp(math.pi)

angles = st.floats(-1e6, 1e6)


@examples(500)
@given(angle=angles)
@example(angle=math.pi)
@example(angle=-math.pi)
@example(angle=BELOW_HALF_TURN)
@example(angle=-BELOW_HALF_TURN)
@example(angle=BEYOND_HALF_TURN)
@example(angle=-BEYOND_HALF_TURN)
@example(angle=3.0 * math.pi)
@example(angle=-3.0 * math.pi)
@example(angle=2.0 * math.pi)
@example(angle=-2.0 * math.pi)
@example(angle=1e300)
def test_wrapped_angles_lie_within_half_a_turn(angle):
    assert -math.pi <= wrap(angle) < math.pi


@pytest.mark.parametrize("turns", [-3, -2, -1, 0, 1, 2])
def test_half_a_turn_either_way_wraps_to_minus_half_a_turn(turns):
    # The interval is
    # [-pi, pi), as wrap's docstring says. Exact: odd multiples of pi are fmod'ed without rounding.
    assert wrap((2 * turns + 1) * math.pi) == -math.pi


@examples(300)
@given(angle=st.floats(-math.pi, math.pi - 4.0 * ULP))
def test_an_angle_within_half_a_turn_stays(angle):
    # One rounding of the sum with pi.
    assert wrap(angle) == pytest.approx(angle, rel=0.0, abs=ULP)


@examples(300)
@given(angle=st.floats(-1e3, 1e3))
def test_a_wrapped_angle_points_the_same_way(angle):
    # 160 turns of the rounding of 2 pi, 2.4e-16 each, and that of the sum.
    assert math.cos(wrap(angle)) == pytest.approx(math.cos(angle), rel=0.0, abs=2e-13)
    assert math.sin(wrap(angle)) == pytest.approx(math.sin(angle), rel=0.0, abs=2e-13)


@examples(500)
@given(value=st.floats(allow_nan=False), limit=st.floats(1e-300, 1e300))
def test_a_limited_value_is_what_min_and_max_make_of_it(value, limit):
    assert limited(value, limit) == min(max(value, -limit), limit)


@pytest.mark.parametrize("limit", [0.5, math.inf])
def test_what_is_not_a_number_is_not_made_one(limit):
    # A command that were cut to its limit would hide that the guidance has lost count.
    assert math.isnan(limited(math.nan, limit))
    assert math.isnan(clip(math.nan, -limit, limit))


@examples(500)
@given(value=st.floats(allow_nan=False), low=st.floats(-1e300, 1e300), width=st.floats(0.0, 1e300))
def test_a_clipped_value_is_what_min_and_max_make_of_it(value, low, width):
    assert clip(value, low, low + width) == min(max(value, low), low + width)


@examples(200)
@given(angle=st.floats(-1e4, 1e4))
def test_angles_of_an_array_are_wrapped_as_one_angle_is(angle):
    found = wrapped(np.array([[angle, angle + 2.0 * math.pi]]))
    assert found.shape == (1, 2)
    assert np.abs(found).max() <= math.pi + 1e-11
    # Half a turn may stay on either side.
    assert np.cos(found) == pytest.approx(math.cos(wrap(angle)), abs=1e-11)
    assert np.sin(found) == pytest.approx(math.sin(wrap(angle)), abs=1e-11)
