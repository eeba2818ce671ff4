"""Subset simulation of rare events whose probabilities are known, and beside OpenTURNS."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.special import ndtr, ndtri

from common.intervals import upper_bound
from scenarios.statistics.subset_simulation import (
    curve,
    input_shifts,
    near_event,
    noise_floor,
    rare_probability,
    variation,
)
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
    found = [simulated(value, [20261201, i], **settings)[0] for i in range(count)]
    return np.array([simulation.below(0.0) for simulation in found])


def standard_error(found):
    return found.std(ddof=1) / math.sqrt(len(found))


@pytest.mark.parametrize(("probability", "count"), [(1e-3, 30), (1e-7, 25)])
def test_the_mean_of_many_simulations_is_the_probability_of_a_plane(probability, count):
    found = estimates(linear(probability), count)[:, 0]
    # Thresholds from the same sample make the estimate biased by the order of 1/flights (Au and
    # Beck 2001), here up to 15 %; beside it four standard errors are allowed.
    assert abs(found.mean() - probability) < 0.15 * probability + 4.0 * standard_error(found)
    # Measured of 200 simulations of 500 flights a level: 0.36 at 1e-3, 0.82 at 1e-7.
    assert found.std() < 1.3 * probability


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

    value, probability = four_branches(4.0), four_branches_probability(4.0)
    theirs = np.array([openturns_estimate(value, seed) for seed in range(12)])
    ours = estimates(value, 15)[:, 0]
    scatter = math.hypot(standard_error(ours), standard_error(theirs))
    assert abs(ours.mean() - theirs.mean()) < 0.15 * probability + 4.0 * scatter


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
    blends, inputs = {of[DIMENSION + 1 :] for of in first}, {of[:DIMENSION] for of in first}
    kinds = [
        (point[:DIMENSION] in inputs, point[DIMENSION] in known, point[DIMENSION + 1 :] in blends)
        for point in wave
    ]
    # Exactly one of inputs, seed and blend is new, and each of them in some of the moves.
    assert set(kinds) == {(False, True, True), (True, False, True), (True, True, False)}
    for point in wave:
        # Squares of the weights add up to 1: rounding of two products.
        squares = [weight**2 for weight in point[DIMENSION + 2 :: 2]]
        assert sum(squares) == pytest.approx(1.0, abs=1e-12)


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


REPEATS = 5


def repeats_of(value, first, **settings):
    return [simulated(value, [20261202, first, i], **settings)[0] for i in range(REPEATS)]


@pytest.mark.parametrize(
    ("value", "probability", "noise"),
    [(linear(1e-7), 1e-7, False), (noisy(1e-4, seed_share=0.1, blend_share=0.5), 1e-4, True)],
    ids=["plane_1e-7", "noise_1e-4"],
)
def test_intervals_hold_the_true_probability_as_often_as_they_claim(value, probability, noise):
    studies = 12
    found = [
        rare_probability(repeats_of(value, i, flights=200, noise=noise), 0.95)
        for i in range(studies)
    ]
    # Measured with 500 flights a level (docs/explanation/operational_conditions.md): 0.94 to 0.99.
    # Fewer of 12 than are enough here would have a probability below 2 % at 0.95.
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
        for i in range(8)
    ]
    bounds = [study.upper for study in found if not study.reached]
    assert len(bounds) >= 2
    # Of 300 such studies 159 reached nothing, and each of their bounds was true.
    assert min(bounds) >= 1e-4


def test_chains_that_began_at_copies_of_one_state_count_as_one():
    simulations = repeats_of(linear(1e-12), 1, flights=200, levels=4)
    last = simulations[0].levels[-1]
    at = np.arange(len(last.values))
    at[: last.chains.max() + 1] = 0
    copies = replace(last, points=last.points[at], values=last.values[at])
    assert 10 <= last.beginnings <= 20
    assert copies.beginnings == 1
    begun_at_one = [
        replace(one, levels=(*one.levels[:-1], copies)) if one is simulations[0] else one
        for one in simulations
    ]
    counts = [one.levels[-1].beginnings for one in simulations]
    fewer = sum(counts) - last.beginnings + 1
    found, without = rare_probability(begun_at_one, 0.95), rare_probability(simulations, 0.95)
    for bound, confidence in (("upper", 0.975), ("high", 0.9875)):
        left_open = upper_bound(0, fewer, confidence) / upper_bound(0, sum(counts), confidence)
        ratio = getattr(found, bound) / getattr(without, bound)
        assert ratio == pytest.approx(left_open, rel=1e-9)


def test_the_curve_follows_the_normal_distribution_to_where_the_event_begins():
    points = curve(repeats_of(linear(1e-5), 4), 0.95)
    values = np.array([value for value, _ in points])
    assert 0.0 in values
    assert (np.diff(values) > 0.0).all()
    # -Phi^-1(1e-5) is 4.2649.
    rare = [(ndtr(value - 4.264890793922602), of) for value, of in points if of.estimate < 0.5]
    # Points are correlated: all may be inside, and a tenth outside.
    assert np.mean([of.low <= true <= of.high for true, of in rare]) >= 0.9


def test_what_decides_is_apart_from_what_has_no_effect_by_the_noise_floor():
    # Only the first input counts; below 0 from its normal coordinate 3.09 on, with 1e-3.
    simulations = repeats_of(lambda points: 3.09 - ndtri(np.array([of[0] for of in points])), 5)
    first = np.concatenate([one.levels[0].points for one in simulations])
    chosen = near_event(simulations)
    near = np.concatenate([one.levels[-1].points[at] for one, at in chosen])
    names = [f"input_{i}" for i in range(DIMENSION)]
    frames = [pd.DataFrame(of, columns=names) for of in (first, near)]
    shifts = input_shifts(*frames, (first, near))
    # All that fails has the first input above 0.999: the distributions hardly overlap.
    assert shifts[0].key == "input_0"
    assert min(shifts[0].distance, shifts[0].median_near) > 0.99
    # Nine others and five dummies are alike: the largest of the nine may exceed that of the five,
    # but not by much.
    assert shifts[1].distance < 2.0 * noise_floor(simulations)
    assert sum(shifts[0].near) == pytest.approx(1.0, abs=1e-12)
