"""Figures of made-up convergence studies: what is counted and drawn."""

import numpy as np

from extensions.convergence.report import (
    CURVE_POINTS,
    cumulative,
)


def test_a_cumulative_curve_counts_what_never_came_to_pass():
    x, y = cumulative(np.array([3.0, np.nan, 1.0, 2.0]))
    assert x.tolist() == [1.0, 1.0, 2.0, 3.0]
    assert y.tolist() == [0.0, 0.25, 0.5, 0.75]
    none, shares = cumulative(np.array([np.nan]))
    assert len(none) == len(shares) == 0


def test_a_cumulative_curve_is_thinned_and_keeps_its_ends():
    values = np.random.default_rng(4).uniform(size=5000)
    x, y = cumulative(values)
    assert len(x) == CURVE_POINTS + 1
    assert (x[0], x[-1]) == (values.min(), values.max())
    assert (y[0], y[-1]) == (0.0, 1.0)
    assert np.all(np.diff(y) > 0.0)
    # Of 5000 values no larger than x, the share is exact at every point kept.
    assert y[100] == np.mean(values <= x[100])
