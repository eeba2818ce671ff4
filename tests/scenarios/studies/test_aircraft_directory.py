"""An aircraft of the user's own directory through the command line: flown, resumed, replayed,
listed, refused.

The aircraft is that of docs/scripts/aircraft_directory.py, so that its design is made once.
"""

import runpy
import shutil
from pathlib import Path

import pandas as pd
import pytest

from measurement.emission import DEFAULT_STACK_HEIGHT
from tests.in_process import assert_refused, run_command
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

SCRIPT = Path(__file__).parents[3] / "docs" / "scripts" / "aircraft_directory.py"
KEYS = ("sweep.nu=[0.6]", "flight.crossings=4", "comparison.variants=[]", "histories=2")
SWEEP = ["sweep_nu", "--jobs", 1, *(word for key in KEYS for word in ("--set", key))]


def flown(words, fleet, out, *more):
    place = ("--aircraft-dir", fleet, "--out", out)
    return run_command("scenarios.run", *words, *place, "--no-report", *more)


@pytest.fixture(scope="module")
def heavy(tmp_path_factory, heavy_design):
    """A Cessna that is heavier by 150 lb, in a directory."""
    write = runpy.run_path(str(SCRIPT))["write_heavy_cessna"]
    return write(tmp_path_factory.mktemp("hangar") / "fleet")


def test_it_flies_and_is_resumed_and_replayed_where_it_is_now_but_not_changed(
    heavy, tmp_path, monkeypatch
):
    out = tmp_path / "run"
    assert flown(SWEEP, heavy.parent, out).status == 0
    rows = pd.read_csv(out / "summary.csv")
    assert rows["criteria_met"].tolist() == [True]
    assert rows["aircraft"].tolist() == [str(heavy)]
    manifest = manifest_of(out)
    assert manifest["config"]["aircraft"] == str(heavy)
    assert len(manifest["plugins"][str(heavy)]) == 16
    assert "criteria.tracking_error_rms_m" in manifest["scaled_parameters"]["sweep_nu"]
    # The run has the model that it flew, with its weight.
    assert "1650" in (out / "model" / "aircraft" / "heavy" / "heavy.xml").read_text("utf-8")
    # The design of what is flown is cached.
    monkeypatch.setattr("innerloop.designer.design_autopilot", lambda *_: pytest.fail("designed"))
    assert flown(SWEEP, heavy.parent, out, "--resume").status == 0
    flight = [out / "flights" / "nu_0.60"]
    moved = shutil.copytree(heavy.parent, tmp_path / "moved")
    again = flown(flight, moved, tmp_path / "again")
    assert again.status == 0, again
    assert "agrees to the last bit" in again.out
    model = moved / "heavy" / "heavy.xml"
    model.write_text(model.read_text(encoding="utf-8").replace("1650", "1660"), encoding="utf-8")
    assert_refused(flown(flight, moved, tmp_path / "changed"), "heavy' has changed since the run")


def test_the_directory_is_designed_for_and_listed(heavy, tmp_path):
    # At the height of the sweep, whose design is cached.
    place = ("--aircraft-dir", heavy.parent, "--altitude", DEFAULT_STACK_HEIGHT)
    ended = run_command("innerloop.design", *place, "--out", tmp_path / "design", "--no-report")
    assert ended.status == 0, ended
    listed = run_command("innerloop.design", "--list", *place)
    (line,) = listed.out.splitlines()
    assert line.startswith(f"flies {heavy} ")
    # At another height nothing is designed for a list.
    elsewhere = run_command("innerloop.design", "--list", *place[:2], "--altitude", 777)
    assert elsewhere.out.split(maxsplit=2) == ["?", str(heavy), "not designed before for 777 m\n"]
    assert_refused(run_command("innerloop.design", "--check", *place), "--check is for --list")
