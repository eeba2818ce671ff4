"""When a study may stop, and that its intervals hold although it was looked at again and again."""

import math

import numpy as np
import pandas as pd
import pytest

from common.intervals import upper_bound
from scenarios.statistics.estimates import confidence_at, looks, tight_enough


def rows_with(distances, entered=0, outcome="completed"):
    """Return rows of flights with these closest approaches [m], so many of the first of which
    entered.
    """
    return pd.DataFrame(
        {
            "flight_id": [f"f_{i:05d}" for i in range(len(distances))],
            "outcome": outcome,
            "min_distance_m": distances,
            "keepout_violations": [2 if i < entered else 0 for i in range(len(distances))],
        }
    )


def test_a_study_is_looked_at_after_powers_of_two_and_at_its_end():
    assert looks(10_000) == [256, 512, 1024, 2048, 4096, 8192, 10_000]
    assert looks(512) == [256, 512]
    assert looks(100) == [100]


def test_all_looks_together_spend_what_the_confidence_leaves_and_no_more():
    spent = sum(1.0 - confidence_at(k, 0.95) for k in range(1, 2001))
    # 1/(k (k + 1)) is 1/k - 1/(k + 1): after 2000 looks 1/2001 is left.
    assert spent == pytest.approx(0.05 * (1.0 - 1.0 / 2001.0), rel=1e-9)


def stopped_wrongly(confidences, *, probability, asked, seed=20261121, studies=20_000):
    """Return the share of simulated studies whose bound, at the look that they stop at, lies below
    the true probability.
    """
    numbers = looks(8192)
    generator = np.random.default_rng(seed)
    added = generator.binomial(np.diff([0, *numbers]), probability, size=(studies, len(numbers)))
    events = np.cumsum(added, axis=1)
    bounds = np.empty(events.shape)
    for i, (number, confidence) in enumerate(zip(numbers, confidences, strict=True)):
        table = np.array(
            [upper_bound(e, number, confidence) for e in range(int(events[:, i].max()) + 1)]
        )
        bounds[:, i] = table[events[:, i]]
    stops = bounds <= asked
    stops[:, -1] = True
    bound = bounds[np.arange(studies), np.argmax(stops, axis=1)]
    return float(np.mean(bound < probability))


def test_the_bound_at_the_stop_holds_as_often_as_stated_and_would_not_if_alpha_were_not_spent():
    # Just above what is asked for, so that every study that stops early is wrong.
    probability, asked, confidence = 0.0205, 0.02, 0.95
    numbers = range(1, len(looks(8192)) + 1)
    spent = stopped_wrongly(
        [confidence_at(k, confidence) for k in numbers], probability=probability, asked=asked
    )
    naive = stopped_wrongly([confidence] * len(numbers), probability=probability, asked=asked)
    # A share of 20,000 has a deviation of at most 0.0025: three of them on either side.
    assert spent <= 0.05 + 0.0075
    assert naive > 0.05 + 0.0075


def test_a_study_stops_once_violations_are_bounded_as_asked():
    rows = rows_with(np.full(512, 210.0))
    bound = upper_bound(0, 512, confidence_at(2, 0.95))
    assert tight_enough(rows, look_number=2, confidence=0.95, violation_upper=bound)
    assert not tight_enough(rows, look_number=2, confidence=0.95, violation_upper=0.999 * bound)
    # At another look the same flights have another bound.
    assert not tight_enough(rows, look_number=3, confidence=0.95, violation_upper=bound)
    # One entry in 512 is bounded by more.
    assert not tight_enough(
        rows_with(np.full(512, 210.0), entered=1),
        look_number=2,
        confidence=0.95,
        violation_upper=bound,
    )


@pytest.mark.parametrize(("distance", "outcome"), [(math.nan, "failed"), (210.0, "diverged")])
def test_flights_that_may_have_entered_do_not_let_a_study_stop(distance, outcome):
    rows = rows_with(np.full(512, 210.0))
    rows.loc[7, ["min_distance_m", "outcome"]] = [distance, outcome]
    bound = upper_bound(0, 512, confidence_at(1, 0.95))
    assert not tight_enough(rows, look_number=1, confidence=0.95, violation_upper=bound)
    assert tight_enough(
        rows,
        look_number=1,
        confidence=0.95,
        violation_upper=upper_bound(1, 512, confidence_at(1, 0.95)),
    )


def test_a_study_stops_once_a_quantile_of_the_closest_approach_is_known_as_well_as_asked():
    # Evenly spread over 100 m: the median of 512 lies between order statistics some 26 either side
    # of it (deviation 11.3, and 2.24 of them at 0.975), 0.195 m apart: 10.2 m.
    rows = rows_with(200.0 + np.arange(512) * 100.0 / 512.0)
    asked = {"look_number": 1, "confidence": 0.95, "distance_quantile": 0.5}
    assert tight_enough(rows, **asked, distance_quantile_width_m=11.0)
    assert not tight_enough(rows, **asked, distance_quantile_width_m=9.0)
    # 256 flights are too few for an interval of the 1 % quantile that ends on both sides: 0.99^256
    # is 0.08.
    few = {"look_number": 1, "confidence": 0.95, "distance_quantile_width_m": 1e6}
    assert not tight_enough(rows.head(256), **few)
