"""Reports of made-up convergence studies: what is counted, listed and said."""

import re

import numpy as np
import pandas as pd
import pytest
from convergence_runs import LAWS, REFERENCES, TRAJECTORIES, write_convergence_run
from report_parts import blocks_of, numbers_on_page_1
from snapshots import assert_reads_as_before

from extensions.convergence.report import FAILED_ROWS, settled_time
from reports.build import build_reports
from reports.document.blocks import Table
from reports.errors import ReportError
from reports.registry import content
from reports.run.run_data import read_run
from tests.run_tables import manifest_of, write_manifest


def small(path, **options):
    return content(read_run(write_convergence_run(path / "run", 30, **options)))


def test_a_study_in_which_all_converged_says_so(converged):
    assert converged.verdict.holds
    assert converged.verdict.complete
    # Two laws that the theory is about.
    assert converged.verdict.headline.startswith(
        f"All {2 * TRAJECTORIES:,} trajectories converged; law (24) commanded up to "
    )
    assert converged.verdict.failures == []
    assert [figure[1:4] for figure in converged.verdict.figures[:3]] == [
        (f"{TRAJECTORIES:,} of {TRAJECTORIES:,}", "all", True),
        (f"{TRAJECTORIES:,} of {TRAJECTORIES:,}", "all", True),
        (f"{TRAJECTORIES:,} of {TRAJECTORIES:,}", "", None),
    ]
    anchors = [section.anchor for section in converged.sections]
    assert anchors == ["figures", "question", "settling", "samples", "parameters", "provenance"]


def test_counter_examples_are_named_with_their_reasons(failed):
    assert not failed.verdict.holds
    all_of = 2 * TRAJECTORIES
    assert failed.verdict.headline.startswith(
        f"{all_of - 3:,} of {all_of:,} trajectories converged; "
    )
    assert [line.split(": ")[:2] for line in failed.verdict.failures] == [
        ["Law (24), trajectory 3", "time up"],
        ["Law (30), trajectory 7", "steps up"],
        ["Law (30), trajectory 200", "not finite"],
    ]
    lyapunov, cascade, cut = blocks_of(failed, Table, "counterexamples")
    assert [row[0] for row in lyapunov.rows] == ["3"]
    assert [row[0] for row in cascade.rows] == ["7", "200"]
    assert len(cut.rows) == FAILED_ROWS < 40


def test_trajectories_that_were_lost_with_their_process_are_no_counter_examples(tmp_path):
    path = write_convergence_run(tmp_path / "run", 30)
    rows = pd.read_csv(path / "summary.csv")
    # What the study writes of them: nothing that was flown.
    lost = (rows["law"] == "cascade") & (rows["trajectory"] < 10)
    known = ["trajectory", "law", "reference"]
    rows.loc[lost, [name for name in rows if name not in known]] = np.nan
    rows["outcome"] = rows["outcome"].astype(object)
    rows.loc[lost, "outcome"], rows.loc[lost, "message"] = (
        "lost",
        "2 processes that flew it were lost",
    )
    rows.to_csv(path / "summary.csv", index=False)
    report = content(read_run(path))
    assert report.verdict.holds
    assert not report.verdict.complete
    assert report.verdict.headline.startswith(
        "INCOMPLETE after 50 of 60 trajectories. All 50 trajectories converged; "
    )
    assert (
        "10 trajectories were lost with their processes, and count as not flown; --resume"
        in report.verdict.detail
    )
    assert report.verdict.figures[1][1:4] == ("20 of 20", "all", True)
    assert "counterexamples" not in [section.anchor for section in report.sections]
    (table,) = blocks_of(report, Table, "settling")
    assert [row[2:4] for row in table.rows if row[:2] == ["Law (30)", "all"]] == [["20", "20"]]


def test_a_study_of_which_rows_are_missing_is_not_called_complete(tmp_path):
    assert not small(tmp_path, planned=31).verdict.complete


