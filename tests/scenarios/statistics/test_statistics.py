"""Statistics of made-up flights whose figures are known, and when a study may stop."""

import json
import math

import numpy as np
import pandas as pd
import pytest

from common.intervals import clopper_pearson, quantile_interval, upper_bound
from common.premises import TERMS, ratio_column
from scenarios.statistics.estimates import (
    confidence_at,
    looks,
    premise_table,
    study_statistics,
    tight_enough,
)
from scenarios.statistics.sulphur import COLUMNS, sulphur_statistics
from tests.scenarios.study_rows import PREDICTED, RADIUS, few_indices, study_rows

FLIGHTS = 250


def statistics_of(rows, inputs, **changes):
    return study_statistics(rows, inputs, **{"confidence": 0.95, "seed": 1, **changes})


@pytest.fixture(scope="module", autouse=True)
def quick_statistics():
    """Ask of two figures what drives them, with 3 bootstraps: that takes nearly all of the time;
    test_sensitivity is about it.
    """
    with few_indices("clearance_m", "tracking_error_rms_m"):
        yield


def test_violations_are_bounded_exactly_and_each_flight_counts_once():
    rows, inputs = study_rows(100)
    # One flight that enters three times is one.
    rows.loc[4, ["keepout_violations", "min_distance_m"]] = [3, RADIUS - 1.5]
    found = statistics_of(rows, inputs)["violation"]["measured"]
    interval = clopper_pearson(1, 100, 0.95)
    counts = {"events": 1, "flights": 100, "share": 0.01, "upper": upper_bound(1, 100, 0.95)}
    assert found == counts | {"low": interval.low, "high": interval.high}


def test_flights_without_a_measurement_are_named_and_count_as_violations_where_the_worst_is_assumed():
    rows, inputs = study_rows(100)
    known = ["min_distance_m", "keepout_violations", "mode_at_end"]
    rows.loc[[0, 1], ["outcome", *known]] = ["infeasible", math.nan, math.nan, None]
    rows.loc[2, ["outcome", *known]] = ["failed", math.nan, math.nan, None]
    # Out of control: one that entered before, and one of which nobody knows where it would have
    # gone.
    rows.loc[3, ["outcome", "keepout_violations"]] = ["diverged", 1]
    rows.loc[5, "outcome"] = "diverged"
    found = statistics_of(rows, inputs)
    assert found["flights"] == {
        "done": 100,
        "measured": 97,
        "unknown": {
            "diverged": {"flights": 1, "flight_ids": ["study_00005"]},
            "failed": {"flights": 1, "flight_ids": ["study_00002"]},
            "infeasible": {"flights": 2, "flight_ids": ["study_00000", "study_00001"]},
        },
    }
    measured, pessimistic = found["violation"]["measured"], found["violation"]["pessimistic"]
    assert (measured["events"], measured["flights"]) == (1, 97)
    assert (pessimistic["events"], pessimistic["flights"]) == (5, 100)
    assert found["outcomes"] == {"completed": 95, "infeasible": 2, "diverged": 2, "failed": 1}
    assert found["modes_at_end"] == {"tracking": 97}


def test_quantiles_are_those_of_the_flights_that_have_the_figure():
    rows, inputs = study_rows(FLIGHTS)
    rows.loc[:9, "settling_time_s"] = np.nan
    figures = statistics_of(rows, inputs)["figures"]
    settling = figures["settling_time_s"]
    assert (settling["known"], settling["missing"]) == (FLIGHTS - 10, 10)
    known = rows["settling_time_s"].dropna().to_numpy()
    interval = quantile_interval(known, 0.95, 0.95)
    (quantile,) = (q for q in settling["quantiles"] if q["probability"] == 0.95)
    value = {"probability": 0.95, "value": np.quantile(known, 0.95)}
    assert quantile == value | {"low": interval.low, "high": interval.high}
    # The interval's error is relative, and that of the clearance counts from r_min.
    error = rows["crossing_interval_mean_s"].to_numpy() / PREDICTED - 1.0
    assert figures["crossing_interval_error"]["quantiles"][2]["value"] == np.quantile(error, 0.5)
    names = ("min_distance_m", "clearance_m")
    distance, clearance = (figures[name]["quantiles"][0]["value"] for name in names)
    # Differences of figures near 200 are good to 3e-14.
    assert distance - RADIUS == pytest.approx(clearance, abs=1e-12)


def test_a_study_of_nothing_but_failures_and_one_of_nothing_have_statistics_that_json_can_say():
    rows, inputs = study_rows(5)
    rows[["min_distance_m", "keepout_violations", "crossing_interval_mean_s"]] = math.nan
    rows[["crossing_distance_min_m", "crossing_clearance_min_m", "settling_time_s"]] = math.nan
    rows["tracking_error_rms_m"] = math.nan
    rows["outcome"] = "failed"
    for some in (rows, rows.head(0)):
        found = statistics_of(some, inputs)
        assert json.loads(json.dumps(found, allow_nan=False)) == found
        assert found["violation"]["measured"]["upper"] == 1.0
        assert found["violation"]["measured"]["share"] is None
        quantile = found["figures"]["clearance_m"]["quantiles"][0]
        assert (quantile["value"], quantile["low"], quantile["high"]) == (None, None, None)
        assert found["sensitivity"]["clearance_m"]["message"].startswith("0 flights have this")


