"""The report on two short sweeps, and the table of their pairs."""

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from judged_runs import judged
from report_parts import blocks_of, numbers_of_page_1
from snapshots import assert_reads_as_before

from reports.compare.content import compare, comparison_content, headline
from reports.compare.pairs import read_runs
from reports.compare.table_of_pairs import write_differences
from reports.document.blocks import Table, Text
from reports.run.columns import judged as judged_figure

pytestmark = pytest.mark.slow


def texts_of(report):
    return " ".join(block.text for block in blocks_of(report, Text))


def test_figures_of_whole_runs_are_those_of_their_summaries(report, first, larger):
    (table,) = blocks_of(report, Table, "figures")
    cells = {row[0]: row[1:] for row in table.rows}
    nearest = [
        pd.read_csv(path / "summary.csv")["min_distance_m"].min() for path in (first, larger)
    ]
    assert cells["Closest approach, least [m]"][:2] == [f"{distance:.1f}" for distance in nearest]
    assert cells["Flights that met every criterion"] == ["3 of 3", "0 of 3", "−3"]
    # Three crossings of three flights each, as the scenario asks for.
    assert cells["Plume crossings after settling, all flights"] == ["9", "9", "0"]


def test_the_table_of_pairs_has_each_figure_of_both_runs_and_their_difference(
    compared, first, larger, tmp_path
):
    write_differences(compared, tmp_path / "table.csv")
    table = pd.read_csv(tmp_path / "table.csv")
    before, after = (pd.read_csv(path / "summary.csv") for path in (first, larger))
    assert list(table["flight_id"]) == list(before["flight_id"])
    assert list(table["seed"]) == list(before["seed"])
    assert [*table["run"], *table["directory"]] == ["B"] * 3 + ["larger"] * 3
    assert list(table["criteria_met_first"]) == [True] * 3
    assert not table["criteria_met"].any()
    for name in ("min_distance_m", "tracking_error_rms_m", "settling_time_s", "duration_s"):
        assert np.array_equal(table[f"{name}_first"], before[name])
        assert np.array_equal(table[name], after[name])
        assert np.array_equal(table[f"{name}_difference"], after[name] - before[name])
    # The report shows this one in per cent, the table has it as the summary would.
    off = (after["crossing_interval_mean_s"] / after["crossing_interval_predicted_s"] - 1.0).abs()
    assert table["crossing_interval_error"].to_numpy() == pytest.approx(off.to_numpy(), rel=1e-9)


def test_a_flight_that_one_run_has_not_flown_yet_has_no_partner(first, same):
    runs = read_runs([first, same])
    begun = replace(runs[1].data, summary=runs[1].data.summary.iloc[:2])
    runs[1] = replace(runs[1], data=judged(begun, interrupted=True))
    report = comparison_content(runs, compare(runs))
    assert (
        report.verdict.headline
        == "No figure differs in 2 pairs of flights; other flights have no partner"
    )
    assert not report.verdict.complete
    assert (
        "B: the run was interrupted, 2 of 3 flights did what is required, 1 not flown yet"
        in report.verdict.failures
    )
    assert "Without a partner are 1 of A and 0 of B;" in texts_of(report)
    (figures,) = blocks_of(report, Table, "figures")
    # Counts of 3 and of 2 flights have no difference that says anything.
    assert next(row for row in figures.rows if row[0] == "Flights that are known to have kept out")[
        1:
    ] == ["3 of 3", "2 of 2", "–"]
    assert [row[-1] for row in figures.rows] == ["−1"] + ["–"] * (len(figures.rows) - 1)


def test_the_headline_counts_both_directions(first, same):
    runs = read_runs([first, same])
    runs[0].data.summary.loc[0, "criteria_met"] = False
    assert headline(compare(runs)) == "Of 3 shared flights 2 met their criteria in A, 3 in B"
    runs[1].data.summary.loc[1:, "criteria_met"] = False
    assert headline(compare(runs)) == "Of 3 shared flights 2 met their criteria in A, 1 in B"


