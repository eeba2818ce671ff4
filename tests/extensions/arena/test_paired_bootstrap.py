import numpy as np
import pytest

from extensions.arena.paired_bootstrap import paired_estimates

OPTIONS = {"greater_is_better": False, "resamples": 500, "confidence": 0.95, "seed": 1}


def test_what_is_common_to_all_entrants_does_not_count_as_a_difference():
    common = np.random.default_rng(2).normal(10.0, 5.0, 12)
    best, other = paired_estimates(np.array([common, common + 1.0]), np.zeros(12), **OPTIONS)
    # The difference is 1 in every flight, and so in every resample; the means scatter by
    # 5/sqrt(12).
    assert best.best
    assert not other.as_good
    assert (other.behind_low, other.behind_high) == pytest.approx((1.0, 1.0), abs=1e-12)
    assert best.high - best.low > 2.0


def test_entrants_that_flights_do_not_tell_apart_are_as_good():
    generator = np.random.default_rng(3)
    values = generator.normal(10.0, 1.0, (2, 8))
    values[1] += values[0].mean() - values[1].mean() + 1e-3
    _, other = paired_estimates(values, np.zeros(8), **OPTIONS)
    assert other.as_good
    assert not other.best


def test_an_entrant_that_lacks_a_flight_which_another_has_is_not_compared():
    # The second one is better in every flight that it has, and has no figure of the one that was
    # hard on the first.
    values = np.array([[1.0, 1.0, 9.0], [0.5, 0.5, np.nan]])
    first, second = paired_estimates(values, np.zeros(3), **OPTIONS)
    assert (first.whole, first.best, second.whole, second.best, second.as_good) == (
        True,
        True,
        False,
        False,
        False,
    )
    assert (second.mean, second.flights) == (0.5, 2)
    assert np.isnan([second.behind_low, second.behind_high]).all()


def test_an_interval_of_normal_figures_is_as_wide_as_it_should_be():
    values = np.random.default_rng(4).normal(0.0, 1.0, (1, 400))
    (estimate,) = paired_estimates(values, np.zeros(400), **{**OPTIONS, "resamples": 4000})
    # 1.96/sqrt(400) either side; scatter of the sample's deviation, 1/sqrt(800), and of 4,000
    # resamples' quantiles.
    assert 0.5 * (estimate.high - estimate.low) == pytest.approx(0.098, rel=0.12)


@pytest.mark.parametrize(("entrants", "strata"), [(17, 5), (2, 1)])
def test_of_equal_entrants_one_in_twenty_counts_as_worse_whatever_their_number(entrants, strata):
    # The interval of the difference from the best of the same flights left out 0 for 35 % of 17,
    # and for 22 % of two.
    generator, worse, arenas = np.random.default_rng(5), 0, 600 // entrants
    for _ in range(arenas):
        values = generator.normal(size=(entrants, 4 * strata)) + generator.normal(size=4 * strata)
        found = paired_estimates(values, np.repeat(np.arange(strata), 4), **OPTIONS)
        worse += sum(not estimate.as_good for estimate in found)
    # Measured: 5 % of either.
    assert worse / (entrants * arenas) < 0.09
