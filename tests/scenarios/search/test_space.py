"""The space of a search: what its coordinates mean, and which points count as alike."""

import numpy as np
import pytest

from scenarios.search.method import Coordinate, Found, Space

HALVES = (0.0, 0.5, 1.0)


def point(*values):
    return np.array(values)


def test_a_choice_differs_wholly_or_not_at_all_and_noise_never():
    choice, noise = Coordinate(choices=HALVES), Coordinate(choices=HALVES, noise=True)
    assert [choice.difference(0.1, other) for other in (0.0, 0.49, 0.5, 1.0)] == [
        0.0,
        0.0,
        1.0,
        1.0,
    ]
    assert noise.difference(0.0, 1.0) == 0.0
    assert choice.values == (0.25, 0.75)
    # A choice that has no weight is never taken.
    assert Coordinate(choices=(0.0, 0.5, 0.5, 1.0)).values == (0.25, 0.75)


def test_two_times_are_made_equal_within_both_ranges():
    one, other = Coordinate(time_range=(0.0, 100.0)), Coordinate(time_range=(50.0, 250.0))
    apart = Coordinate(time_range=(300.0, 400.0))
    space = Space(coordinates=(one, Coordinate(), other, apart))
    assert space.time_pairs == ((0, 2),)
    generator = np.random.default_rng(1)
    for _ in range(20):
        moved = space.with_equal_times(point(0.9, 0.3, 0.9, 0.9), generator)
        assert 100.0 * moved[0] == pytest.approx(50.0 + 200.0 * moved[2])
        assert 50.0 <= 100.0 * moved[0] <= 100.0
        assert moved[[1, 3]].tolist() == [0.3, 0.9]


def test_the_worst_point_apart_from_those_that_were_used_is_one_unlike_them():
    space = Space(coordinates=(Coordinate(), Coordinate()))
    found = Found(space)
    assert found.worst() is None
    found.add(np.array([[0.1, 0.1], [0.9, 0.9], [0.12, 0.1]]), [1.0, 3.0, 2.0])
    assert found.worst()[1] == 1.0
    assert found.worst(apart_from=[point(0.1, 0.1)])[1] == 3.0
    assert found.worst(apart_from=[point(0.1, 0.1), point(0.9, 0.9)]) is None
    # What violates is known, and so is what is like it.
    found.add(np.array([[0.9, 0.88]]), [-1.0])
    assert found.worst(apart_from=[point(0.1, 0.1)]) is None
    assert found.worst()[1] == 1.0
