"""One flight of a run, flown again from its run directory."""

import json
import shutil

import pandas as pd
import pytest
from flight_cases import replay_here, run_here

from scenarios.errors import InputError
from scenarios.studies.replay import Replay
from tests.run_tables import manifest_of, write_manifest
from tests.scenarios.short_trial import short_trial

pytestmark = pytest.mark.slow

TRIAL = short_trial(flights=3, duration=10.0, histories=3, spread=180.0)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A list of two trials, and a sweep with a comparison."""
    folder = tmp_path_factory.mktemp("runs")
    for name in ("one", "two"):
        (folder / f"{name}.toml").write_text(TRIAL, encoding="utf-8")
    trials = json.dumps([str(folder / "one.toml"), str(folder / "two.toml")])
    text = f'study = "trials"\ntitle = "two"\ntrials = {trials}\n'
    (folder / "list.toml").write_text(text, encoding="utf-8")
    run_here(folder / "list.toml", folder / "trials")
    sweep = [
        "fidelity=kinematic",
        "sweep.nu=[0.3, 0.5]",
        "comparison.nu=[0.5]",
        "flight.crossings=3",
    ]
    run_here("sweep_nu", folder / "sweep", *sweep)
    # The run has its scenarios.
    (folder / "two.toml").unlink()
    return folder


@pytest.mark.parametrize(
    ("run", "flight_id", "table"),
    [
        ("trials", "two_00002", "summary.csv"),
        ("sweep", "nu_0.50_no_preview", "comparison.csv"),
    ],
)
def test_a_flight_is_flown_again_identically_with_every_step_of_the_guidance(
    runs, tmp_path, run, flight_id, table
):
    before = {path: path.stat().st_mtime_ns for path in (runs / run).rglob("*")}
    result = replay_here(runs / run / "flights" / flight_id, tmp_path / "again")
    assert {path: path.stat().st_mtime_ns for path in (runs / run).rglob("*")} == before
    assert result.all_met
    assert result.lines[-1].startswith("identical to the flight in")
    rows = pd.read_csv(runs / run / table).drop(columns="wall_time_s")
    again = pd.read_csv(tmp_path / "again" / "summary.csv").drop(columns="wall_time_s")
    one = rows[rows["flight_id"] == flight_id].reset_index(drop=True)
    pd.testing.assert_frame_equal(one, again, check_exact=True, check_dtype=False)
    samples = pd.read_parquet(runs / run / "flights" / f"{flight_id}.parquet")
    steps = pd.read_parquet(tmp_path / "again" / "flights" / f"{flight_id}.parquet")
    # 20 Hz of the guidance, of which the run kept 10.
    pd.testing.assert_frame_equal(steps[::2].reset_index(drop=True), samples, check_exact=True)
    assert steps["time_s"].diff()[1:].to_numpy() == pytest.approx(0.05, abs=1e-9)


def test_a_flight_that_goes_another_way_is_reported_with_what_has_changed(runs, tmp_path):
    copy = shutil.copytree(runs / "trials", tmp_path / "copy")
    manifest = manifest_of(copy)
    # As if it had been flown from another distance by another version.
    manifest["trials"]["one"]["start"]["distance_m"] = [500.0, 520.0]
    manifest["fingerprint"]["numpy"] = "1.0"
    write_manifest(copy, manifest)
    result = replay_here(copy / "flights" / "one_00000", tmp_path / "again")
    assert not result.all_met
    assert "differs from the flight in" in result.lines[-1]
    assert "start_distance_m" in result.lines[-1]
    assert result.lines[-1].endswith("the original was flown with a different numpy")


def test_what_cannot_be_flown_again_is_refused_in_one_line(runs, tmp_path):
    copy = shutil.copytree(runs / "trials", tmp_path / "copy")

    def refused(words, flight="one_00000"):
        with pytest.raises(InputError, match=words):
            Replay(str(copy / "flights" / flight))

    refused(r"has no flight 'three_00000'; its summary\.csv lists them", "three_00000")
    (copy / "manifest.json").write_text("{}", encoding="utf-8")
    refused(r"manifest\.json is not that of a run; give the directory of a complete run")
    (copy / "manifest.json").write_text("{", encoding="utf-8")
    refused(r"manifest\.json cannot be read")
    (copy / "journal.sqlite").unlink()
    (copy / "manifest.json").write_bytes((runs / "trials" / "manifest.json").read_bytes())
    refused(r"has no journal\.sqlite")