def rows_with(distances, entered=0, outcome="completed"):
    """Return rows of flights with these closest approaches [m], the first of which entered."""
    rows = pd.DataFrame({"min_distance_m": distances, "outcome": outcome})
    rows["flight_id"] = [f"f_{i:05d}" for i in rows.index]
    rows["keepout_violations"] = [2 if i < entered else 0 for i in rows.index]
    return rows


def test_a_study_is_looked_at_after_powers_of_two_and_at_its_end():
    assert looks(10_000) == [256, 512, 1024, 2048, 4096, 8192, 10_000]
    assert looks(512) == [256, 512]
    assert looks(100) == [100]


def test_all_looks_together_spend_what_the_confidence_leaves_and_no_more():
    spent = sum(1.0 - confidence_at(k, 0.95) for k in range(1, 2001))
    # 1/(k (k + 1)) is 1/k - 1/(k + 1): after 2000 looks 1/2001 is left.
    assert spent == pytest.approx(0.05 * (1.0 - 1.0 / 2001.0), rel=1e-9)


def stopped_wrongly(confidences, *, probability, demanded, seed=20261121, studies=20_000):
    """Return the share of simulated studies whose bound, at the look that they stop at, lies below
    the true probability.
    """
    numbers = looks(8192)
    generator = np.random.default_rng(seed)
    added = generator.binomial(np.diff([0, *numbers]), probability, size=(studies, len(numbers)))
    events = np.cumsum(added, axis=1)
    bounds = np.empty(events.shape)
    for i, (number, confidence) in enumerate(zip(numbers, confidences, strict=True)):
        possible = range(int(events[:, i].max()) + 1)
        table = np.array([upper_bound(count, number, confidence) for count in possible])
        bounds[:, i] = table[events[:, i]]
    stops = bounds <= demanded
    stops[:, -1] = True
    bound = bounds[np.arange(studies), np.argmax(stops, axis=1)]
    return float(np.mean(bound < probability))


def test_the_bound_at_the_stop_holds_as_often_as_stated_and_would_not_if_alpha_were_not_spent():
    # Just above what is demanded for, so that every study that stops early is wrong.
    numbers = range(1, len(looks(8192)) + 1)
    how, looked = (
        {"probability": 0.0205, "demanded": 0.02},
        [confidence_at(k, 0.95) for k in numbers],
    )
    spent, naive = stopped_wrongly(looked, **how), stopped_wrongly([0.95] * len(numbers), **how)
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
    entered, how = rows_with(np.full(512, 210.0), entered=1), {"confidence": 0.95}
    assert not tight_enough(entered, look_number=2, violation_upper=bound, **how)


@pytest.mark.parametrize(("distance", "outcome"), [(math.nan, "failed"), (210.0, "diverged")])
def test_flights_that_may_have_entered_do_not_let_a_study_stop(distance, outcome):
    rows = rows_with(np.full(512, 210.0))
    rows.loc[7, ["min_distance_m", "outcome"]] = [distance, outcome]
    for events in (0, 1):
        bound = upper_bound(events, 512, confidence_at(1, 0.95))
        how = {"look_number": 1, "confidence": 0.95, "violation_upper": bound}
        assert tight_enough(rows, **how) is bool(events)


def test_a_study_stops_once_a_quantile_of_the_closest_approach_is_known_as_well_as_asked():
    # Evenly spread over 100 m: the median of 512 lies between order statistics some 26 either side
    # of it (deviation 11.3, and 2.24 of them at 0.975), 0.195 m apart: 10.2 m.
    rows = rows_with(200.0 + np.arange(512) * 100.0 / 512.0)
    how = {"look_number": 1, "confidence": 0.95, "distance_quantile": 0.5}
    assert tight_enough(rows, **how, distance_quantile_width_m=11.0)
    assert not tight_enough(rows, **how, distance_quantile_width_m=9.0)
    # 256 flights are too few for an interval of the 1 % quantile that ends on both sides: 0.99^256
    # is 0.08.
    few = {"look_number": 1, "confidence": 0.95, "distance_quantile_width_m": 1e6}
    assert not tight_enough(rows.head(256), **few)


