import math

import numpy as np

from scenarios.measures.figures import rms


def test_the_rms_of_a_sine_over_its_period_is_its_amplitude_over_the_root_of_two():
    phase = 2.0 * np.pi * np.arange(64) / 64
    # Exact for equally spaced samples, up to rounding.
    assert math.isclose(rms(3.0 * np.sin(phase)), 3.0 / math.sqrt(2.0), rel_tol=1e-14)
