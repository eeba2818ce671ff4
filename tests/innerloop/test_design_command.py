"""What ``python -m innerloop.design`` leaves behind, and what it leaves alone."""

import json
import subprocess
import sys
from pathlib import Path

from reports.registry import content
from reports.run.run_data import read_run
from tests.in_process import run_command

PROJECT = Path(__file__).parents[2]


def design_command(*arguments):
    command = [sys.executable, "-m", "innerloop.design", *map(str, arguments)]
    return subprocess.run(command, cwd=PROJECT, capture_output=True, text=True, check=False)


def test_the_command_leaves_a_directory_that_can_be_reported_on_again(tmp_path):
    done = design_command("x8", "--out", tmp_path / "x8")
    assert done.returncode == 0, done.stderr
    assert {"manifest.json", "innerloop.json", "report.html", "report.pdf", "model"} <= {
        p.name for p in (tmp_path / "x8").iterdir()
    }
    manifest = json.loads((tmp_path / "x8" / "manifest.json").read_text(encoding="utf-8"))
    assert (manifest["study"], manifest["name"]) == ("design", "x8")
    assert manifest["packages"]["jsbsim"]
    assert content(read_run(tmp_path / "x8")).verdict.headline in done.stdout


def test_the_command_does_not_write_over_flights(tmp_path):
    (tmp_path / "manifest.json").write_text('{"study": "flights"}', encoding="utf-8")
    refused = design_command("x8", "--out", tmp_path)
    assert refused.returncode == 2
    assert "holds another run; choose another --out" in refused.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["manifest.json"]


def test_a_design_made_anew_leaves_no_report_of_the_older_one(tmp_path, designs):
    designs("x8")
    out = tmp_path / "x8"
    (out / "export").mkdir(parents=True)
    (out / "manifest.json").write_text('{"study": "design"}', encoding="utf-8")
    for name in ("report.html", "report.pdf", "export/x8.csv", "notes.txt"):
        (out / name).write_text("of the older one", encoding="utf-8")
    assert run_command("innerloop.design", "x8", "--out", out, "--no-report").status == 0
    # What somebody else put there stays.
    assert {path.name for path in out.iterdir()} == {"manifest.json", "innerloop.json", "model", "notes.txt"}
