"""What a resumed run rewrites, removes and begins anew."""

import functools
import multiprocessing
import os
import time

import pytest
from engine_cases import TABLE, Squares, SquareStudy, begun, fly, interrupt_at

from scenarios.engine.run_directory import RunDirectory
from scenarios.errors import InputError


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


def test_a_resumed_run_makes_what_is_missing_and_leaves_the_rest(marks, out):
    study = SquareStudy(Squares(marks=marks))
    fly(study, out)
    (out / "report.html").touch()
    before = state_of(out)
    (out / TABLE).unlink()
    assert fly(study, out, resume=True).changed
    after = state_of(out)
    assert after[TABLE][0] == before[TABLE][0]
    differing = {name for name in {*before, *after} if before.get(name) != after.get(name)}
    assert differing == {TABLE, "manifest.json"}
    # Nothing is flown for it.
    assert [begun(marks, number) for number in range(8)] == [1] * 8


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


def resume(study, out, barrier, results):
    barrier.wait()
    try:
        results.put(str(fly(study, out, resume=True).all_met))
    except InputError as error:
        results.put(str(error))


def test_of_two_that_resume_at_once_one_is_refused_in_a_line(marks, out, whole):
    # Each takes longer than the other needs to come.
    work = Squares(marks=marks, does=dict.fromkeys(range(3, 8), functools.partial(time.sleep, 0.1)))
    fly(SquareStudy(work), out, progress=interrupt_at(2))
    context = multiprocessing.get_context("fork")
    barrier, results = context.Barrier(2), context.Queue()
    both = [
        context.Process(target=resume, args=(SquareStudy(work), out, barrier, results))
        for _ in range(2)
    ]
    for process in both:
        process.start()
    refused, done = sorted(
        (results.get(timeout=30), results.get(timeout=30)), key=lambda text: text == "True"
    )
    for process in both:
        process.join()
    assert done == "True"
    assert (
        refused
        == f"another program is writing to '{out}'; wait until it has ended, or choose another --out"
    )
    assert (out / TABLE).read_bytes() == whole
