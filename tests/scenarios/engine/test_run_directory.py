import ast
from pathlib import Path

import pandas as pd
import pytest

from common.files import write_whole
from scenarios.engine.run_directory import SOURCE, RunDirectory, fingerprint, source_hash
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


ROOT = Path(__file__).parents[3]

SHOWS = {"reports"}
"""Packages that ``scenarios`` imports to show results, on which results do not depend."""


def imported(path):
    """Return the top-level names that a module imports."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]


def test_every_package_that_a_flight_imports_is_in_the_hash():
    found = {
        name
        for package in SOURCE
        for path in (ROOT / package).rglob("*.py")
        for name in imported(path)
    }
    assert {name for name in found if (ROOT / name / "__init__.py").is_file()} - SHOWS == set(
        SOURCE
    )


@pytest.mark.parametrize(
    ("name", "decides"),
    [
        ("measurement/sniffer/sniffer.py", True),
        ("measurement/sniffer/presets/fast.toml", True),
        ("aircraft/models/aircraft/x8/x8.xml", True),
        ("scenarios/planning/crossing_limits.json", True),
        ("scenarios/flight_runner.py", True),
        # Scenarios are compared by their content, and neither documents nor compiled files decide
        # anything.
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


def test_the_hash_of_this_program_is_that_of_this_source():
    # Past the cache: a file may have been edited since it was filled.
    assert fingerprint.__wrapped__()["source"] == source_hash(ROOT)
