import numpy as np
import pytest
from plume_cases import plume_behind, puffs, turning

from measurement.plume.parcels import Parcels

SETTINGS = {"meander": False, "age_max": 250.0}


def around(of, when, spacing=12.0, youngest=12.0):
    """Places around the axis at a time, at the height of its middle."""
    north, east, up = of.axis(when, np.arange(youngest, 200.0, 1.0))
    grid = np.meshgrid(
        *(np.arange(axis.min() - 80.0, axis.max() + 80.0, spacing) for axis in (north, east))
    )
    places = [axis.ravel() for axis in grid]
    near = np.min(np.hypot(places[0][:, None] - north, places[1][:, None] - east), axis=1) < 90.0
    return places[0][near], places[1][near], np.full(near.sum(), np.median(up))


# Ship's speed, wind, the course that it blows to, rad/s of the turn by 180 degrees, a time within
# the turn or after it, and the largest difference over the largest reference. What is left are
# second-order terms of spread over radius of curvature and of the apparent wind's change along a
# spread. The line of the last one folds where the spread is three quarters of its radius, at 3 m/s.
CASES = [
    (8.0, 0.0, 0.0, 0.02, 200.0, 0.01),
    (10.0, 5.0, 3.1, 0.015, 110.0, 0.01),
    (8.0, 4.0, 0.0, 0.02, 80.0, 0.05),
    (8.0, 5.0, 1.5, 0.02, 200.0, 0.2),
]


@pytest.mark.parametrize("case", CASES, ids=str)
def test_the_plume_of_a_turning_ship_is_that_of_a_sum_of_puffs(case):
    speed, wind, wind_to, rate, when, worst = case
    track = turning(speed, wind, wind_to, rate=rate)
    of = plume_behind(track, **SETTINGS)
    places = around(of, when)
    sample = of.sample(np.full(len(places[0]), when), *places)
    reference = puffs(track, 7.0, when, places, interval=0.4, **SETTINGS)
    # Within 100 m of the stack puffs reach ahead of it and along a steep axis, which a slender
    # plume does not.
    there = sample.distance > 100.0
    error = np.abs(sample.dilution - reference)[there] / reference[there].max()
    assert there.sum() > 500
    assert error.max() < worst
    assert np.sqrt(np.mean(error**2)) < 0.2 * worst
    assert sample.dilution[there].sum() == pytest.approx(reference[there].sum(), rel=0.02)


def test_both_arms_of_a_folded_line_are_added():
    # A ship that comes back 60 m beside its own track: 3 m/s of wind carries nothing apart, and the
    # arms overlap.
    track = turning(6.0, 0.0, 0.0, rate=0.2, until=120.0)
    of = plume_behind(track, **SETTINGS)
    when = 110.0
    north, east, up = of.axis(when, np.array([60.0]))
    across = np.linspace(-20.0, 80.0, 51)
    places = (np.full(51, north[0]), east[0] - across, np.full(51, up[0]))
    sample = of.sample(np.full(51, when), *places)
    reference = puffs(track, 7.0, when, places, **SETTINGS)
    # Both arms are straight there: the difference is that of ages along puffs of 20 m at 6 m/s.
    np.testing.assert_allclose(sample.dilution, reference, atol=0.03 * reference.max())
    # The nearest parcel is of one arm, and then of the other: their ages are 110 s of steaming
    # apart.
    assert np.ptp(sample.age) > 60.0


def test_every_nearest_parcel_is_found_once():
    """Against a search over a fine grid: places about a line that folds, and what an exhaustive
    search finds.
    """
    track = turning(8.0, 4.0, 1.0)
    parcels = Parcels(*track, 1.0)
    generator = np.random.default_rng(2)
    grid = np.arange(parcels.start, parcels.end, 0.05)
    north, east, _ = parcels.at(grid)
    k = generator.integers(0, len(grid), 200)
    place = np.array([north[k], east[k]]) + generator.uniform(-60.0, 60.0, (2, 200))
    found = parcels.nearest(place[0], place[1], parcels.start, parcels.end)
    for i in range(200):
        square = (north - place[0, i]) ** 2 + (east - place[1, i]) ** 2
        lowest = grid[1:-1][(square[1:-1] < square[:-2]) & (square[1:-1] <= square[2:])]
        times = np.sort(found.emitted[found.place == i])
        # To the grid's step.
        np.testing.assert_allclose(times, lowest, atol=0.06)
