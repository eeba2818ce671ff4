import pandas as pd
import pytest

from common.files import write_whole
from scenarios.engine.run_directory import RunDirectory, fingerprint, source_hash
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
