"""Passes through a plume, of distances from its axis that are written down."""

import itertools

import numpy as np

from measurement.plume.fluctuating_plume import passes


def test_each_pass_runs_half_way_to_the_next_change_of_sides():
    # Changes after samples 2 and 6: the middle is 5; as long before the first and after the last.
    across = np.array([1.0, 1, 1, -1, -1, -1, -1, 1, 1, 1])
    assert list(passes(across)) == [slice(0, 5), slice(5, 7)]


def test_no_pass_is_without_samples_however_soon_the_sides_change():
    assert list(passes(np.array([1.0, 1.0, -1.0, 1.0, 1.0]))) == [slice(0, 2)]
    for signs in itertools.product((-1.0, 1.0), repeat=9):
        across = np.array(signs)
        found = list(passes(across))
        assert all(at.start < at.stop for at in found)
        # Every flight that changes sides has a pass, and no sample belongs to two.
        assert bool(found) == bool(np.any(np.diff(across)))
        assert all(before.stop == after.start for before, after in itertools.pairwise(found))
