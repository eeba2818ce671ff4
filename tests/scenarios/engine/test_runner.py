"""A run directory that is flown, interrupted, out of room and gone on with."""

import errno
import os
import re
import signal

import pytest
from engine_cases import TABLE, Squares, SquareStudy, begun, fly, interrupt_at

from scenarios.engine import runner
from scenarios.engine.journal import Journal
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.runner import DASK, ExecutorFactory
from scenarios.errors import InputError
from tests.run_tables import manifest_of, rows_of, write_manifest


def test_a_run_has_its_table_its_files_and_says_how_it_ended(marks, out):
    told = []
    result = fly(
        SquareStudy(Squares(marks=marks)), out, progress=lambda *report: told.append(report)
    )
    assert (
        result.all_met,
        result.verdict.interrupted,
        result.verdict.counts.planned,
        result.verdict.counts.done,
    ) == (
        True,
        False,
        8,
        8,
    )
    assert (result.verdict.what, result.directory) == ("squares", out)
    assert rows_of(out, TABLE) == [{"number": i, "square": float(i**2)} for i in range(8)]
    assert sorted(path.name for path in (out / "files").iterdir()) == [f"{i}.txt" for i in range(8)]
    assert (manifest_of(out)["state"], manifest_of(out)["squares_done"]) == ("complete", 8)
    assert told == [*(("flying", i, 8) for i in range(9)), ("finishing", 8, 8)]


@pytest.mark.parametrize("jobs", [1, 2])
def test_the_table_is_the_same_from_this_process_and_from_others(marks, out, whole, jobs):
    assert fly(SquareStudy(Squares(marks=marks)), out, jobs=jobs).all_met
    assert (out / TABLE).read_bytes() == whole


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
    told = []
    again = fly(study, out, jobs=jobs, resume=True, progress=lambda *report: told.append(report))
    assert again.all_met
    assert manifest_of(out)["state"] == "complete"
    # It says so from the beginning, and nothing that was done is done again.
    assert [done for doing, done, _ in told if doing == "flying"] == [3, 4, 5, 6, 7, 8]
    assert [begun(marks, number) for number in kept] == [1, 1, 1]
    assert (out / TABLE).read_bytes() == whole


def test_results_stand_in_the_table_though_what_follows_from_them_fails_and_the_run_goes_on(
    marks, out, whole, monkeypatch
):
    def fail(*_):
        raise ZeroDivisionError("of a statistic")

    monkeypatch.setattr(SquareStudy, "postprocess", fail)
    with pytest.raises(ZeroDivisionError, match="of a statistic"):
        fly(SquareStudy(Squares(marks=marks)), out)
    assert (out / TABLE).read_bytes() == whole
    assert manifest_of(out)["state"] == "running"
    monkeypatch.undo()
    assert fly(SquareStudy(Squares(marks=marks)), out, resume=True).all_met
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


def full_after(count, name):
    """Return a writing that finds the disk full after some files."""
    written = 0
    write = getattr(RunDirectory, name)

    def write_until_full(self, *arguments):
        nonlocal written
        if written == count:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        written += 1
        write(self, *arguments)

    return write_until_full


def refused_for_room(study, out):
    words = rf"the disk of '{re.escape(str(out))}' is full; .* are kept: .* continue with --resume"
    with pytest.raises(InputError, match=words) as refused:
        fly(study, out)
    assert "\n" not in str(refused.value)


def test_a_disk_that_is_full_keeps_what_is_done(marks, out, whole, monkeypatch):
    study = SquareStudy(Squares(marks=marks))
    with monkeypatch.context() as patch:
        patch.setattr(RunDirectory, "write_bytes", full_after(3, "write_bytes"))
        refused_for_room(study, out)
    told = []
    assert fly(study, out, resume=True, progress=lambda *report: told.append(report)).all_met
    assert told[0] == ("flying", 3, 8)
    assert [begun(marks, number) for number in range(3)] == [1] * 3
    assert (out / TABLE).read_bytes() == whole


def test_a_disk_that_is_full_at_the_end_keeps_everything(marks, out, whole, monkeypatch):
    study = SquareStudy(Squares(marks=marks))
    with monkeypatch.context() as patch:
        # The manifest is written at the beginning, and then at the end.
        patch.setattr(RunDirectory, "write_json", full_after(1, "write_json"))
        refused_for_room(study, out)
    assert fly(study, out, resume=True).all_met
    assert [begun(marks, number) for number in range(8)] == [1] * 8
    assert (out / TABLE).read_bytes() == whole


def test_a_journal_that_cannot_be_opened_is_refused_in_a_line_and_the_run_continues_once_it_can(
    marks, out, whole
):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out, progress=interrupt_at(3))
    # A directory in the place of SQLite's log refuses every user, root too, as a file system
    # without write access does.
    log = out / "journal.sqlite-wal"
    log.mkdir()
    words = r"journal\.sqlite' cannot be used: unable to open database file; make .* writable, then continue with --resume"
    with pytest.raises(InputError, match=words) as refused:
        fly(study, out, resume=True)
    assert "\n" not in str(refused.value)
    log.rmdir()
    assert fly(study, out, resume=True).all_met
    assert (out / TABLE).read_bytes() == whole


def test_a_run_that_other_code_began_is_not_gone_on_with(marks, out):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out, progress=interrupt_at(3))
    before = manifest_of(out)
    for name in ("jsbsim", "source"):
        other = before | {"fingerprint": before["fingerprint"] | {name: "0.0.1"}}
        write_manifest(out, other)
        words = rf"was started with {name} 0\.0\.1, now it is .*: results would not be comparable"
        with pytest.raises(InputError, match=words) as refused:
            fly(study, out, resume=True)
        assert "\n" not in str(refused.value)
    # Nothing of it was touched.
    assert len(list((out / "files").iterdir())) >= 3
    write_manifest(out, before)
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


@pytest.mark.parametrize("scheduler", [None, "tcp://10.0.0.1:8786"])
def test_dask_where_it_is_not_installed_is_refused_with_what_to_install(monkeypatch, scheduler):
    monkeypatch.setattr(runner, "find_spec", lambda _: None)
    with pytest.raises(
        InputError,
        match=r"--executor is dask, which .* pip install -c constraints.txt -e '\.\[dask\]'",
    ) as refused:
        ExecutorFactory(executor=DASK, scheduler=scheduler)
    assert "\n" not in str(refused.value)
