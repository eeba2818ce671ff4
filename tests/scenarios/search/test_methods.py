"""Search methods on problems with a known minimum that random sampling of the same budget misses."""

import functools

import numpy as np
import pytest

from scenarios.search.method import (
    Coordinate,
    Found,
    SearchSettings,
    Space,
    methods_named,
    search_in_turns,
)

pytestmark = pytest.mark.slow


METHODS = ("corners", "differential_evolution", "local", "cma")

POPULATION, TURNS = 32, 60

THIRDS = (0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0)


def space_of(*coordinates, **given):
    return Space(coordinates=coordinates, **given)


def least(methods, space, problem, *, seed=1, turns=TURNS, population=POPULATION):
    """Return the least value of a problem that methods find, and the points that they tried."""
    tried, found = [], []

    def attempt(_, points):
        assert points.shape[1] == space.dimension
        assert ((points >= 0.0) & (points <= 1.0)).all()
        tried.extend(points)
        found.extend(problem(point) for point in points)
        return np.array(found[len(found) - len(points) :])

    settings = SearchSettings(population=population)
    found_methods = methods_named(methods, space, settings, seed)
    search_in_turns(found_methods, space, attempt, population=population, turns=turns)
    assert len(tried) <= turns * population
    return min(found), np.array(tried)


@functools.cache
def least_of_random(space, problem, seed):
    points = np.random.default_rng(seed).random((TURNS * POPULATION, space.dimension))
    return min(problem(point) for point in points)


BOWL = space_of(*[Coordinate()] * 10)

CENTRE = np.linspace(0.1, 0.9, 10)


def bowl(point):
    """A bowl in ten dimensions whose sides are of different steepness: 0 m at its centre."""
    return 100.0 * float(np.linalg.norm((point - CENTRE) * np.linspace(0.5, 2.0, 10)))


def corner(point):
    """1 but for a corner: below 0 where five of ten quantities are within a twentieth of an end."""
    return 1.0 if (point[:5] < 0.95).any() else -float(point[:5].min())


@pytest.mark.parametrize("seed", [1])
@pytest.mark.parametrize("method", ["differential_evolution", "local", "cma"])
def test_a_method_that_learns_finds_the_centre_of_a_bowl_that_random_points_miss(method, seed):
    # 1,920 points: the share of the cube within 0.15 of the centre, by the volume of an ellipsoid,
    # is 7e-9.
    assert least_of_random(BOWL, bowl, seed) > 25.0
    assert least((method,), BOWL, bowl, seed=seed)[0] < 15.0


@pytest.mark.parametrize("seed", range(2))
def test_corner_sampling_finds_a_corner_that_random_points_miss(seed):
    # A random point is in the corner with a probability of 0.05^5 = 3e-7, one of these with about
    # 0.4^5 = 0.01.
    assert least_of_random(BOWL, corner, seed) == 1.0
    assert least(("corners",), BOWL, corner, seed=seed)[0] == -1.0


def rare(point):
    """Matter only with the last choice: least at a corner of two, and where two times are one."""
    if point[0] < 2.0 / 3.0:
        return 50.0 + float(point[1])
    return 40.0 - 20.0 * float(point[1] + point[2]) + 200.0 * abs(float(point[3] - point[4]))


@pytest.mark.parametrize("seed", range(2))
def test_methods_in_turn_find_two_events_at_one_time_with_one_of_the_choices(seed):
    time = Coordinate(time_range=(0.0, 100.0))
    space = space_of(
        Coordinate(choices=THIRDS), *[Coordinate()] * 2, time, time, *[Coordinate()] * 10
    )
    # The least is 0. A random point has the choice in 1 of 3, both quantities in the last 5 % in 1
    # of 400, and times within 0.01 of each other in 1 of 50.
    assert least_of_random(space, rare, seed) > 2.0
    assert least(METHODS, space, rare, seed=seed)[0] < 0.2


@pytest.mark.parametrize("method", METHODS)
def test_a_method_goes_the_same_way_with_the_same_seed_and_another_with_another(method):
    def points(seed):
        return least((method,), BOWL, bowl, seed=seed, turns=6)[1]

    np.testing.assert_array_equal(points(1), points(1))
    assert not np.array_equal(points(1), points(2))


@pytest.mark.parametrize("method", ["local", "cma"])
def test_a_search_around_a_point_begins_at_the_worst_that_others_found(method):
    # A needle: nothing leads to it, but the corners find it, and it is the deeper the nearer the
    # quantities that have no end are.
    time = Coordinate(time_range=(0.0, 1.0))
    space = space_of(*[Coordinate()] * 6, time, time)

    def needle(point):
        return 200.0 if (point[:6] < 0.8).any() else 100.0 * float(np.abs(point[6:] - 0.37).max())

    alone = least((method,), space, needle, turns=2)[0]
    together = least(("corners", method), space, needle, turns=40)[0]
    assert alone == 200.0
    assert together < 1.0


def test_corners_take_every_choice_equally_often_and_put_quantities_at_their_ends():
    endless = Coordinate(circle=True), Coordinate(time_range=(0.0, 9.0))
    space = space_of(Coordinate(choices=THIRDS), Coordinate(), *endless)
    _, tried = least(("corners",), space, lambda _: 0.0, turns=15)
    values, counts = np.unique(tried[:, 0], return_counts=True)
    np.testing.assert_allclose(values, [1.0 / 6.0, 0.5, 5.0 / 6.0])
    assert counts.tolist() == [160, 160, 160]
    ends = ((tried == 0.0) | (tried == 1.0)).mean(axis=0)
    # 0.8 in the mean of the shares, with a standard deviation of 0.02; a course and a time have no
    # ends.
    assert ends[1] == pytest.approx(0.8, abs=0.06)
    assert ends[2:].tolist() == [0.0, 0.0]


def test_what_lies_beyond_the_declared_ranges_is_avoided_by_all_that_propose_freely():
    space = space_of(*[Coordinate()] * 4, beyond=lambda point: max(0.0, float(point.sum()) - 2.0))
    for method in ("corners", "local"):
        _, tried = least((method,), space, lambda point: -float(point.sum()), turns=10)
        assert 1.9 < tried.sum(axis=1).max() <= 2.0


HALVES = (0.0, 0.5, 1.0)


def point(*values):
    return np.array(values)


def test_a_choice_differs_wholly_or_not_at_all_and_noise_never():
    choice, noise = Coordinate(choices=HALVES), Coordinate(choices=HALVES, noise=True)
    differences = [choice.difference(0.1, other) for other in (0.0, 0.49, 0.5, 1.0)]
    assert differences == [0.0, 0.0, 1.0, 1.0]
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
