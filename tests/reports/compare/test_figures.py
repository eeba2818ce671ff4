"""How far figures differ between the flights of a pair."""

import math

import numpy as np
import pytest

from reports.compare.content import difference_table
from reports.compare.pairs import PAIRS_MIN, differences, paired
from tests.reports.compare.compared_runs import made_run, rows_of


def pairs_of(before, after, name="tracking_error_rms_m"):
    return paired(
        made_run("A", rows_of(range(len(before)), **{name: before})),
        made_run("B", rows_of(range(len(after)), **{name: after})),
    )


def test_of_the_fewest_pairs_the_interval_of_the_median_is_from_the_least_to_the_greatest_difference():
    # The least and the greatest of n enclose the median but for 2/2^n: 3.1 % of six, 6.3 % of five
    # (David and Nagaraja, 7.1).
    change = np.array([0.5, -1.0, 2.0, 3.0, 0.1, 7.0])
    assert len(change) == PAIRS_MIN
    found = differences(pairs_of(np.ones(6), 1.0 + change))["tracking_error_rms_m"]
    assert (found.low, found.high) == pytest.approx((-1.0, 7.0), abs=1e-12)
    assert found.median == pytest.approx(1.25, abs=1e-12)
    fewer = differences(pairs_of(np.ones(5), 1.0 + change[:5]))["tracking_error_rms_m"]
    assert math.isnan(fewer.low)
    assert math.isnan(fewer.high)
    assert not fewer.excludes_zero


def test_the_other_way_round_every_difference_has_the_other_sign():
    generator = np.random.default_rng(1)
    before, after = generator.normal(size=(2, 31))
    forth = differences(pairs_of(before, after))["tracking_error_rms_m"]
    back = differences(pairs_of(after, before))["tracking_error_rms_m"]
    assert np.array_equal(forth.change, -back.change)
    assert (forth.median, forth.low, forth.high) == (-back.median, -back.high, -back.low)


def test_what_is_common_to_both_flights_of_a_pair_is_no_difference():
    # Flights differ by tens of metres, those of a pair by 1 cm: their medians alone would not tell
    # it.
    common = np.random.default_rng(2).uniform(0.0, 50.0, size=30)
    found = differences(pairs_of(common, common + 0.01))["tracking_error_rms_m"]
    # The sums are exact to the rounding of 50.
    assert (found.low, found.high) == pytest.approx((0.01, 0.01), abs=1e-13)
    assert found.excludes_zero
    assert differences(pairs_of(common, common - 0.01))["tracking_error_rms_m"].excludes_zero


def test_pairs_with_a_flight_that_lacks_the_figure_are_left_out():
    found = differences(pairs_of([1.0, math.nan, 3.0], [2.0, 5.0, math.nan]))[
        "tracking_error_rms_m"
    ]
    assert list(found.known) == [1.0]
    assert found.median == 1.0


def test_figures_that_no_pair_has_or_that_are_always_0_are_left_out_but_for_violations():
    pairs = pairs_of([0.0, 0.0], [0.0, 0.0], "guard_time_s")
    assert list(differences(pairs)) == ["min_distance_m", "clearance_m", "keepout_violations"]


def test_the_clearance_is_from_each_runs_own_keep_out_area():
    pairs = paired(
        made_run("A", rows_of([0], min_distance_m=[205.0])),
        made_run("B", rows_of([0], min_distance_m=[233.0], keepout_radius_m=[230.0])),
    )
    found = differences(pairs)
    assert (found["min_distance_m"].median, found["clearance_m"].median) == (28.0, -2.0)


def test_the_crossing_interval_is_compared_by_its_distance_from_theory_in_per_cent():
    rows = [
        rows_of([0], crossing_interval_mean_s=[mean], crossing_interval_predicted_s=[10.0])
        for mean in (9.8, 10.1)
    ]
    found = differences(paired(made_run("A", rows[0]), made_run("B", rows[1])))[
        "crossing_interval_error"
    ]
    # |9.8/10 - 1| is 2 %, |10.1/10 - 1| 1 %; to rounding.
    assert (found.before[0], found.after[0]) == pytest.approx((2.0, 1.0), abs=1e-12)


def test_the_table_counts_lower_and_higher_and_marks_an_interval_without_0():
    found = differences(pairs_of(np.zeros(8), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]))
    table = difference_table(pairs_of(np.zeros(8), np.ones(8)), found)
    row = next(i for i, cells in enumerate(table.rows) if cells[0].startswith("Tracking error"))
    # The first and the eighth of eight: 2/2^8 is left outside; with the second and the seventh it
    # were 18/2^8, above 5 %.
    assert table.rows[row][1:] == [
        "8",
        "0.00",
        "4.50",
        "+4.50",
        "+1.00 to +8.00",
        "+1.00 to +8.00",
        "0, 8",
    ]
    assert (row, 5) in table.bold


def test_small_figures_have_two_digits_of_the_lesser_median():
    pairs = pairs_of(np.full(6, 0.003), np.full(6, 0.0061))
    table = difference_table(pairs, differences(pairs))
    row = next(cells for cells in table.rows if cells[0].startswith("Tracking error"))
    assert row[2:5] == ["0.0030", "0.0061", "+0.0031"]


def test_pairs_that_share_their_random_sample_count_as_one():
    # Three seeds at two points of a sweep: six pairs are three samples, with mean differences of 1,
    # 2.5 and 5.
    rows = [
        rows_of(range(3), prefix=f"p{point}_", tracking_error_rms_m=[1.0, 1.0, 1.0])
        for point in (0, 1)
    ]
    moved = [
        rows_of(range(3), prefix=f"p{point}_", tracking_error_rms_m=[2.0, 3.0 + point, 6.0])
        for point in (0, 1)
    ]
    pairs = paired(made_run("A", [*rows[0], *rows[1]]), made_run("B", [*moved[0], *moved[1]]))
    found = differences(pairs)["tracking_error_rms_m"]
    assert len(found.known) == 6
    assert found.median == 2.5
    assert math.isnan(found.low)
    assert math.isnan(found.high)
