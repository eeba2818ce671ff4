"""Tables and figures of searches that are made up, so that every number of them is known."""

import math

import numpy as np
import pandas as pd
import pytest

from reports.finding.searches import height_table, hits_over_time, search_table, variants_of
from reports.run.run_data import RunData
from reports.run.trials import Trial

ROWS = pd.DataFrame({
    "flight_id": [f"search_{number:05d}" for number in range(4)],
    "trial": "search",
    "variant": "study",
    "seed": [1, 2, 3, 4],
    "orbit_at_s": [20.0, 20.0, 30.0, math.nan],
    "time_to_find_s": [10.0, 50.0, math.nan, math.nan],
    "hit_rate_found": [0.5, 0.7, math.nan, math.nan],
    "fsc_percent": [0.12, 0.08, 0.10, math.nan],
    "fsc_expected_percent": 0.10,
    "fsc_uncertainty_percent": [0.02, 0.03, 0.04, math.nan],
    "fsc_noise_percent": [0.002, 0.004, 0.006, math.nan],
    "axis_height_error_3min_m": [3.0, -4.0, 12.0, math.nan],
    "axis_height_deviation_3min_m": [2.0, 3.0, 4.0, math.nan],
})  # fmt: skip
"""Three flights on their orbit, one without its plume to the end, and one that never came there."""

TOLD = ROWS.iloc[[1, 0]].assign(
    variant="told", flight_id=["told_00001", "told_00000"], beside=["search_00001", "search_00000"],
    fsc_uncertainty_percent=[0.01, 0.02], fsc_noise_percent=[0.002, 0.001],
    axis_height_error_3min_m=math.nan, axis_height_deviation_3min_m=math.nan,
)  # fmt: skip
"""The first two cases, in the other order."""


class Histories(RunData):
    """A run whose time histories are made up: a pass every 10 s, and every second pass hits."""

    def has_history(self, flight_id):
        return flight_id == "search_00000"

    def history(self, flight_id):
        if not self.has_history(flight_id):
            return None
        time = 0.1 * np.arange(1201)
        across = 50.0 * np.sin(math.pi * time / 10.0 + 1e-3)
        peak = np.where((time / 10.0).round() % 2 == 0, 0.9, 0.3)
        return pd.DataFrame(
            {
                "time_s": time,
                "plume_across_m": across,
                "plume_fraction": np.where(np.abs(across) < 5.0, peak, 0.0),
            }
        )


@pytest.fixture
def trial(tmp_path):
    empty = pd.DataFrame()
    run = Histories(
        path=tmp_path,
        manifest={},
        summary=ROWS,
        comparison=TOLD,
        crossings=empty,
        innerloop=None,
        statistics=None,
        draws=empty,
    )
    return Trial(run=run, key="search", name="trial1", config={"title": "Search"}, rows=ROWS)


def test_a_plume_that_was_not_found_counts_against_the_share(trial):
    # A flight that never reached its orbit does not count.
    assert [len(variant.rows) for variant in variants_of(trial)] == [3, 2]
    study = variants_of(trial)[0]
    assert study.share_found(300.0) == pytest.approx(2.0 / 3.0)
    row = search_table([study]).rows[0]
    # Times are 10 s, 50 s and never: the second is the median, the last the 95 % quantile.
    assert row[3:5] == ["50", "not found"]


def test_flights_are_compared_with_those_of_the_same_case(trial):
    study, known = variants_of(trial)
    # Case 0: 0.02/0.02, case 1: 0.03/0.01; the third has no pair.
    assert sorted(study.beside(known, "fsc_uncertainty_percent")) == pytest.approx([1.0, 3.0])
    rows = search_table([study, known]).rows
    # Errors +0.02, -0.02 and 0: rms 0.02 sqrt(2/3). Medians of 1 and 3, and of the noise 2 and 2.
    assert [row[6:] for row in rows] == [
        ["0.0163", "0.0300", "2.00", "2.00"],
        ["0.0200", "0.0150", "1.00", "1.00"],
    ]


def test_the_height_is_covered_where_its_error_is_within_two_standard_deviations(trial):
    table = height_table(variants_of(trial))
    # 3 of 2 and -4 of 3 are within 1.96, 12 of 4 is not: two of three, whose exact interval is 9.43
    # to 99.16 % (Clopper, Pearson). Bias (3 - 4 + 12)/3; rms sqrt((9 + 16 + 144)/3).
    per_cent = "\N{NO-BREAK SPACE}%"
    assert table.rows == [
        [
            "as in the study",
            "3",
            "+3.7",
            "7.5",
            "3.0",
            f"66.7{per_cent}",
            f"9.43{per_cent} to 99.16{per_cent}",
        ]
    ]
    assert height_table(variants_of(trial)[1:]) is None


def test_hits_count_from_the_orbit_on(trial):
    times, hits = hits_over_time(trial, ROWS.iloc[:1])
    # 100 s on the orbit, a pass each 10 s; every second pass hits.
    assert len(times) in (9, 10, 11)
    assert np.mean(hits) == pytest.approx(0.5, abs=0.06)
    assert times.min() >= 0.0
    assert times.max() <= 100.0
