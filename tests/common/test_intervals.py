"""Intervals of probabilities and quantiles, against published figures and their own definition."""

import math

import numpy as np
import pytest
from scipy.stats import binom

from common.intervals import (
    clopper_pearson,
    quantile_interval,
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


def test_the_largest_of_59_bounds_the_95th_percentile_and_the_largest_of_58_does_not():
    # S. S. Wilks, Annals of Mathematical Statistics 12 (1941): 59 values for 95 % of the population
    # at 95 %. Two-sided 90 % has that confidence on each side.
    assert quantile_interval(np.arange(59.0), 0.95, 0.9).high == 58.0
    assert math.isnan(quantile_interval(np.arange(58.0), 0.95, 0.9).high)
    assert math.isnan(quantile_interval(np.arange(58.0), 0.95, 0.9).width)


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
