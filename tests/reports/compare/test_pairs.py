"""Which flights of two runs are paired, and how far their figures differ."""

import math

import numpy as np
import pytest

from reports.compare.content import difference_table
from reports.compare.pairs import PAIRS_MIN, differences, paired
from reports.errors import ReportError
from tests.reports.compare.compared_runs import made_run, rows_of


def paired_names(pairs):
    return list(zip(pairs.names, pairs.after["flight_id"], strict=True))


def test_flights_of_the_same_trial_name_and_seed_are_paired_in_the_order_of_the_first_run():
    pairs = paired(made_run("A", rows_of([0, 1, 2])), made_run("B", rows_of([2, 1, 5])))
    assert paired_names(pairs) == [("00001", "00001"), ("00002", "00002")]
    assert pairs.alone == (1, 1)
    assert pairs.same_name == 0


def test_a_trial_that_was_flown_alone_is_paired_with_itself_in_a_list():
    # Flights of a list have the name of their trial before their own.
    listed = rows_of([0, 1], trial="sea", prefix="sea_") + rows_of(
        [0, 1], trial="other", prefix="other_", seed=500
    )
    pairs = paired(made_run("A", rows_of([0, 1], trial="alone")), made_run("B", listed))
    assert paired_names(pairs) == [("00000", "sea_00000"), ("00001", "sea_00001")]
    assert pairs.alone == (0, 2)


def test_flights_that_two_trials_could_mean_are_not_paired_across_trials():
    # Sweeps over the speed ratio take their seeds from it alone, so that two trials may have
    # flights of one name and seed.
    twice = rows_of([0], trial="one", prefix="one_") + rows_of([0], trial="two", prefix="two_")
    pairs = paired(
        made_run("A", twice),
        made_run("B", [*rows_of([0], trial="one", prefix="one_"), *rows_of([7])]),
    )
    assert paired_names(pairs) == [("one_00000", "one_00000")]
    with pytest.raises(ReportError, match="1 agrees in name but not in seed"):
        paired(made_run("A", twice), made_run("B", rows_of([0])))


def test_a_flight_whose_process_was_lost_has_no_seed_and_is_paired_by_trial_and_name():
    lost = rows_of([0, 1], outcome=["failed", "completed"], seed=100)
    lost[0]["seed"] = math.nan
    pairs = paired(made_run("A", rows_of([0, 1])), made_run("B", lost))
    assert paired_names(pairs) == [("00000", "00000"), ("00001", "00001")]
    assert list(pairs.after["outcome"]) == ["failed", "completed"]


@pytest.mark.parametrize(("rows", "count"), [([], "0 flights"), (rows_of([7]), "1 flight")])
def test_runs_without_a_flight_in_common_are_refused(rows, count):
    with pytest.raises(
        ReportError,
        match=rf"'a' \(2 flights\) and 'b' \({count}\) have no flight in common: no name",
    ):
        paired(made_run("A", rows_of([0, 1])), made_run("B", rows))


def test_flights_of_one_seed_may_differ_in_what_was_sampled_and_that_is_counted_by_key():
    draws = [
        {
            "flight_id": ["00000", "00001"],
            "trial": "sea",
            "wind.speed_mps": winds,
            "vessel.track": [None, "a"],
            f"own{i}": [i, i],
        }
        for i, winds in enumerate(([3.0, 4.0], [3.0, 5.0]))
    ]
    pairs = paired(
        made_run("A", rows_of([0, 1]), draws[0]), made_run("B", rows_of([0, 1]), draws[1])
    )
    assert pairs.differing_inputs() == {"wind.speed_mps": 1}


def test_a_figure_differs_from_one_that_is_missing_and_two_that_are_missing_agree():
    before = rows_of([0, 1], settling_time_s=[math.nan, math.nan], spread_m=[1.0, 2.0])
    after = rows_of([0, 1], settling_time_s=[math.nan, math.nan], spread_m=[1.0, math.nan])
    pairs = paired(made_run("A", before), made_run("B", after))
    assert pairs.differing_figures() == ["spread_m"]
    assert pairs.differing_figures(apart=["spread_m"]) == []


def test_flights_whose_criteria_changed_are_known_by_the_direction():
    before, after = ([True, True, False, False], [True, False, True, False])
    pairs = paired(
        made_run("A", rows_of(range(4), criteria_met=before)),
        made_run("B", rows_of(range(4), criteria_met=after)),
    )
    assert list(pairs.no_longer_met) == [False, True, False, False]
    assert list(pairs.newly_met) == [False, False, True, False]


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