def test_the_table_counts_and_orders_as_the_run_did(failed_path, failed):
    (table,) = blocks_of(failed, Table, "settling")
    summary = pd.read_csv(failed_path / "summary.csv")
    assert len(table.rows) == len(LAWS) * (len(REFERENCES) + 1)
    for i, (law, cells) in enumerate(zip(LAWS, table.rows[3::4], strict=True)):
        rows = summary[summary["law"] == law]
        assert cells[2:4] == [f"{len(rows):,}", f"{(rows['outcome'] == 'converged').sum():,}"]
        ordered = np.sort(rows["settling_time_s"].fillna(np.inf))
        # The 600th or 601st of 1200 is their median: either may be printed, to the second.
        assert float(cells[4].replace(",", "")) == pytest.approx(
            ordered[600], abs=0.5 + ordered[600] - ordered[599]
        )
        # Under every law some never settled, so that there is no time by which all had.
        assert cells[7] == "–"
        assert [row[2] for row in table.rows[4 * i : 4 * i + 3]] == ["400", "400", "400"]


def change(path, how):
    how(pd.read_csv(path / "summary.csv")).to_csv(path / "summary.csv", index=False)


def without_ensemble(path):
    manifest = manifest_of(path)
    del manifest["config"]["ensemble"]
    write_manifest(path, manifest)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: (path / "summary.csv").unlink(), "no summary.csv"),
        (
            lambda path: (path / "summary.csv").write_text("x,y\n1,2\n", encoding="utf-8"),
            "is damaged",
        ),
        (
            lambda path: change(path, lambda rows: rows.assign(law="pursuit")),
            "law is pursuit; known are lyapunov",
        ),
        (
            lambda path: change(path, lambda rows: rows.assign(reference="square")),
            "reference is square; known are circle",
        ),
        (
            lambda path: change(path, lambda rows: rows.drop(columns="settling_time_s")),
            "is damaged",
        ),
        (without_ensemble, "is damaged"),
    ],
)
def test_a_damaged_study_is_refused_in_one_line(damage, words, tmp_path):
    path = write_convergence_run(tmp_path / "run", 6, samples=0)
    damage(path)
    with pytest.raises(ReportError, match=words) as refusal:
        build_reports(path)
    assert "\n" not in str(refusal.value)


def test_a_share_had_settled_when_so_many_had():
    # Of 300 trajectories 99 % are 297: the 297th time, and not the 298th. Of four with one that
    # never did, half had at the second.
    assert settled_time(pd.Series(np.arange(1.0, 301.0)), 0.99) == "297"
    assert settled_time(pd.Series([30.0, 10.0, np.nan, 20.0]), 0.5) == "20"
    assert settled_time(pd.Series([30.0, 10.0, np.nan, 20.0]), 0.99) == "–"


def test_every_number_on_page_1_is_that_of_the_summary(failed_path, tmp_path):
    rows = pd.read_csv(failed_path / "summary.csv")
    proven = rows[rows["law"] != "cascade_cut"]
    converged = rows["outcome"] == "converged"
    known = proven[proven["settling_time_predicted_s"].between(0.0, np.inf, inclusive="neither")]
    ratio = (known["settling_time_s"] / known["settling_time_predicted_s"]).median()
    commands = rows.groupby("law")["heading_rate_max_rad_s"].max()
    failures = proven[proven["outcome"] != "converged"]
    expected = {
        *(f"{number}" for number in converged.groupby(rows["law"]).sum()),
        *(f"{number}" for number in rows["law"].value_counts()),
        *(f"{number:.3f}" for number in commands),
        *(f"{number:.0f}" for number in commands),
        *(f"{number}" for number in failures["trajectory"]),
        *(f"{len(of)}" for of in (proven, proven[proven["outcome"] == "converged"])),
        f"{rows['trajectory'].nunique()}",
        f"{rows['settling_time_s'].max():.0f}",
        f"{ratio:.2f}",
        f"{manifest_of(failed_path)['config']['guidance']['heading_rate_max_rad_s']:g}",
        # Equations, by which the laws are named.
        *("24", "30"),
    }
    messages = {
        number
        for text in failures["message"].astype(str)
        for number in re.findall(r"\d+(?:\.\d+)?", text)
    }
    assert numbers_on_page_1(failed_path, tmp_path) <= expected | messages


def test_a_convergence_study_reads_as_before(failed):
    assert_reads_as_before("convergence", failed)
