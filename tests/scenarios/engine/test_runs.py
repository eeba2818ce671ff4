"""Run directories that are flown, interrupted, out of room and resumed."""

import errno
import os
import signal

import pandas as pd
import pytest
from engine_cases import TABLE, Squares, SquareStudy, begun, fly, interrupt_at

from common.files import write_whole
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory, source_hash
from scenarios.errors import InputError
from tests.run_tables import manifest_of, rows_of, write_manifest


@pytest.fixture
def marks(tmp_path):
    (tmp_path / "marks").mkdir()
    return tmp_path / "marks"


@pytest.fixture
def out(tmp_path):
    return tmp_path / "run"


@pytest.fixture
def whole(marks, tmp_path):
    """The table of a run that nothing disturbed."""
    (tmp_path / "others").mkdir()
    fly(SquareStudy(Squares(marks=tmp_path / "others")), tmp_path / "whole")
    return (tmp_path / "whole" / TABLE).read_bytes()


def reported(study, out, **how):
    """Return the outcome of a run, and what it reported."""
    reports = []
    return fly(study, out, progress=lambda *report: reports.append(report), **how), reports


def test_a_run_has_its_table_its_files_and_says_how_it_ended(marks, out):
    result, reports = reported(SquareStudy(Squares(marks=marks)), out)
    counts = result.verdict.counts
    assert (result.all_met, result.verdict.interrupted) == (True, False)
    assert (counts.planned, counts.done) == (8, 8)
    assert rows_of(out, TABLE) == [{"number": i, "square": float(i**2)} for i in range(8)]
    assert sorted(path.name for path in (out / "files").iterdir()) == [f"{i}.txt" for i in range(8)]
    assert (manifest_of(out)["state"], manifest_of(out)["squares_done"]) == ("complete", 8)
    assert reports == [*(("flying", i, 8) for i in range(9)), ("finishing", 8, 8)]


@pytest.mark.parametrize("jobs", [0, 2])
def test_an_interrupted_run_goes_on_where_it_was_and_comes_to_the_same(marks, out, whole, jobs):
    study = SquareStudy(Squares(marks=marks))
    first = fly(study, out, jobs=jobs, progress=interrupt_at(3))
    assert first.verdict.interrupted
    assert not first.all_met
    assert first.verdict.counts.done == 3
    assert manifest_of(out)["state"] == "interrupted"
    kept = [row["number"] for row in rows_of(out, TABLE)]
    assert len(kept) == 3
    again, reports = reported(study, out, jobs=jobs, resume=True)
    assert again.all_met
    assert manifest_of(out)["state"] == "complete"
    # It says so from the beginning, and nothing that was done is done again.
    assert [done for doing, done, _ in reports if doing == "flying"] == [3, 4, 5, 6, 7, 8]
    assert [begun(marks, number) for number in kept] == [1, 1, 1]
    assert (out / TABLE).read_bytes() == whole


def test_results_are_in_the_table_though_the_statistics_fail_and_the_run_continues(
    marks, out, whole, monkeypatch
):
    study = SquareStudy(Squares(marks=marks))
    with monkeypatch.context() as patch:
        patch.setattr(SquareStudy, "postprocess", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            fly(study, out)
    assert (out / TABLE).read_bytes() == whole
    assert manifest_of(out)["state"] == "running"
    assert fly(study, out, resume=True).all_met
    assert [begun(marks, number) for number in range(8)] == [1] * 8


def test_a_task_whose_process_was_lost_is_a_row_and_is_tried_again_when_the_run_goes_on(
    marks, out, whole
):
    def dies():
        os.kill(os.getpid(), signal.SIGKILL)

    result = fly(SquareStudy(Squares(marks=marks, does={4: dies})), out, jobs=1)
    assert not result.all_met
    assert not result.verdict.interrupted
    lost = rows_of(out, TABLE)[4]
    assert lost["number"] == 4
    assert "SIGKILL" in lost["reason"]
    assert manifest_of(out)["state"] == "complete"
    assert fly(SquareStudy(Squares(marks=marks)), out, resume=True).all_met
    assert [begun(marks, number) for number in range(8)] == [1, 1, 1, 1, 3, 1, 1, 1]
    assert (out / TABLE).read_bytes() == whole


@pytest.mark.parametrize(
    ("name", "room", "left"),
    # The manifest is written at the beginning and at the end.
    [("write_bytes", 3, 3), ("write_json", 1, 8)],
)
def test_a_disk_that_is_full_keeps_what_is_done(marks, out, whole, monkeypatch, name, room, left):
    study, write, written = SquareStudy(Squares(marks=marks)), getattr(RunDirectory, name), []

    def write_until_full(*arguments):
        if len(written) == room:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written.append(arguments)
        write(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(RunDirectory, name, write_until_full)
        with pytest.raises(InputError, match=r"is full; .* continue with --resume") as refused:
            fly(study, out)
        assert "\n" not in str(refused.value)
    again, reports = reported(study, out, resume=True)
    assert again.all_met
    assert reports[0] == ("flying", left, 8)
    assert [begun(marks, number) for number in range(left)] == [1] * left
    assert (out / TABLE).read_bytes() == whole


def test_a_journal_that_cannot_be_opened_is_refused_and_the_run_continues_once_it_can(
    marks, out, whole
):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out, progress=interrupt_at(3))
    # A directory in the place of SQLite's log refuses every user, also root, as a file system
    # without write access does.
    log = out / "journal.sqlite-wal"
    log.mkdir()
    with pytest.raises(InputError, match=r"journal\.sqlite' cannot be used: .* --resume"):
        fly(study, out, resume=True)
    log.rmdir()
    assert fly(study, out, resume=True).all_met
    assert (out / TABLE).read_bytes() == whole


def test_a_run_is_continued_by_the_same_code_and_configuration_only(marks, out):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out, progress=interrupt_at(3))
    before = manifest_of(out)
    for name in ("jsbsim", "source"):
        write_manifest(out, before | {"fingerprint": before["fingerprint"] | {name: "0.0.1"}})
        with pytest.raises(InputError, match=rf"was started with {name} 0\.0\.1, now it is"):
            fly(study, out, resume=True)
    write_manifest(out, before)
    with pytest.raises(InputError, match="holds another run; choose another --out"):
        fly(study, out)
    with pytest.raises(InputError, match="another configuration"):
        fly(SquareStudy(Squares(marks=marks), config_hash="b"), out, resume=True)
    assert len(list((out / "files").iterdir())) >= 3
    assert fly(study, out, resume=True).all_met


