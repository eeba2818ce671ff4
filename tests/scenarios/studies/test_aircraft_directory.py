"""An aircraft of the user's own directory through the command line: flown, reported, resumed,
replayed, listed, refused.

The aircraft is that of docs/scripts/aircraft_directory.py, so that its design is made once.
"""

import runpy
import shutil
from pathlib import Path

import pandas as pd
import pytest

from measurement.emission import DEFAULT_STACK_HEIGHT
from reports.output import write_report
from reports.run.run_data import read_run
from tests.in_process import assert_refused, run_command
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

SCRIPT = Path(__file__).parents[3] / "docs" / "scripts" / "aircraft_directory.py"
SWEEP = [
    "--set",
    "sweep.nu=[0.6]",
    "--set",
    "flight.crossings=4",
    "--set",
    "comparison.variants=[]",
    "--set",
    "histories=2",
]


@pytest.fixture(scope="module")
def heavy(tmp_path_factory):
    """A Cessna that is heavier by 150 lb, in a directory."""
    write = runpy.run_path(str(SCRIPT))["write_heavy_cessna"]
    return write(tmp_path_factory.mktemp("hangar") / "fleet")


@pytest.fixture(scope="module")
def flown(heavy, heavy_design):
    """The run of a short sweep with it, and how the command ended."""
    out = heavy.parents[1] / "run"
    ended = run_command(
        "scenarios.run",
        "sweep_nu",
        "--aircraft-dir",
        heavy.parent,
        *SWEEP,
        "--out",
        out,
        "--jobs",
        1,
        "--no-report",
    )
    return out, ended


def test_a_sweep_with_it_meets_every_criterion_and_names_it_in_report_and_manifest(
    flown, heavy, tmp_path
):
    out, ended = flown
    assert ended.status == 0, ended
    rows = pd.read_csv(out / "summary.csv")
    assert rows["criteria_met"].tolist() == [True]
    assert rows["aircraft"].tolist() == [str(heavy)]
    manifest = manifest_of(out)
    assert manifest["config"]["aircraft"] == str(heavy)
    assert len(manifest["plugins"][str(heavy)]) == 16
    assert "criteria.tracking_error_rms_m" in manifest["scaled_parameters"]["sweep_nu"]
    write_report(read_run(out), page := tmp_path / "report.html")
    assert "Heavy Cessna" in page.read_text(encoding="utf-8")
    # The run has the model that it flew, with its weight.
    assert "1650" in (out / "model" / "aircraft" / "heavy" / "heavy.xml").read_text(
        encoding="utf-8"
    )


def test_it_is_resumed_and_replayed_as_it_was_and_where_it_is_now_but_not_changed(
    flown, heavy, tmp_path, monkeypatch
):
    out, _ = flown
    # Nothing is designed for what is refused; the design of what is flown is cached.
    monkeypatch.setattr(
        "innerloop.designer.design_autopilot",
        lambda spec, _: pytest.fail(f"{spec.title} is designed for"),
    )
    same = (
        "scenarios.run",
        "sweep_nu",
        "--aircraft-dir",
        heavy.parent,
        *SWEEP,
        "--out",
        out,
        "--resume",
        "--no-report",
    )
    assert run_command(*same).status == 0
    flight = out / "flights" / "nu_0.60"
    moved = shutil.copytree(heavy.parent, tmp_path / "moved")
    again = run_command(
        "scenarios.run", flight, "--aircraft-dir", moved, "--out", tmp_path / "again", "--no-report"
    )
    assert again.status == 0, again
    assert "agrees to the last bit" in again.out
    model = moved / "heavy" / "heavy.xml"
    model.write_text(model.read_text(encoding="utf-8").replace("1650", "1660"), encoding="utf-8")
    changed = run_command(
        "scenarios.run",
        flight,
        "--aircraft-dir",
        moved,
        "--out",
        tmp_path / "changed",
        "--no-report",
    )
    assert_refused(changed, "heavy' has changed since the run")
    shutil.copyfile(moved / "heavy" / "heavy.toml", tmp_path / "before")
    (heavy / "heavy.toml").write_text('title = "Heavier Cessna"', encoding="utf-8")
    assert_refused(run_command(*same), "heavy' has changed since the run")
    shutil.copyfile(tmp_path / "before", heavy / "heavy.toml")


def test_the_directory_is_designed_for_and_listed(flown, heavy, tmp_path):
    # At the height of the sweep, whose design is cached.
    place = ("--aircraft-dir", heavy.parent, "--altitude", DEFAULT_STACK_HEIGHT)
    ended = run_command("innerloop.design", *place, "--out", tmp_path / "design", "--no-report")
    assert ended.status == 0, ended
    assert (tmp_path / "design" / "model" / "aircraft" / "heavy" / "heavy.xml").is_file()
    listed = run_command("innerloop.design", "--list", *place)
    (line,) = listed.out.splitlines()
    assert line.startswith(f"flies {heavy} ")
    altitude = f"{float(place[-1]):g} m"
    assert f"1 can be flown at {altitude} (--altitude for another altitude)\n" in listed.errors
    assert run_command("innerloop.design", "--list", "--check", *place).out == listed.out
    # At another height nothing is designed for a list.
    elsewhere = run_command("innerloop.design", "--list", *place[:2], "--altitude", 777)
    assert elsewhere.out.split(maxsplit=2) == ["?", str(heavy), "not designed before for 777 m\n"]
    assert "0 can be flown at 777 m (--altitude for another altitude)" in elsewhere.errors
    assert "; 1 was not designed for it before: --list --check designs them" in elsewhere.errors
    assert_refused(run_command("innerloop.design", "--check", *place), "--check is for --list")
