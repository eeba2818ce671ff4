"""The directory of an estimate: what it takes the place of, and what it does not."""

import json
from pathlib import Path

import pandas as pd
import pytest
from logged_flights import run

from measurement.estimate.__main__ import main

pytestmark = pytest.mark.usefixtures("briefly")


def test_a_directory_that_cannot_be_written_is_refused(logged, capsys):
    (logged.parent / "out").write_text("in the way", encoding="utf-8")
    assert run(logged) == 2
    assert "give another --out" in capsys.readouterr().err


@pytest.mark.parametrize("manifest", ['{"study": "flights", "state": "complete"}', "[]", "{"])
def test_the_command_does_not_write_over_a_run_of_another_kind(logged, capsys, manifest):
    out = logged.parent / "out"
    out.mkdir()
    (out / "manifest.json").write_text(manifest, encoding="utf-8")
    assert run(logged) == 2
    told = capsys.readouterr().err
    assert told == f"error: output directory '{out}' holds another run; choose another --out\n"
    assert [path.name for path in out.iterdir()] == ["manifest.json"]
    assert (out / "manifest.json").read_text(encoding="utf-8") == manifest


def test_two_logs_of_one_name_do_not_share_the_default_directory(
    logged, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / logged.name
    pd.read_csv(logged).iloc[:200].to_csv(other, index=False)
    assert main([str(logged), "--no-report"]) == 0
    out = Path("runs") / f"measurement_{logged.stem}"
    before = (out / "manifest.json").read_bytes()
    capsys.readouterr()
    assert main([str(other), "--no-report"]) == 2
    told = f"error: '{out}' holds the estimate of another log than '{other}'; give another --out\n"
    assert capsys.readouterr().err == told
    assert (out / "manifest.json").read_bytes() == before
    # The same log is estimated anew, and a directory that was asked for is replaced.
    assert main([str(logged), "--no-report"]) == 0
    assert main([str(other), "--out", str(out), "--no-report"]) == 0


def test_an_estimate_made_anew_leaves_no_report_of_the_older_one(logged):
    assert run(logged) == 0
    out = logged.parent / "out"
    for name in ("report.html", "report.pdf"):
        (out / name).write_text("of the older estimate", encoding="utf-8")
    (out / "export").mkdir()
    (out / "export" / "flight.kml").write_text("of the older estimate", encoding="utf-8")
    assert run(logged) == 0
    assert sorted(path.name for path in out.iterdir()) == [
        "estimate.json",
        "manifest.json",
        "samples.csv",
    ]


@pytest.mark.parametrize("console", [True, False])
def test_command_and_revision_are_recorded_as_those_of_flights(
    logged, monkeypatch, tmp_path, console
):
    shared = pytest.importorskip("common.provenance", reason="measurement stands alone here")
    arguments = [str(logged), "--out", "m", "--no-report"]
    monkeypatch.chdir(tmp_path)
    if console:
        monkeypatch.setattr("sys.argv", ["/anywhere/bin/plume-flight", "estimate", *arguments])
    assert main(arguments) == 0
    manifest = json.loads((tmp_path / "m" / "manifest.json").read_text(encoding="utf-8"))
    program = "plume-flight estimate" if console else "python -m measurement.estimate"
    # As of a flight's run: without the folders of this machine.
    assert manifest["command"] == f"{program} flight.csv --out m --no-report"
    assert manifest["git_revision"] == shared.provenance()["git_revision"]
