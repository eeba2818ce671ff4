import math

import numpy as np
import pytest
from gnc_cases import examples
from hypothesis import example, given
from hypothesis import strategies as st

from gnc.numeric import wrap, wrapped


@examples(500)
@given(angle=st.floats(-1e6, 1e6))
@example(angle=math.pi)
@example(angle=-math.pi)
@example(angle=math.nextafter(math.pi, 0.0))
@example(angle=math.nextafter(-math.pi, -4.0))
@example(angle=-3.0 * math.pi)
@example(angle=1e300)
def test_wrapped_angles_lie_within_half_a_turn(angle):
    assert -math.pi <= wrap(angle) < math.pi


@examples(200)
@given(angle=st.floats(-1e4, 1e4))
def test_angles_of_an_array_are_wrapped_as_one_angle_is(angle):
    found = wrapped(np.array([[angle, angle + 2.0 * math.pi]]))
    assert found.shape == (1, 2)
    assert np.abs(found).max() <= math.pi + 1e-11
    # Half a turn may stay on either side.
    assert np.cos(found) == pytest.approx(math.cos(wrap(angle)), abs=1e-11)
    assert np.sin(found) == pytest.approx(math.sin(wrap(angle)), abs=1e-11)
