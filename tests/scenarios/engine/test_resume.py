"""What a resumed run rewrites, removes and begins anew."""

import os

import pytest
from engine_cases import TABLE, Squares, SquareStudy, fly

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
