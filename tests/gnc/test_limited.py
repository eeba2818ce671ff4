import math

import pytest
from gnc_cases import examples
from hypothesis import given
from hypothesis import strategies as st

from gnc.limits import limited


@examples(500)
@given(value=st.floats(allow_nan=False), limit=st.floats(1e-300, 1e300))
def test_a_limited_value_is_what_min_and_max_make_of_it(value, limit):
    assert limited(value, limit) == min(max(value, -limit), limit)


@pytest.mark.parametrize("limit", [0.5, math.inf])
def test_what_is_not_a_number_is_not_made_one(limit):
    # A command that were cut to its limit would hide that the guidance has lost count.
    assert math.isnan(limited(math.nan, limit))
