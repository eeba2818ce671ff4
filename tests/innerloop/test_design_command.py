"""What ``python -m innerloop.design`` leaves behind, and what it leaves alone."""

import json

import pytest

from reports.registry import content
from reports.run.run_data import read_run
from tests.in_process import run_command
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

HEIGHT = ("--altitude", 60.0)
"""That of the designs that other tests have too."""


@pytest.mark.usefixtures("sketched")
def test_the_command_leaves_a_directory_to_report_on_and_may_repeat_the_search(tmp_path):
    ended = run_command(
        "innerloop.design", "x8", *HEIGHT, "--out", tmp_path / "x8", "--reversals", 3
    )
    assert ended.status == 0, ended.errors
    assert {"manifest.json", "innerloop.json", "report.html", "report.pdf", "model"} <= {
        p.name for p in (tmp_path / "x8").iterdir()
    }
    assert manifest_of(tmp_path / "x8")["study"] == "design"
    assert content(read_run(tmp_path / "x8")).verdict.headline in ended.out
    own = json.loads((tmp_path / "x8" / "innerloop.json").read_text(encoding="utf-8"))[
        "turn_reversal"
    ]
    found = own["repeated_search"]
    assert found["reversals"] == 3
    # Other random numbers than the design's own search has, which stays as it was.
    assert found["deviation_max_m"] != own["deviation_max_m"] > 0.0
    assert f"{found['deviation_max_m']:.2f} m nearer" in " ".join(ended.out.split())


@pytest.mark.parametrize("reversals", ["0", "many", "2000000"])
def test_a_number_of_reversals_that_cannot_be_flown_is_refused(tmp_path, reversals):
    refused = run_command(
        "innerloop.design", "x8", "--out", tmp_path / "x8", "--reversals", reversals
    )
    assert refused.status == 2
    assert "--reversals" in refused.errors
    assert not (tmp_path / "x8").exists()


def test_a_design_made_anew_leaves_no_report_of_the_older_one(tmp_path, designs):
    designs("x8")
    out = tmp_path / "x8"
    (out / "export").mkdir(parents=True)
    (out / "manifest.json").write_text('{"study": "design"}', encoding="utf-8")
    for name in ("report.html", "report.pdf", "export/x8.csv", "notes.txt"):
        (out / name).write_text("of the older one", encoding="utf-8")
    assert run_command("innerloop.design", "x8", *HEIGHT, "--out", out, "--no-report").status == 0
    # What somebody else put there stays.
    assert {path.name for path in out.iterdir()} == {
        "manifest.json",
        "innerloop.json",
        "model",
        "notes.txt",
    }
