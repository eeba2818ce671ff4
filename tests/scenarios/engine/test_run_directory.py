import pandas as pd
import pytest

from common.files import write_whole
from scenarios.engine.run_directory import RunDirectory, fingerprint
from scenarios.errors import InputError


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


def test_a_directory_that_holds_a_run_is_refused(tmp_path):
    run = RunDirectory(tmp_path / "run")
    run.open("a", resume=False)
    run.write_json(run.manifest, {"config_hash": "a", "fingerprint": fingerprint()})
    with pytest.raises(
        InputError, match="holds another run; choose another --out, or continue it with --resume"
    ):
        run.open("a", resume=False)
    run.open("a", resume=True)
    with pytest.raises(InputError, match="another configuration"):
        run.open("b", resume=True)


def test_a_directory_with_other_things_in_it_is_refused(tmp_path):
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match="not empty"):
        RunDirectory(tmp_path).open("a", resume=False)


def test_a_path_that_cannot_be_a_directory_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be written"):
        RunDirectory(tmp_path / "file" / "run").open("a", resume=False)


def test_resuming_needs_a_run(tmp_path):
    with pytest.raises(InputError, match="holds no run to resume"):
        RunDirectory(tmp_path).open("a", resume=True)


@pytest.mark.parametrize("text", ["", "{", "[]", "{}"])
def test_a_manifest_that_says_too_little_is_refused_in_a_line(tmp_path, text):
    run = RunDirectory(tmp_path)
    run.manifest.write_text(text, encoding="utf-8")
    with pytest.raises(
        InputError, match="cannot be read; start a new run in another --out"
    ) as refused:
        run.open("a", resume=True)
    assert "\n" not in str(refused.value)


def test_a_file_of_the_run_is_written_with_the_directory_that_it_is_in(tmp_path):
    run = RunDirectory(tmp_path / "run")
    run.open("a", resume=False)
    run.write_bytes("flights/a.parquet", b"PAR1")
    assert (run.path / "flights" / "a.parquet").read_bytes() == b"PAR1"
    assert [path.name for path in (run.path / "flights").iterdir()] == ["a.parquet"]


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
        with pytest.raises(
            InputError, match=r"would be written outside of .*; do not use this run"
        ):
            write(name.format(absolute=tmp_path))
    assert sorted(tmp_path.rglob("*")) == before


def test_a_run_with_a_link_in_it_is_not_resumed(tmp_path):
    run = RunDirectory(tmp_path / "run")
    run.open("a", resume=False)
    run.write_json(run.manifest, {"config_hash": "a", "fingerprint": fingerprint()})
    (run.path / "model").symlink_to(tmp_path)
    with pytest.raises(InputError, match=r"model' is a link; .*: replace it by what it links to"):
        run.open("a", resume=True)


def test_a_file_with_the_same_content_is_left_as_it_is(tmp_path):
    path = tmp_path / "summary.csv"
    write_whole(path, lambda part: part.write_text("one", encoding="utf-8"))
    before = path.stat()
    write_whole(path, lambda part: part.write_text("one", encoding="utf-8"))
    assert (path.stat().st_ino, path.stat().st_mtime_ns) == (before.st_ino, before.st_mtime_ns)
    write_whole(path, lambda part: part.write_text("two", encoding="utf-8"))
    assert path.read_text(encoding="utf-8") == "two"
    assert list(tmp_path.iterdir()) == [path]


def test_texts_of_a_table_are_no_formulas_and_its_numbers_stay_numbers(tmp_path):
    run = RunDirectory(tmp_path)
    run.write_frame("a.csv", pd.DataFrame({"text": ["=1+1", "plain"], "number": [-1.5, 2.0]}))
    assert (tmp_path / "a.csv").read_text(
        encoding="utf-8"
    ) == "text,number\n'=1+1,-1.5\nplain,2.0\n"


def test_a_path_too_long_for_the_file_system_is_refused_in_a_line(tmp_path):
    for resume in (False, True):
        with pytest.raises(
            InputError, match=r"cannot be written: File name too long; choose another --out"
        ) as refused:
            RunDirectory(tmp_path / ("a" * 300)).open("a", resume=resume)
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize(
    "names",
    [
        ["journal.sqlite"],
        ["journal.sqlite", "journal.sqlite-wal"],
        [".probe-0a1b.part"],
        ["journal.sqlite", ".manifest.json.1.part"],
    ],
)
def test_what_a_run_leaves_that_was_killed_before_its_manifest_is_taken_for_a_new_one(
    tmp_path, names, resume
):
    for name in names:
        (tmp_path / name).touch()
    assert RunDirectory(tmp_path).open("a", resume=resume) == {}
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match=r"not empty|holds no run"):
        RunDirectory(tmp_path).open("a", resume=resume)
