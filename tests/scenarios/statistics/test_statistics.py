"""What a Monte Carlo study says of its flights, of made-up ones whose figures are known."""

import json
import math

import numpy as np
import pytest

from common.intervals import clopper_pearson, quantile_interval, upper_bound
from scenarios.statistics.estimates import study_statistics
from scenarios.statistics.sensitivity import sensitivity_indices
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


@pytest.fixture(scope="module")
def study():
    return study_rows(FLIGHTS)


@pytest.fixture(scope="module")
def statistics(study):
    return statistics_of(*study)


@pytest.fixture
def no_indices(monkeypatch):
    """Of what is tested nothing hangs on the sensitivity indices, which take nearly all of the
    time.
    """
    monkeypatch.setattr("scenarios.statistics.estimates.DRIVEN", ())


def test_violations_are_bounded_exactly_and_each_flight_counts_once(study):
    rows, inputs = study_rows(100)
    # One flight that enters three times is one.
    rows.loc[4, ["keepout_violations", "min_distance_m"]] = [3, RADIUS - 1.5]
    found = statistics_of(rows, inputs)["violation"]["measured"]
    interval = clopper_pearson(1, 100, 0.95)
    assert found == {
        "events": 1, "flights": 100, "share": 0.01, "low": interval.low, "high": interval.high, "upper": upper_bound(1, 100, 0.95),
    }  # fmt: skip


def test_flights_without_a_measurement_are_named_and_count_as_violations_where_the_worst_is_assumed():
    rows, inputs = study_rows(100)
    rows.loc[[0, 1], ["outcome", "min_distance_m", "keepout_violations", "mode_at_end"]] = [
        "infeasible",
        math.nan,
        math.nan,
        None,
    ]
    rows.loc[2, ["outcome", "min_distance_m", "keepout_violations", "mode_at_end"]] = [
        "failed",
        math.nan,
        math.nan,
        None,
    ]
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


def test_quantiles_are_those_of_the_flights_that_have_the_figure(study, no_indices):
    rows, inputs = study
    rows = rows.copy()
    rows.loc[:9, "settling_time_s"] = np.nan
    figures = statistics_of(rows, inputs)["figures"]
    settling = figures["settling_time_s"]
    assert (settling["known"], settling["missing"]) == (FLIGHTS - 10, 10)
    known = rows["settling_time_s"].dropna().to_numpy()
    interval = quantile_interval(known, 0.95, 0.95)
    (quantile,) = (q for q in settling["quantiles"] if q["probability"] == 0.95)
    assert quantile == {
        "probability": 0.95,
        "value": np.quantile(known, 0.95),
        "low": interval.low,
        "high": interval.high,
    }
    # The interval's error is relative, and that of the clearance counts from r_min.
    error = rows["crossing_interval_mean_s"].to_numpy() / PREDICTED - 1.0
    assert figures["crossing_interval_error"]["quantiles"][2]["value"] == np.quantile(error, 0.5)
    distance, clearance = (
        figures[name]["quantiles"][0]["value"] for name in ("min_distance_m", "clearance_m")
    )
    # Differences of figures near 200 are good to 3e-14.
    assert distance - RADIUS == pytest.approx(clearance, abs=1e-12)


def test_a_study_of_nothing_but_failures_and_one_of_nothing_have_statistics_that_json_can_say():
    rows, inputs = study_rows(5)
    figures = [
        "min_distance_m",
        "keepout_violations",
        "crossing_interval_mean_s",
        "crossing_distance_min_m",
    ]
    rows[[*figures, "crossing_clearance_min_m", "tracking_error_rms_m", "settling_time_s"]] = (
        math.nan
    )
    rows["outcome"] = "failed"
    for some in (rows, rows.head(0)):
        found = statistics_of(some, inputs)
        assert json.loads(json.dumps(found, allow_nan=False)) == found
        assert found["violation"]["measured"]["upper"] == 1.0
        assert found["violation"]["measured"]["share"] is None
        assert found["figures"]["clearance_m"]["quantiles"][0] == {
            "probability": 0.01,
            "value": None,
            "low": None,
            "high": None,
        }
        assert found["sensitivity"]["clearance_m"]["message"].startswith(
            "0 flights have this figure"
        )


@pytest.mark.parametrize(
    ("per_sample", "expected"), [(1, [0, 1, 2, 3, 4, 5]), (3, [0, 1, 0, 1, 0, 1]), (6, None)]
)
def test_what_drives_a_figure_is_judged_by_samples_of_which_each_point_has_one_flight(
    per_sample, expected, monkeypatch
):
    judged = []

    def indices(*given, samples, **named):
        judged.append(samples)
        return sensitivity_indices(*given, samples=samples, **named)

    monkeypatch.setattr("scenarios.statistics.estimates.sensitivity_indices", indices)
    statistics_of(*study_rows(6), per_sample=per_sample)
    assert all(
        (samples is None and expected is None) or samples.tolist() == expected for samples in judged
    )
    assert judged