@pytest.mark.parametrize("change", [{"keepout_violations": 1}, {"outcome": "aircraft_lost"}])
def test_a_new_violation_or_a_lost_aircraft_makes_it_red(first, same, change):
    runs = read_runs([first, same])
    for name, value in {**change, "criteria_met": False}.items():
        runs[1].data.summary.loc[0, name] = value
    verdict = comparison_content(runs, compare(runs)).verdict
    assert verdict.tone == "bad"
    assert verdict.headline.startswith(
        "1 of 3 shared flights violate the keep-out area or lose the aircraft in B alone"
    )
    assert (
        "B: 1 flight violates the keep-out area or loses the aircraft, and not in A"
        in verdict.failures
    )
    # The other way round the flight is better.
    back = comparison_content(runs[::-1], compare(runs[::-1])).verdict
    assert (back.holds, back.complete) == (True, True)


def test_a_flight_that_met_in_neither_run_and_cannot_be_flown_any_more_is_worse(first, same):
    runs = read_runs([first, same])
    for run in runs:
        run.data.summary.loc[0, "criteria_met"] = False
    rows = runs[1].data.summary
    known = rows.select_dtypes("number").columns.drop(["seed"])
    rows[known] = rows[known].astype(float)
    rows.loc[0, known] = np.nan
    rows.loc[0, ["outcome", "message", "kept_out"]] = ["infeasible", "too fast", False]
    runs = [replace(run, data=judged(run.data)) for run in runs]
    report = comparison_content(runs, compare(runs))
    assert report.verdict.tone == "warn"
    assert report.verdict.headline.endswith("Of 3 shared flights 2 met their criteria in A, 2 in B")
    assert report.verdict.failures == [
        "A: 2 of 3 flights did what is required",
        "B: 2 of 3 flights did what is required, 1 could not be flown",
        "B: 1 of 3 paired flights known to keep out in A alone",
        "B: 1 of 3 paired flights completed their mission in A alone",
    ]
    listed = next(
        table for table in blocks_of(report, Table, "flightsb") if table.head[0] == "Flight"
    )
    ((_, alone, _, ended),) = listed.rows
    assert alone == "known to keep out in A alone, completed their mission in A alone"
    assert "too fast" in ended
    (figures,) = blocks_of(report, Table, "figures")
    cells = {row[0]: row[1:] for row in figures.rows}
    assert cells["Missions completed"] == ["3 of 3", "2 of 3", "−1"]
    # Two flights have the figure in B, three in A: a sum over other flights is no difference.
    assert cells["Plume crossings after settling, all flights"] == ["9", "6", "–"]
    assert {cells[name][2] for name in cells if "[" in name} == {"–"}


def test_another_verdict_on_the_fuel_is_counted_and_not_green(first, same):
    runs = read_runs([first, same])
    for run, verdicts in zip(
        runs, (["above", "open", "below"], ["above", "above", "below"]), strict=True
    ):
        run.data.summary["sulphur_verdict"] = verdicts
    report = comparison_content(runs, compare(runs))
    assert report.verdict.headline.endswith("The verdict on the fuel is another in 1")
    assert not report.verdict.complete


def test_a_comparison_reads_as_before(report):
    assert_reads_as_before("compare", report)


def test_every_number_on_page_1_is_that_of_the_summaries(runs, compared, report, tmp_path):
    tables = [run.data.summary.set_index("flight_id").sort_index() for run in runs]
    assert list(tables[0].index) == list(tables[1].index)
    known = {"3", "0"}
    for name, of in compared[0].found.items():
        first, other = (of.figure.scale * judged_figure(rows, name, of.figure) for rows in tables)
        digits = of.figure.digits
        known |= {f"{np.median(values):.{digits}f}" for values in (first, other)}
        # A change that is smaller than its digits show has two significant ones.
        change = abs(np.median(other - first))
        known |= {f"{change:.{digits}f}", f"{change:.2g}"}
    shown = {number.lstrip("-+") for number in numbers_of_page_1(report, tmp_path)}
    assert shown <= known