def test_a_run_that_another_program_flies_is_left_to_it(marks, out):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out, progress=interrupt_at(3))
    other = Journal(out / "journal.sqlite")
    before = (out / "manifest.json").read_bytes()
    (out / ".table.part").touch()  # what the other one is writing
    with pytest.raises(InputError, match="another program is writing to"):
        fly(study, out, resume=True)
    other.close()
    assert (out / ".table.part").exists()
    assert (out / "manifest.json").read_bytes() == before
    assert fly(study, out, resume=True).all_met


def state_of(out):
    """Return content, number and time of every file, and when it was written."""
    return {
        path.relative_to(out).as_posix(): (
            path.read_bytes(),
            path.stat().st_ino,
            path.stat().st_mtime_ns,
        )
        for path in sorted(out.rglob("*"))
        if path.is_file()
    }


@pytest.mark.parametrize("resume", [False, True])
def test_a_run_that_was_killed_between_journal_and_manifest_is_begun_anew(
    marks, out, whole, monkeypatch, resume
):
    study = SquareStudy(Squares(marks=marks))
    with monkeypatch.context() as patch:
        patch.setattr(RunDirectory, "write_json", lambda *_: os._exit(9))
        pid = os.fork()
        if not pid:
            fly(study, out)
        os.waitpid(pid, 0)
    assert [path.name for path in out.iterdir() if not path.name.startswith("journal.sqlite")] == []
    assert (out / "journal.sqlite").is_file()
    assert fly(study, out, resume=resume).all_met
    assert (out / TABLE).read_bytes() == whole


def test_results_without_a_manifest_are_neither_overwritten_nor_believed(marks, out):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out)
    for path in out.iterdir():
        if path.name in ("manifest.json", "verdict.json", TABLE):
            path.unlink()
    for path in (out / "files").iterdir():
        path.unlink()
    (out / "files").rmdir()
    before = state_of(out)
    for resume in (False, True):
        with pytest.raises(
            InputError, match=r"has results without a manifest\.json; choose another --out"
        ):
            fly(study, out, resume=resume)
    assert state_of(out) == before


def test_an_interrupted_write_leaves_the_old_file(tmp_path):
    path = tmp_path / "summary.csv"
    path.write_text("old", encoding="utf-8")

    def fails(part):
        part.write_text("half", encoding="utf-8")
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_whole(path, fails)
    assert path.read_text(encoding="utf-8") == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(
    "name", ["../out.txt", "flights/../../out.txt", "/tmp/../{absolute}/out.txt", "linked/out.txt"]
)
def test_nothing_is_written_outside_of_the_run(tmp_path, name):
    run = RunDirectory(tmp_path / "a" / "run")
    run.open("a", resume=False)
    (run.path / "linked").symlink_to(tmp_path)
    before = sorted(tmp_path.rglob("*"))
    for write in (
        lambda path: run.write_bytes(path, b""),
        lambda path: run.write_frame(path, pd.DataFrame()),
    ):
        with pytest.raises(InputError, match="would be written outside of"):
            write(name.format(absolute=tmp_path))
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("resume", [False, True])
def test_what_a_run_leaves_that_was_killed_before_its_manifest_is_taken_for_a_new_one(
    tmp_path, resume
):
    for name in (
        "journal.sqlite",
        "journal.sqlite-wal",
        ".probe-0a1b.part",
        ".manifest.json.1.part",
    ):
        (tmp_path / name).touch()
        assert RunDirectory(tmp_path).open("a", resume=resume) == {}
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match=r"not empty|holds no run"):
        RunDirectory(tmp_path).open("a", resume=resume)


@pytest.mark.parametrize(
    ("name", "decides"),
    [
        ("measurement/sniffer/sniffer.py", True),
        ("measurement/sniffer/presets/fast.toml", True),
        ("aircraft/models/aircraft/x8/x8.xml", True),
        ("scenarios/planning/crossing_limits.json", True),
        ("scenarios/flight_runner.py", True),
        # Scenarios are compared by their content.
        ("scenarios/catalog/sea/arena.toml", False),
        ("gnc/EQUATIONS.md", False),
        ("scenarios/__pycache__/flight.cpython-311.pyc", False),
        ("reports/build.py", False),
    ],
)
def test_the_hash_changes_with_what_decides_results_and_with_nothing_else(tmp_path, name, decides):
    path = tmp_path / name
    path.parent.mkdir(parents=True)
    path.write_text("one", encoding="utf-8")
    before = source_hash(tmp_path)
    path.write_text("two", encoding="utf-8")
    assert (source_hash(tmp_path) != before) is decides
