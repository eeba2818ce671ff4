"""Intervals of rare probabilities: how often they hold what is true, and what they say where
nothing was reached.
"""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.special import ndtri

from common.intervals import upper_bound
from scenarios.statistics.subset_simulation import (
    curve,
    input_shifts,
    near_event,
    noise_floor,
    rare_probability,
)
from tests.scenarios.statistics.rare_events import DIMENSION, linear, noisy, simulated

pytestmark = pytest.mark.slow

REPEATS = 5


def repeats_of(value, first, **settings):
    return [simulated(value, [20261202, first, i], **settings)[0] for i in range(REPEATS)]


@pytest.mark.parametrize(
    ("value", "probability", "noise"),
    [(linear(1e-7), 1e-7, False), (noisy(1e-4, seed_share=0.1, blend_share=0.5), 1e-4, True)],
    ids=["plane_1e-7", "noise_1e-4"],
)
def test_intervals_hold_the_true_probability_as_often_as_they_claim(value, probability, noise):
    studies = 12 if noise else 20
    found = [
        rare_probability(repeats_of(value, i, flights=200, noise=noise), 0.95)
        for i in range(studies)
    ]
    # Measured with 500 flights a level (docs/explanation/operational_conditions.md): 0.94 to 0.99.
    # Fewer of 20 (12) than are enough here would have a probability below 2 % at 0.95.
    enough = studies - 3
    assert sum(study.low <= probability <= study.high for study in found) >= enough
    assert sum(probability <= study.upper for study in found) >= enough
    assert all(
        study.low < study.estimate < study.high and study.upper < study.high for study in found
    )
    # And they say something: a factor of a hundred at most, in the median.
    assert np.median([study.high / study.low for study in found]) < 100.0


def test_where_no_simulation_reaches_the_event_the_bound_says_what_is_left_open():
    simulations = repeats_of(linear(1e-12), 1, flights=200, levels=4)
    found = rare_probability(simulations, 0.95)
    assert (found.estimate, found.low, found.reached) == (0.0, 0.0, 0)
    # The last level has about 1e-3, and 0 of at most 5 x 20 chains in the event: 1 - 0.025^(1/100)
    # is 0.036 at half of what may go wrong.
    assert 1e-3 * 0.036 < found.upper < 1e-3 * 0.036 * 10.0
    assert found.upper < found.high


def test_the_bound_where_nothing_was_reached_holds_though_chains_can_hardly_move():
    value = noisy(1e-4, seed_share=0.95, blend_share=0.02)
    found = [
        rare_probability(repeats_of(value, i, flights=200, levels=3, noise=True), 0.95)
        for i in range(12)
    ]
    bounds = [study.upper for study in found if not study.reached]
    assert len(bounds) >= 3
    # Of 300 such studies 159 reached nothing, and each of their bounds was true.
    assert min(bounds) >= 1e-4


def test_chains_that_began_at_copies_of_one_state_count_as_one():
    simulations = repeats_of(linear(1e-12), 1, flights=200, levels=4)

    def begun_at_one(simulation):
        last = simulation.levels[-1]
        at = np.arange(len(last.values))
        at[: last.chains.max() + 1] = 0
        return replace(
            simulation,
            levels=(
                *simulation.levels[:-1],
                replace(last, points=last.points[at], values=last.values[at]),
            ),
        )

    copies = [begun_at_one(one) for one in simulations]
    begun, of_copies = (
        [one.levels[-1].beginnings for one in those] for those in (simulations, copies)
    )
    assert all(10 <= count <= 20 for count in begun)
    assert of_copies == [1] * REPEATS
    found, without = rare_probability(copies, 0.95), rare_probability(simulations, 0.95)
    for bound, confidence in (("upper", 0.975), ("high", 0.9875)):
        left_open = [upper_bound(0, sum(counts), confidence) for counts in (of_copies, begun)]
        assert getattr(found, bound) / getattr(without, bound) == pytest.approx(
            left_open[0] / left_open[1], rel=1e-9
        )


def test_the_curve_follows_the_normal_distribution_over_the_whole_range_and_ends_where_the_event_begins():
    simulations = repeats_of(linear(1e-5), 4)
    points = curve(simulations, 0.95)
    values = np.array([value for value, _ in points])
    assert 0.0 in values
    assert (np.diff(values) > 0.0).all()
    inside = [
        point.low <= math.erfc((4.264890793922602 - value) / math.sqrt(2.0)) / 2.0 <= point.high
        for value, point in points
        if point.estimate < 0.5
    ]
    # Points are correlated: all may be inside, and a tenth outside.
    assert np.mean(inside) >= 0.9


def test_what_decides_is_apart_from_what_has_no_effect_by_the_noise_floor():
    def first_counts(points):
        # Only the first input counts; below 0 from its normal coordinate 3.09 on, with 1e-3.
        return 3.09 - ndtri(np.array([point[0] for point in points]))

    simulations = repeats_of(first_counts, 5)
    first = np.concatenate([one.levels[0].points for one in simulations])
    near = np.concatenate(
        [one.levels[-1].points[chosen] for one, chosen in near_event(simulations)]
    )
    names = [f"input_{i}" for i in range(DIMENSION)]
    shifts = input_shifts(
        pd.DataFrame(first, columns=names), pd.DataFrame(near, columns=names), (first, near)
    )
    floor = noise_floor(simulations)
    assert shifts[0].key == "input_0"
    # All that fails has it above 0.999: the distributions hardly overlap.
    assert shifts[0].distance > 0.99
    assert shifts[0].median_near > 0.999
    # Nine others and five dummies are alike: the largest of the nine may exceed that of the five,
    # but not by much.
    assert shifts[1].distance < 2.0 * floor
    assert sum(shifts[0].near) == pytest.approx(1.0, abs=1e-12)
