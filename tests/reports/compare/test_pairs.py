"""Which flights are paired, of made-up runs."""

import math

import pytest

from reports.compare.pairs import paired
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


def test_runs_of_scenarios_with_other_names_say_that_seeds_follow_from_the_name():
    # Their --seed may well be the same: the seeds of flights differ all the same.
    agency, sulphur = (
        rows_of([0], trial=of, prefix=f"{of}_", seed=seed)
        for of, seed in (("agency", 100), ("sulphur", 500))
    )
    with pytest.raises(
        ReportError,
        match=r"from the scenario's name, here 'agency' and 'sulphur'; .*--set .* flight_seed",
    ):
        paired(made_run("A", agency), made_run("B", sulphur))


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
