"""Intervals of probabilities and quantiles, against published figures and their own definition."""

import math

import numpy as np
import pytest
from scipy.stats import binom

from common.intervals import (
    Interval,
    clopper_pearson,
    quantile_interval,
    shared_interval,
    upper_bound,
)


def test_no_event_in_ten_thousand_bounds_the_probability_by_the_root_of_what_confidence_leaves():
    # Without any event (1 - p)^n = 0.05 at the bound.
    assert upper_bound(0, 10_000, 0.95) == pytest.approx(1.0 - 0.05 ** (1.0 / 10_000), rel=1e-12)
    # The rule of three, 3/n, is that of J. A. Hanley and A. Lippman-Hand, JAMA 249 (1983);
    # -ln(0.05) is 2.9957.
    assert upper_bound(0, 10_000, 0.95) == pytest.approx(2.9957e-4, rel=2e-4)


def test_the_exact_interval_of_ten_in_a_hundred_is_the_one_that_r_gives():
    # binom.test(10, 100) of R: 0.04900469 0.17622260, to all the digits it prints.
    interval = clopper_pearson(10, 100, 0.95)
    assert (interval.low, interval.high) == pytest.approx((0.04900469, 0.17622260), abs=5e-9)


@pytest.mark.parametrize(("events", "trials"), [(1, 30), (7, 30), (29, 30), (3, 5000)])
def test_at_each_end_what_was_seen_or_worse_has_half_of_what_confidence_leaves(events, trials):
    interval = clopper_pearson(events, trials, 0.9)
    # The definition of Clopper and Pearson; a beta quantile is good to a few units of the eleventh
    # digit.
    assert binom.cdf(events, trials, interval.high) == pytest.approx(0.05, rel=1e-9)
    assert binom.sf(events - 1, trials, interval.low) == pytest.approx(0.05, rel=1e-9)


def test_trials_that_share_their_sample_count_as_one():
    # As often as one likes the same four: 4 of 4 is 39.8 % to 100 % (0.025^(1/4)).
    alone = shared_interval(np.ones(4, dtype=bool), np.arange(4), 0.95)
    shared = shared_interval(np.ones(20, dtype=bool), np.tile(np.arange(4), 5), 0.95)
    assert (alone.low, alone.high) == pytest.approx((0.025**0.25, 1.0), abs=1e-9)
    assert shared == alone
    # Two and a half of four samples: from the low end of two to the high end of three.
    halves = shared_interval(np.array([1, 1, 1, 0, 0], dtype=bool), np.array([7, 8, 9, 9, 5]), 0.95)
    assert halves == Interval(clopper_pearson(2, 4, 0.95).low, clopper_pearson(3, 4, 0.95).high)


def test_the_largest_of_59_bounds_the_95th_percentile_and_the_largest_of_58_does_not():
    # S. S. Wilks, Annals of Mathematical Statistics 12 (1941): 59 values for 95 % of the population
    # at 95 %. Two-sided 90 % has that confidence on each side.
    assert quantile_interval(np.arange(59.0), 0.95, 0.9).high == 58.0
    assert math.isnan(quantile_interval(np.arange(58.0), 0.95, 0.9).high)
    assert math.isnan(quantile_interval(np.arange(58.0), 0.95, 0.9).width)


def test_quantiles_of_a_skewed_distribution_are_held_as_often_as_stated():
    generator = np.random.default_rng(20261121)
    samples = 2000
    true = math.log(1.0 / 0.95)  # the 5th percentile of the exponential distribution
    held = 0
    for values in generator.exponential(size=(samples, 200)):
        interval = quantile_interval(values, 0.05, 0.9)
        held += interval.low <= true <= interval.high
    # Order statistics come in steps, so that the interval holds for more than 0.9: P(5 <= B <= 15)
    # of B(200, 0.05), 0.93. Three standard deviations of a share of 2000.
    assert held / samples == pytest.approx(
        binom.cdf(15, 200, 0.05) - binom.cdf(4, 200, 0.05), abs=3 * math.sqrt(0.07 / samples)
    )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: upper_bound(3, 2, 0.95), "events are 3 of 2 trials; there can be 0 to 2"),
        (lambda: upper_bound(-1, 2, 0.95), "events are -1 of 2 trials"),
        (lambda: clopper_pearson(1, 2, 1.0), "must be between 0 and 1, such as 0.95"),
        (
            lambda: quantile_interval(np.ones(3), 1.0, 0.95),
            "probability is 1; quantiles are of probabilities between 0 and 1",
        ),
        (lambda: quantile_interval(np.ones(3), 0.5, 95.0), "confidence is 95"),
    ],
)
def test_what_cannot_be_is_refused_with_its_value_and_limit(call, message):
    with pytest.raises(ValueError, match=message):
        call()
