import pytest

from common.files import write_whole
from scenarios.engine.fingerprint import fingerprint
from scenarios.engine.run_directory import RunDirectory
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
    run.open_new()
    run.write_json(run.manifest, {"config_hash": "a", "fingerprint": fingerprint()})
    with pytest.raises(InputError, match="holds another run; choose another --out, or continue it with --resume"):
        run.open_new()
    run.open_existing("a")
    with pytest.raises(InputError, match="another configuration"):
        run.open_existing("b")


def test_a_directory_with_other_things_in_it_is_refused(tmp_path):
    (tmp_path / "thesis.tex").touch()
    with pytest.raises(InputError, match="not empty"):
        RunDirectory(tmp_path).open_new()


def test_a_path_that_cannot_be_a_directory_is_refused(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(InputError, match="cannot be written"):
        RunDirectory(tmp_path / "file" / "run").open_new()


def test_resuming_needs_a_run(tmp_path):
    with pytest.raises(InputError, match="holds no run to resume"):
        RunDirectory(tmp_path).open_existing("a")


@pytest.mark.parametrize("text", ["", "{", "[]", "{}"])
def test_a_manifest_that_says_too_little_is_refused_in_a_line(tmp_path, text):
    run = RunDirectory(tmp_path)
    run.manifest.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match="cannot be read; start a new run in another --out") as refused:
        run.open_existing("a")
    assert "\n" not in str(refused.value)


def test_a_file_of_the_run_is_written_with_the_directory_that_it_is_in(tmp_path):
    run = RunDirectory(tmp_path / "run")
    run.open_new()
    run.write_bytes("flights/a.parquet", b"PAR1")
    assert (run.path / "flights" / "a.parquet").read_bytes() == b"PAR1"
    assert [path.name for path in (run.path / "flights").iterdir()] == ["a.parquet"]
