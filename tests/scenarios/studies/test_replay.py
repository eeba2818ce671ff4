"""One flight of a run, flown again from its run directory."""

import json
import shutil

import pandas as pd
import pytest

from common.run_layout import flight_of
from reports.registry import content
from reports.run.run_data import read_run
from scenarios.engine.journal import Journal
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import fly_study
from scenarios.engine.task import Result, Task
from scenarios.errors import InputError
from scenarios.scenario.files import is_flight, load_study
from scenarios.studies.base import run_study
from scenarios.studies.replay import Replay
from tests.in_process import assert_refused, run_command
from tests.run_tables import change_manifest, manifest_of, write_manifest
from tests.scenarios.short_trial import short_trial

TRIAL = short_trial(flights=3, duration=10.0, histories=3, spread=180.0)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A list of two trials, and a sweep with a comparison."""
    folder = tmp_path_factory.mktemp("runs")
    for name in ("one", "two"):
        (folder / f"{name}.toml").write_text(TRIAL, encoding="utf-8")
    trials = json.dumps([str(folder / "one.toml"), str(folder / "two.toml")])
    (folder / "list.toml").write_text(
        f'study = "trials"\ntitle = "two"\ntrials = {trials}\n', encoding="utf-8"
    )
    run_study(
        load_study(str(folder / "list.toml")),
        "list",
        folder / "trials",
        executor_factory=InProcessExecutor,
    )
    sweep = [
        "fidelity=kinematic",
        "sweep.nu=[0.3, 0.5]",
        "comparison.nu=[0.5]",
        "flight.crossings=3",
    ]
    run_study(
        load_study("sweep_nu", sweep),
        "sweep_nu",
        folder / "sweep",
        executor_factory=InProcessExecutor,
    )
    # Neither is needed any more.
    (folder / "two.toml").unlink()
    return folder


def replay(name, out):
    return fly_study(
        Replay(str(name)),
        out,
        executor_factory=InProcessExecutor,
        resume=False,
        progress=lambda *_: None,
    )


@pytest.mark.parametrize(
    ("run", "flight_id", "table"),
    [
        ("trials", "one_00000", "summary.csv"),
        ("trials", "two_00002", "summary.csv"),
        ("sweep", "nu_0.50", "summary.csv"),
        ("sweep", "nu_0.50_no_preview", "comparison.csv"),
    ],
)
def test_a_flight_is_flown_again_identically_with_every_step_of_the_guidance(
    runs, tmp_path, run, flight_id, table
):
    result = replay(runs / run / "flights" / flight_id, tmp_path / "again")
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


@pytest.mark.parametrize(
    ("run", "flight_id"), [("trials", "two_00001.parquet"), ("sweep", "nu_0.50_no_preview")]
)
def test_a_report_of_one_flight_is_about_that_flight(runs, tmp_path, run, flight_id):
    replay(runs / run / "flights" / flight_id, tmp_path / "again")
    report = content(read_run(tmp_path / "again"))
    assert report.title.endswith(f"replay of {flight_id.removesuffix('.parquet')}")
    assert "Nothing was flown" not in report.verdict.headline
    assert report.verdict.headline.startswith("The flight kept out and ")
    # One flight sets no bound.
    assert "confidence" not in report.verdict.headline + report.verdict.detail
    assert not [failure for failure in report.verdict.failures if "not flown yet" in failure]


def test_a_flight_that_goes_another_way_is_reported_with_what_has_changed(runs, tmp_path):
    copy = shutil.copytree(runs / "trials", tmp_path / "copy")
    manifest = manifest_of(copy)
    # As if it had been flown from another distance by another version.
    manifest["trials"]["one"]["start"]["distance_m"] = [500.0, 520.0]
    manifest["fingerprint"]["numpy"] = "1.0"
    write_manifest(copy, manifest)
    result = replay(copy / "flights" / "one_00000", tmp_path / "again")
    assert not result.all_met
    assert "differs from the flight in" in result.lines[-1]
    assert "start_distance_m" in result.lines[-1]
    assert result.lines[-1].endswith("the original was flown with a different numpy")


def test_a_flight_that_was_flown_again_is_not_flown_again_from_there(runs, tmp_path):
    replay(runs / "trials" / "flights" / "two_00001", tmp_path / "again")
    with pytest.raises(
        InputError,
        match="is the run of a replay; give the flight as RUN_DIR/flights/ID of its original run",
    ):
        Replay(str(tmp_path / "again" / "flights" / "two_00001"))


def test_only_what_lies_in_a_run_is_a_flight(runs, tmp_path):
    assert is_flight(str(runs / "trials" / "flights" / "one_00000"))
    assert not is_flight("sweep_nu")
    assert not is_flight(str(tmp_path / "flights" / "one_00000"))


@pytest.mark.parametrize("suffix", ["", ".parquet", ".json"])
def test_a_flight_is_named_by_any_of_its_files(suffix):
    assert flight_of(f"runs/sulphur/flights/nu_0.50{suffix}") == "nu_0.50"


def test_what_cannot_be_flown_again_is_refused_in_one_line(runs, tmp_path):
    with pytest.raises(
        InputError, match=r"has no flight 'three_00000'; its summary\.csv lists them"
    ):
        Replay(str(runs / "trials" / "flights" / "three_00000"))
    copy = shutil.copytree(runs / "trials", tmp_path / "copy")
    (copy / "journal.sqlite").unlink()
    with pytest.raises(InputError, match=r"has no journal\.sqlite"):
        Replay(str(copy / "flights" / "one_00000"))
    shutil.copy(runs / "trials" / "journal.sqlite", copy)
    (copy / "manifest.json").write_text("{}", encoding="utf-8")
    with pytest.raises(
        InputError,
        match=r"manifest\.json is not that of a run; give the directory of a complete run",
    ):
        Replay(str(copy / "flights" / "one_00000"))
    (copy / "manifest.json").write_text("{", encoding="utf-8")
    with pytest.raises(InputError, match=r"manifest\.json cannot be read"):
        Replay(str(copy / "flights" / "one_00000"))


def tampered(run, change):
    """Change each row of a journal as anyone can who knows how its checksums are made."""
    journal = Journal(run / "journal.sqlite")
    rows = [(number, row) for number, row in journal.numbered("summary.csv")]
    for number, row in rows:
        journal.add(Result(task=Task(number=number), tables={"summary.csv": [row | change]}))
    journal.close()


def files_below(folder):
    return {
        path.relative_to(folder).as_posix(): path.stat().st_mtime_ns
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.parametrize(
    "trial", ["../../../../pwned/x", "/pwned/x", "..", "a\\b", "a\nb", "", "x" * 201]
)
def test_a_run_whose_trial_is_no_name_of_a_file_is_not_replayed(runs, tmp_path, trial):
    copy = shutil.copytree(runs / "trials", tmp_path / "a" / "b" / "copy")
    manifest = manifest_of(copy)
    manifest["trials"] = {trial: manifest["trials"]["one"]}
    write_manifest(copy, manifest)
    tampered(copy, {"trial": trial, "flight_id": "planted"})
    before = files_below(tmp_path)
    with pytest.raises(
        InputError,
        match=r"names a trial .*, which cannot be the name of a trial; do not use this run",
    ) as refused:
        replay(copy / "flights" / "planted", tmp_path / "a" / "b" / "again")
    assert "\n" not in str(refused.value)
    assert files_below(tmp_path) == before


def test_a_replay_writes_nothing_into_the_run_that_it_is_of(runs, tmp_path):
    before = files_below(runs / "trials")
    assert replay(runs / "trials" / "flights" / "one_00001", tmp_path / "again").all_met
    assert files_below(runs / "trials") == before


@pytest.mark.parametrize("number", [6, 10**12])
def test_a_flight_with_a_number_that_its_trial_does_not_have_is_refused(runs, tmp_path, number):
    copy = shutil.copytree(runs / "trials", tmp_path / "copy")
    journal = Journal(copy / "journal.sqlite")
    journal.add(
        Result(
            task=Task(number=number),
            tables={"summary.csv": [{"flight_id": "planted", "trial": "one"}]},
        )
    )
    journal.close()
    with pytest.raises(
        InputError, match=rf"flight 'planted' has number {number}; 'one' has no such flight"
    ):
        Replay(str(copy / "flights" / "planted"))


@pytest.mark.parametrize("trials", [3, {"one": 5}, {"one": {"title": 5}}, [], {}])
def test_a_manifest_that_is_not_that_of_a_run_is_refused_in_a_line(runs, tmp_path, trials):
    copy = shutil.copytree(runs / "trials", tmp_path / "copy")
    change_manifest(copy, trials=trials)
    with pytest.raises(InputError) as refused:
        Replay(str(copy / "flights" / "one_00000"))
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["sweep_nu", "--flightgear", "localhost:5550"],
            "--flightgear: one program at a time shows the replay of a flight; give RUN_DIR/flights/ID",
        ),
        (["{flight}", "--flightgear", "localhost"], "--flightgear is 'localhost'; give HOST:PORT"),
        (
            ["{flight}", "--flightgear", "localhost:5550"],
            "aircraft in six degrees of freedom can be shown, no others",
        ),
    ],
)
def test_what_flightgear_cannot_show_is_refused(runs, tmp_path, arguments, words):
    flight = sorted((runs / "sweep" / "flights").glob("*.parquet"))[0].with_suffix("")
    arguments = [argument.replace("{flight}", str(flight)) for argument in arguments]
    assert_refused(
        run_command("scenarios.run", *arguments, "--out", str(tmp_path / "again")), words
    )
