"""Reports of several trials: of a small kinematic run, flown once for this file, and of what can
become of one.
"""

import json
import math
import shutil
from dataclasses import replace

import pytest
from judged_runs import judged
from snapshots import assert_reads_as_before
from trial_runs import rows_of, with_criterion, with_values

from reports.registry import content
from reports.run.run_data import read_run
from reports.run.trials import read_trials

pytestmark = pytest.mark.slow

BRIEF = pytest.mark.usefixtures("without_single_flights")


@BRIEF
def test_the_limits_shown_are_those_of_the_manifest(run, report):
    # 0.0321 stands in the scenario above.
    criteria = {row[0]: row for row in rows_of(report, "Steady")[1:]}
    assert criteria["Mean crossing interval off π/ω₀"][1] == "≤ 3.21 %"
    # Far below what any flight can show, so that both fail.
    other = content(with_criterion(run, "steady", "crossing_interval_error", 1e-6))
    row = next(row for row in rows_of(other, "Steady")[1:] if row[0].startswith("Mean"))
    assert row[1] == "≤ 0.0001 %"
    assert row[4:] == ["2 of 2", "2"]


def test_the_worst_measured_value_of_a_criterion_is_that_of_the_summary(run, report):
    rows = run.summary[run.summary["trial"] == "steady"]
    worst = max(abs(rows["crossing_interval_mean_s"] / rows["crossing_interval_predicted_s"] - 1.0))
    shown = next(row for row in rows_of(report, "Steady")[1:] if row[0].startswith("Mean"))[2]
    # Three digits are shown.
    assert float(shown.removesuffix(" %")) == pytest.approx(100.0 * worst, rel=5e-3)


@BRIEF
def test_a_criterion_without_a_figure_counts_as_failed(run):
    steady = read_trials(with_values(run, 0, crossing_interval_mean_s=math.nan))[0]
    row = next(
        row for row in rows_of(content(steady.run), "Steady")[1:] if row[0].startswith("Mean")
    )
    assert row[4:] == ["2 of 2", "1"]


@BRIEF
def test_resuming_is_judged_of_flights_whose_vessel_ends_a_manoeuvre(run):
    ended = with_values(run, 2, manoeuvre_end_s=190.0, resume_periods=0.7)
    with_end = with_values(ended, 3, manoeuvre_end_s=math.nan, resume_periods=math.nan)
    rows = rows_of(
        content(with_criterion(with_end, "turns", "resumes_within_periods", 1.0)), "Turns"
    )
    (row,) = (row for row in rows if row[0] == "Next crossing after the last manoeuvre")
    assert row[1:3] == ["≤ 1 periods", "0.7 periods"]
    assert row[4:] == ["1 of 2", "0"]


DEMAND = {"heading_rate_demand_max_rad_s": [0.5, 0.6]}


@BRIEF
@pytest.mark.parametrize(
    ("key", "value", "values", "shown"),
    [
        ("crossing_interval_s", [8.0, 9.0], {"crossing_interval_mean_s": [8.5, 9.25]}, ["8 to 9 s", "9.25 s", "1"]),
        ("crossing_distance_m", [200.0, 230.0], {"crossing_distance_mean_m": [214.0, math.nan]}, ["200 to 230 m", "214 m", "1"]),
        ("law_within_heading_rate_max", True, DEMAND, ["≤ ω_max", "1.2 ω_max", "1"]),
        ("law_beyond_heading_rate_max", True, DEMAND, ["> ω_max", "1 ω_max", "1"]),
    ],
)  # fmt: skip
def test_flights_that_failed_a_criterion_are_counted_for_limits_of_each_kind(
    run, key, value, values, shown
):
    # Of two flights of the trial, the second or, where the law must exceed omega_max = 0.5 rad/s,
    # the first.
    changed = {"heading_rate_limit_rad_s": [0.5, 0.5]} | values
    for i in range(2):
        run = with_values(run, 2 + i, **{name: of[i] for name, of in changed.items()})
    rows = rows_of(content(with_criterion(run, "turns", key, value)), "Turns")
    assert shown in [[*row[1:3], row[-1]] for row in rows]


def test_a_run_without_any_history_and_with_a_trial_not_begun_is_reported_on(small_run, tmp_path):
    path = shutil.copytree(small_run, tmp_path / "copy")
    shutil.rmtree(path / "flights")
    whole = read_run(path)
    steady = whole.summary[whole.summary["trial"] == "steady"]
    steady.to_csv(path / "summary.csv", index=False)
    interrupted = judged(replace(whole, summary=steady), interrupted=True).verdict
    (path / "verdict.json").write_text(json.dumps(interrupted.to_json()), encoding="utf-8")
    report = content(read_run(path))
    assert report.verdict.tone != "good"
    assert "Turns: 2 of 2 not flown yet" in report.verdict.failures
    assert [
        section.anchor
        for section in report.sections
        if section.anchor in ("trial1", "trial2", "flights")
    ] == ["trial1"]


@BRIEF
def test_a_criterion_that_is_just_failed_is_not_written_as_its_limit(run):
    failed = with_values(
        with_criterion(run, "steady", "tracking_error_rms_m", 1.5), 0, tracking_error_rms_m=1.504
    )
    rows = rows_of(content(failed), "Steady")
    assert ["≤ 1.5 m", "1.504 m", "1"] in [[*row[1:3], row[-1]] for row in rows]


def test_trials_read_as_before(report):
    assert_reads_as_before("trials", report)
