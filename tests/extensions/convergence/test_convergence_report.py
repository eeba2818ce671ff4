"""Reports of convergence studies: what is counted, listed and said."""

import shutil

import numpy as np
import pandas as pd
import pytest
from report_parts import blocks_of
from snapshots import assert_reads_as_before

from extensions.convergence.report import settled_time
from reports.build import build_reports
from reports.document.blocks import Table
from reports.errors import ReportError
from reports.registry import content
from reports.run.run_data import read_run
from tests.extensions.convergence.conftest import CUT_FAILURES, ROWS_SHOWN, TRAJECTORIES
from tests.run_tables import manifest_of, write_manifest


@pytest.fixture
def copied(directory, tmp_path):
    return shutil.copytree(directory, tmp_path / "run")


def change(path, how):
    how(pd.read_csv(path / "summary.csv")).to_csv(path / "summary.csv", index=False)


def test_a_study_in_which_all_converged_says_so(directory):
    verdict = content(read_run(directory)).verdict
    assert verdict.holds
    assert verdict.complete
    # Two laws that the theory is about.
    assert verdict.headline.startswith(f"All {2 * TRAJECTORIES} trajectories converged; law (24)")
    assert verdict.failures == []
    everyone = f"{TRAJECTORIES} of {TRAJECTORIES}"
    assert [figure[1:4] for figure in verdict.figures[:3]] == [
        (everyone, "all", True), (everyone, "all", True), (everyone, "", None),
    ]  # fmt: skip


def test_counter_examples_are_named_with_their_reasons_and_counted(failed):
    assert not failed.verdict.holds
    all_of = 2 * TRAJECTORIES
    assert failed.verdict.headline.startswith(f"{all_of - 3} of {all_of} trajectories converged; ")
    assert [line.split(": ")[:2] for line in failed.verdict.failures] == [
        ["Law (24), trajectory 3", "time up"],
        ["Law (30), trajectory 7", "steps up"],
        ["Law (30), trajectory 11", "not finite"],
    ]
    tables = blocks_of(failed, Table, "counterexamples")
    assert [[row[0] for row in table.rows] for table in tables] == [
        ["3"], ["7", "11"], [f"{number}" for number in range(ROWS_SHOWN)],
    ]  # fmt: skip
    (table,) = blocks_of(failed, Table, "settling")
    # Of each law the row of all references comes last.
    converged = [TRAJECTORIES - 1, TRAJECTORIES - 2, TRAJECTORIES - CUT_FAILURES]
    assert [row[2:4] for row in table.rows[3::4]] == [
        [f"{TRAJECTORIES}", f"{count}"] for count in converged
    ]
    # Under every law some never settled, so that there is no time by which all had.
    assert {row[7] for row in table.rows[3::4]} == {"–"}


def test_trajectories_that_were_lost_with_their_process_are_no_counter_examples(copied):
    def lost(rows):
        gone = (rows["law"] == "cascade") & (rows["trajectory"] < 5)
        # What the study writes of them: nothing that was flown.
        known = ["trajectory", "law", "reference"]
        rows.loc[gone, [name for name in rows if name not in known]] = np.nan
        rows["outcome"] = rows["outcome"].astype(object)
        rows.loc[gone, ["outcome", "message"]] = "lost", "2 processes that flew it were lost"
        return rows

    change(copied, lost)
    report = content(read_run(copied))
    assert report.verdict.holds
    assert not report.verdict.complete
    assert report.verdict.headline.startswith(
        "INCOMPLETE after 19 of 24 trajectories. All 19 trajectories converged; "
    )
    assert "5 trajectories were lost with their processes" in report.verdict.detail
    assert report.verdict.figures[1][1:4] == ("7 of 7", "all", True)
    assert "counterexamples" not in [section.anchor for section in report.sections]


def without_ensemble(path):
    manifest = manifest_of(path)
    del manifest["config"]["ensemble"]
    write_manifest(path, manifest)


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: (path / "summary.csv").unlink(), "no summary.csv"),
        (lambda path: change(path, lambda rows: rows.assign(law="pursuit")), "law is pursuit"),
        (lambda path: change(path, lambda rows: rows.drop(columns="settling_time_s")), "damaged"),
        (without_ensemble, "is damaged"),
    ],
)
def test_a_damaged_study_is_refused_in_one_line(damage, words, copied):
    damage(copied)
    with pytest.raises(ReportError, match=words) as refusal:
        build_reports(copied)
    assert "\n" not in str(refusal.value)


def test_a_share_had_settled_when_so_many_had():
    # Of 300 trajectories 99 % are 297: the 297th time, and not the 298th. Of four with one that
    # never did, half had at the second.
    assert settled_time(pd.Series(np.arange(1.0, 301.0)), 0.99) == "297"
    assert settled_time(pd.Series([30.0, 10.0, np.nan, 20.0]), 0.5) == "20"
    assert settled_time(pd.Series([30.0, 10.0, np.nan, 20.0]), 0.99) == "–"


def test_a_convergence_study_reads_as_before(failed):
    assert_reads_as_before("convergence", failed)
