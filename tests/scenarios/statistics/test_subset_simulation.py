"""Subset simulation of events whose probabilities are known, and beside OpenTURNS' own."""

import math

import numpy as np
import pytest
from scipy.special import ndtr

from scenarios.statistics.subset_simulation import variation
from tests.scenarios.statistics.rare_events import (
    DIMENSION,
    four_branches,
    four_branches_probability,
    linear,
    noisy,
    simulated,
)

pytestmark = pytest.mark.slow


def estimates(value, count, **settings):
    return np.array(
        [simulated(value, [20261201, i], **settings)[0].below(0.0) for i in range(count)]
    )


def standard_error(found):
    return found.std(ddof=1) / math.sqrt(len(found))


@pytest.mark.parametrize(("probability", "count"), [(1e-3, 30), (1e-7, 40)])
def test_the_mean_of_many_simulations_is_the_probability_of_a_plane(probability, count):
    found = estimates(linear(probability), count)[:, 0]
    # Thresholds from the same sample make the estimate biased by the order of 1/flights (Au and
    # Beck 2001), here up to 15 %; beside it four standard errors are allowed.
    assert abs(found.mean() - probability) < 0.15 * probability + 4.0 * standard_error(found)
    # Measured of 200 simulations of 500 flights a level: 0.36 at 1e-3, 0.82 at 1e-7.
    assert found.std() < 1.3 * probability


def test_a_rare_event_takes_thousands_of_flights_where_plain_sampling_takes_a_billion():
    found, evaluated = simulated(linear(1e-7), 3)
    # Seven levels or eight, of which all but the first one keep a tenth.
    assert 500 + 5 * 450 <= evaluated <= 500 + 8 * 450
    assert evaluated == sum(level.counts.evaluated for level in found.levels)


def test_four_branches_in_as_many_directions_are_all_found():
    # 3.5 has a probability near 1e-3, and 4.9 near 2e-6; the published case is 3, with 4.46e-3
    # (Schueremans and Van Gemert).
    assert four_branches_probability(3.0) == pytest.approx(4.46e-3, rel=0.01)
    for distance in (3.5, 4.9):
        probability = four_branches_probability(distance)
        found = estimates(four_branches(distance), 16)[:, 0]
        assert abs(found.mean() - probability) < 0.15 * probability + 4.0 * standard_error(found)


def test_openturns_finds_the_same_with_the_same_effort():
    # Here, where one of the processes that run tests imports it: it takes half a second.
    import openturns as ot

    def openturns_estimate(value, seed):
        def wrapped(sample):
            # OpenTURNS works in standard normal space, and this project in the unit cube.
            return value(ndtr(np.array(sample))).reshape(-1, 1)

        ot.RandomGenerator.SetSeed(seed)
        function = ot.PythonFunction(DIMENSION, 1, func_sample=wrapped)
        vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(DIMENSION)))
        algorithm = ot.SubsetSampling(ot.ThresholdEvent(vector, ot.Less(), 0.0))
        algorithm.setConditionalProbability(0.1)
        algorithm.setMaximumOuterSampling(10)
        algorithm.setBlockSize(50)
        algorithm.run()
        return algorithm.getResult().getProbabilityEstimate()

    for value, probability in (
        (linear(1e-5), 1e-5),
        (four_branches(4.0), four_branches_probability(4.0)),
    ):
        theirs = np.array([openturns_estimate(value, seed) for seed in range(12)])
        ours = estimates(value, 15)[:, 0]
        assert abs(ours.mean() - theirs.mean()) < 0.15 * probability + 4.0 * math.hypot(
            standard_error(ours), standard_error(theirs)
        )


def test_noise_belongs_to_the_event_whether_it_moves_by_small_steps_or_is_renewed():
    # Noise of one seed alone at a tenth of the variance, and the blend at half of it: as inputs,
    # turbulence and reports share it.
    value = noisy(1e-4, seed_share=0.1, blend_share=0.5)
    found = estimates(value, 12, noise=True, flights=300)[:, 0]
    assert abs(found.mean() - 1e-4) < 0.15e-4 + 4.0 * standard_error(found)
    simulation, _ = simulated(value, 5, noise=True, flights=300)
    last = simulation.levels[-1].counts
    # A fifth of the moves are renewals; four standard deviations of that count.
    moves = last.moved + last.blended + last.renewed
    assert abs(last.renewed - 0.2 * moves) < 4.0 * math.sqrt(0.16 * moves)
    assert 0.05 < last.renewed_accepted / last.renewed < 0.9


def test_the_same_noise_is_kept_while_inputs_move_and_a_renewal_moves_nothing_else():
    seen = []

    def value(points):
        seen.append(points)
        return linear(1e-3)(points)

    simulated(value, 1, noise=True, levels=2)
    first, wave = seen[:2]
    known = {point[DIMENSION] for point in first}
    blends, inputs = (
        {point[part] for point in first} for part in (slice(DIMENSION + 1, None), slice(DIMENSION))
    )
    kinds = [
        (point[:DIMENSION] in inputs, point[DIMENSION] in known, point[DIMENSION + 1 :] in blends)
        for point in wave
    ]
    # Exactly one of inputs, seed and blend is new, and each of them in some of the moves.
    assert set(kinds) == {(False, True, True), (True, False, True), (True, True, False)}
    for point in wave:
        # Squares of the weights add up to 1: rounding of two products.
        assert sum(weight**2 for weight in point[DIMENSION + 2 :: 2]) == pytest.approx(
            1.0, abs=1e-12
        )


def test_points_that_are_not_allowed_are_never_evaluated_and_the_rest_is_as_declared():
    seen = []

    def value(points):
        seen.extend(points)
        return linear(1e-3)(points)

    simulated(value, 2, allowed=lambda at: at[0] < 0.5)
    assert max(point[0] for point in seen) < 0.5
    first = np.array(seen[:500])[:, 0]
    # Uniform below 0.5: the mean of 500 is good to 0.5/sqrt(12 500) = 0.0065; three times that.
    assert first.mean() == pytest.approx(0.25, abs=0.02)


def test_correlation_within_chains_widens_the_variation():
    # Ten chains of ten: all states of a chain alike is as good as ten states.
    chains = np.tile(np.arange(10), 10)
    event = np.tile(np.arange(10) < 3, 10)
    # The formula sums 1 + 2 sum (1 - k/10) over k = 1 to 9, which is 10.
    assert variation(event, chains) == pytest.approx(math.sqrt(0.7 / (0.3 * 10.0)), rel=1e-9)
