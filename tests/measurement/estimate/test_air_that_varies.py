"""The estimate in air as it often is, by logs of a simulator that shares no code with it.

The table with 25 logs and more of every regime is in docs/howto/measuring.md; here a few short logs
of each hold it.
"""

import itertools
import math

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binom

from tests.measurement.simulator.log import random_flight, simulate
from tests.measurement.simulator.regimes import REGIMES
from tests.measurement.simulator.runner import estimated

pytestmark = pytest.mark.slow

SEED = 2000
SHORT_S = 250.0
"""Longest log that is estimated here: the time of an estimate grows faster than its log [s]."""

COVERED = [name for name, regime in REGIMES.items() if regime.required == "covered"]
NOT_TOLD = ("foreign_every_pass", "haze_as_passes")
"""Regimes in which estimates are wrong that no log alone can tell; the table says how often."""


@pytest.fixture(scope="module")
def estimates():
    """Return a table of estimates, each of another flight: two of the regimes of which intervals
    have to hold the content, one of the others.
    """
    short = (number for number in itertools.count(100) if duration_of(number) <= SHORT_S)
    return pd.DataFrame(
        {"row": name} | estimated(simulate(REGIMES[name], SEED, next(short)))
        for name in REGIMES
        for _ in range(1 + (name in COVERED))
    )


def duration_of(number):
    """Return the length of a log of this number [s], which is that of a quiet log."""
    return random_flight(np.random.default_rng([SEED, number, 0]), REGIMES["quiet"]).duration_s


def test_intervals_hold_the_content_where_the_background_varies(estimates):
    given = estimates[estimates["given"] & estimates["row"].isin(COVERED)]
    content = given["true_percent"]
    held = (given["low_percent"] <= content) & (content <= given["high_percent"])
    assert len(given) > 0.8 * 2 * len(COVERED)
    # Of intervals that hold it with 95 % as many do with a probability of 99.9 %.
    assert held.sum() >= binom.ppf(0.001, len(given), 0.95)


def test_intervals_are_no_wider_than_they_need_to_be(estimates):
    given = estimates[estimates["given"] & estimates["row"].isin(COVERED)]
    away = (given["fsc_percent"] - given["true_percent"]) / given["total_percent"]
    # The root mean square of n standard normal numbers is 1 within 4/sqrt(2 n).
    assert math.sqrt((away**2).mean()) > 1.0 - 4.0 / math.sqrt(2.0 * len(given))


def test_less_than_one_verdict_of_a_hundred_is_wrong(estimates):
    told = estimates[~estimates["row"].isin(NOT_TOLD)]
    verdicts = told["verdicts"].sum()
    assert verdicts > 50
    # At 1 % no more are wrong with a probability of 99.9 %: 5 of 95.
    assert told["wrong"].sum() <= binom.ppf(0.999, verdicts, 0.01)


def test_quiet_air_is_not_refused(estimates):
    assert estimates.loc[estimates["row"] == "quiet", "given"].all()


def test_a_change_of_fuel_has_no_verdict_and_a_reason(estimates):
    of_row = estimates[estimates["row"] == "fuel_change"]
    assert of_row["verdicts"].sum() == 0
    assert of_row["reasons"].map(len).min() > 0