def rows(errors, *, deviation=0.02, sensor="electrochemical", fuel=0.1, verdicts=None):
    expected = 0.972 * fuel
    found = expected + np.asarray(errors)
    table = pd.DataFrame(index=range(len(found)), columns=list(COLUMNS), dtype=object)
    given = {
        "flight_id": [f"a_{i}" for i in range(len(found))], "seed": range(len(found)),
        "sensor": sensor, "fsc_fuel_percent": fuel, "fsc_expected_percent": expected,
        "sulphur_limit_percent": 0.1, "verdict_2min": "open",
        "sulphur_verdict": verdicts or ["open"] * len(found), "fsc_percent": found,
        "fsc_uncertainty_percent": deviation, "fsc_noise_percent": 0.5 * deviation,
        "fsc_low_percent": found - 1.96 * deviation, "fsc_high_percent": found + 1.96 * deviation,
    }  # fmt: skip
    for name, values in given.items():
        table[name] = values
    return table


def test_bias_spread_and_coverage_are_those_of_the_errors():
    errors = np.array([0.01, -0.03, 0.05, 0.01])
    found = sulphur_statistics(rows(errors), confidence=0.95)
    (entry,) = found["accuracy"]
    about = (entry["sensor"], entry["method"], entry["flights"])
    assert about == ("electrochemical", "regression", 4)
    assert entry["bias_percent"] == pytest.approx(0.01)
    assert entry["bias_relative"] == pytest.approx(0.01 / 0.0972)
    assert entry["spread_percent"] == pytest.approx(np.std(errors, ddof=1))
    # 0.05 alone lies beyond 1.96 times 0.02.
    assert entry["coverage"] == 0.75
    # Clopper and Pearson's interval of 3 of 4.
    assert entry["coverage_interval"] == pytest.approx([0.1941, 0.9937], abs=1e-4)


def test_sensors_are_apart_and_fuels_are_points_of_the_operating_curve():
    table = pd.concat([
        rows([0.0, 0.0], fuel=0.1, verdicts=["open", "below"]),
        rows([0.0, 0.0], fuel=0.5, verdicts=["above", "above"]),
        rows([0.0], sensor="fast", fuel=0.5, verdicts=["above"]),
    ])  # fmt: skip
    found = sulphur_statistics(table, confidence=0.9)
    curve = {
        (entry["sensor"], entry["fsc_fuel_percent"]): (entry["above"], entry["open"])
        for entry in found["operating_curve"]
    }
    assert curve == {
        ("electrochemical", 0.1): (0.0, 0.5),
        ("electrochemical", 0.5): (1.0, 0.0),
        ("fast", 0.5): (1.0, 0.0),
    }
    whole = [entry for entry in found["accuracy"] if entry["fsc_fuel_percent"] is None]
    flights = {entry["sensor"]: entry["flights"] for entry in whole}
    assert flights == {"electrochemical": 4, "fast": 1}


def test_flights_of_one_seed_are_one_sample():
    errors = np.array([0.01, -0.03, 0.05, 0.01])
    verdicts = ["above", "above", "open", "above"]
    points = [rows(errors, fuel=fuel, verdicts=verdicts) for fuel in (0.08, 0.1, 0.12)]
    swept = sulphur_statistics(pd.concat(points, ignore_index=True), confidence=0.95)
    (alone,) = sulphur_statistics(points[0], confidence=0.95)["accuracy"]
    whole, *of_fuels = swept["accuracy"]
    # The same four sniffers at three fuels say no more of the method than at one; each fuel by
    # itself says as much as before.
    for entry in (whole, *of_fuels):
        assert entry["coverage_interval"] == alone["coverage_interval"]
        error = pytest.approx(alone["bias_standard_error_percent"])
        assert entry["bias_standard_error_percent"] == error
    assert (whole["flights"], whole["coverage"]) == (12, 0.75)
    for entry in swept["operating_curve"]:
        assert entry["above_interval"] == alone["coverage_interval"]


def test_each_case_and_term_has_its_median_its_largest_and_what_is_to_be_expected():
    # Four flights of half an hour, two of them in turbulence.
    found = pd.DataFrame({"flight_id": [*"abcd"], "turbulence": ["none"] * 2 + ["light"] * 2})
    found["duration_s"] = 1800.0
    for term in TERMS:
        found[ratio_column(term)] = math.nan
    found[ratio_column("wind")] = [0.1, 0.5, 0.4, 1.5]
    found[ratio_column("drift")] = [math.nan, 2.0, math.nan, math.nan]
    table = premise_table(found, ["calm", "calm", "gusty", "gusty"], per_hour=0.1)
    table = table.set_index(["case", "term"])
    # Terms without a ratio have no row.
    assert list(table.index) == [("calm", "wind"), ("calm", "drift"), ("gusty", "wind")]
    calm, gusty = table.loc[("calm", "wind")], table.loc[("gusty", "wind")]
    assert (calm["ratio_median"], calm["ratio_max"], calm["flight_id"]) == (0.3, 0.5, "b")
    assert (calm["flights_above"], calm["flights_above_expected"]) == (0, 0.0)
    # An hour in turbulence.
    assert (gusty["flights_above"], gusty["flights_above_expected"]) == (1, pytest.approx(0.1))
    assert table.loc[("calm", "drift"), "flights"] == 1
