"""``python -m reports.compare``: what it prints and writes, and what it refuses."""

import multiprocessing
import shutil

import pandas as pd
import pytest

from reports.run.run_data import read_run
from scenarios.engine.journal import Journal
from scenarios.engine.task import Result, Task
from tests.in_process import assert_refused, run_command
from tests.run_tables import change_manifest, manifest_of, write_manifest

pytestmark = pytest.mark.slow


def compared(*arguments):
    return run_command("reports.compare.__main__", *arguments)


@pytest.fixture
def copies(first, larger, tmp_path):
    return [shutil.copytree(path, tmp_path / path.name) for path in (first, larger)]


@pytest.mark.usefixtures("sketched")
def test_it_prints_the_figures_and_writes_reports_and_table_beside_the_first_run(copies, tmp_path):
    before = sorted(path.name for path in copies[0].rglob("*"))
    ended = compared(*copies)
    assert (ended.status, ended.errors) == (0, "")
    folder = tmp_path / "compare-first-larger"
    assert [line for line in ended.out.splitlines() if line.startswith("comparison: ")] == [
        f"comparison: {folder / name}"
        for name in ("differences.csv", "compare.html", "compare.pdf")
    ]
    assert "Of 3 shared flights 3 met their criteria in A, 0 in B" in " ".join(ended.out.split())
    assert "keepout.radius_m" in ended.out
    html = (folder / "compare.html").read_text(encoding="utf-8")
    assert "Comparison of 2 runs" in html
    assert str(tmp_path) not in html
    assert (folder / "compare.pdf").read_bytes().startswith(b"%PDF")
    assert len((folder / "differences.csv").read_text(encoding="utf-8").splitlines()) == 4
    # Runs are read, and never changed.
    assert sorted(path.name for path in copies[0].rglob("*")) == before


def test_runs_of_other_seeds_have_no_flight_in_common(copies):
    summary = copies[1] / "summary.csv"
    rows = pd.read_csv(summary)
    rows.assign(seed=rows["seed"] + 77).to_csv(summary, index=False)
    before = set(copies[0].parent.iterdir())
    assert_refused(
        compared(*copies), "no flight in common", "3 agree in name but not in seed", "--seed"
    )
    assert set(copies[0].parent.iterdir()) == before


def without(path, entry):
    manifest = manifest_of(path)
    del manifest[entry]
    write_manifest(path, manifest)


def of_another_version(path):
    summary = path / "summary.csv"
    text = summary.read_text(encoding="utf-8").replace(",seed,", ",noise_seed,")
    summary.write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: (path / "manifest.json").unlink(), ("holds no run",)),
        (lambda path: (path / "summary.csv").unlink(), ("holds nothing finished", "--resume")),
        (lambda path: without(path, "config_hash"), ("another version", "'config_hash'")),
        (of_another_version, ("another version", "'seed'")),
        (lambda path: change_manifest(path, study="design"), ("of the study 'design'",)),
        (lambda path: change_manifest(path, not_compared="which has none"), ("which has none",)),
        (lambda path: change_manifest(path, trials=[]), ("names no trials",)),
        (lambda path: change_manifest(path, trials={"sweep_nu": 3}), ("is damaged",)),
    ],
)
def test_a_directory_that_is_no_run_of_flights_of_this_version_is_refused(copies, damage, words):
    damage(copies[1])
    assert_refused(compared(*copies), *words)


def test_a_place_that_is_a_run_or_cannot_be_made_is_refused(copies, tmp_path):
    assert_refused(compared(*copies, "--out", copies[0]), "directory of a run")
    (tmp_path / "file").touch()
    assert_refused(
        compared(*copies, "--out", tmp_path / "file" / "below"), "cannot be made", "--out"
    )


def test_fewer_than_two_runs_and_the_same_twice_are_refused(first):
    assert_refused(compared(first), "1 run given; 2 to 6")
    assert_refused(compared(first, first.parent / "." / first.name), "given twice")


def _hold(path, opened, released):
    """Write to a journal, as a run does, until it is to end, and then end as if killed: without
    closing it.
    """
    journal = Journal(path)
    journal.add(Result(task=Task(number=0), items=1, lost=False, tables={}))
    opened.set()
    released.wait(30.0)


def test_a_run_that_another_process_is_writing_is_refused_and_one_that_was_killed_is_not(copies):
    context = multiprocessing.get_context("fork")
    opened, released = context.Event(), context.Event()
    journal = copies[1] / "journal.sqlite"
    writer = context.Process(target=_hold, args=(journal, opened, released))
    writer.start()
    try:
        assert opened.wait(30.0)
        assert_refused(compared(*copies), "another program is writing to", str(copies[1]))
        assert_refused(
            run_command("reports.build", copies[1]),
            "another program is writing to",
            "; wait until it has ended",
        )
    finally:
        writer.kill()
        writer.join()
    files = sorted(path.name for path in copies[1].iterdir())
    assert "journal.sqlite-wal" in files
    assert len(read_run(copies[1]).summary) == 3
    # SQLite has nothing to do with a run that is only read.
    assert sorted(path.name for path in copies[1].iterdir()) == files
