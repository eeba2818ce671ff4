"""Flights and lists of trials as the command line runs them, kinematic and short."""

import json
import shutil

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.scenarios.short_trial import short_trial

TRIAL = short_trial(flights=4, duration=4.0, rate=5.0)


def written(directory):
    """Write a list of two trials; return its path."""
    for name in ("one", "two"):
        (directory / f"{name}.toml").write_text(TRIAL, encoding="utf-8")
    path = directory / "list.toml"
    trials = [str(directory / "one.toml"), str(directory / "two.toml")]
    path.write_text(
        f'study = "trials"\ntitle = "two"\ntrials = {json.dumps(trials)}\n', encoding="utf-8"
    )
    return path


@pytest.fixture(scope="module")
def listed(tmp_path_factory):
    """A list of two trials."""
    return written(tmp_path_factory.mktemp("trials"))


@pytest.fixture(scope="module")
def whole(listed, tmp_path_factory):
    """All of its flights, flown one after the other."""
    directory = tmp_path_factory.mktemp("runs") / "whole"
    assert run(listed, directory).all_met
    return directory


def quiet(doing, done, total):
    """Say nothing."""


def run(path, out, *overrides, factory=InProcessExecutor, resume=False, progress=quiet):
    study = load_study(str(path), overrides)
    return run_study(
        study,
        path.stem,
        out,
        executor_factory=factory,
        resume=resume,
        progress=progress,
        overrides=overrides,
    )


def tables(directory):
    """Return the tables of a run but for how long it took."""
    summary = pd.read_csv(directory / "summary.csv").drop(columns="wall_time_s")
    return summary, (directory / "crossings.csv").read_bytes()


def same(one, other):
    pd.testing.assert_frame_equal(tables(one)[0], tables(other)[0], check_exact=True)
    return tables(one)[1] == tables(other)[1]


def test_flights_are_named_by_their_trials_and_differ_from_trial_to_trial(whole):
    summary, _ = tables(whole)
    assert list(summary["flight_id"]) == [
        f"{trial}_{i:05d}" for trial in ("one", "two") for i in range(4)
    ]
    # Same scenario and seed, another name: other flights.
    assert summary["wind_speed_mps"].nunique() == 8


def test_a_run_that_is_to_keep_no_history_keeps_those_that_tell_most(listed, whole, tmp_path):
    # Of each trial the closest flight, the median one, and the first that did not settle; they are
    # flown again for it, and their rows are as they were.
    assert run(listed, tmp_path / "run", "histories=0").all_met
    assert same(whole, tmp_path / "run")
    told = set()
    for _, flights in pd.read_csv(whole / "summary.csv").groupby("trial"):
        nearest_first = list(flights.sort_values("min_distance_m")["flight_id"])
        # Of four, the median is taken to be the third: half of all are nearer.
        told |= {
            f"{nearest_first[0]}.parquet",
            f"{nearest_first[2]}.parquet",
            f"{flights['flight_id'].iloc[0]}.parquet",
        }
    kept = tmp_path / "run" / "flights"
    assert {path.name for path in kept.iterdir()} == told
    for name in told:
        pd.testing.assert_frame_equal(
            pd.read_parquet(kept / name),
            pd.read_parquet(whole / "flights" / name),
            check_exact=True,
        )


def test_a_run_is_resumed_with_the_same_trials_only(tmp_path):
    listed = written(tmp_path)
    run(listed, tmp_path / "run", "share=0.1")
    one = tmp_path / "one.toml"
    one.write_text(TRIAL.replace("[0.0, 5.0]", "[0.0, 6.0]"), encoding="utf-8")
    with pytest.raises(InputError, match="was run with another configuration"):
        run(listed, tmp_path / "run", "share=0.1", resume=True)
    # The list does not change with what it lists.
    one.write_text(TRIAL + "[keepout]\nradius_m = 190.0\n", encoding="utf-8")
    with pytest.raises(
        InputError,
        match=r"configuration: one\.keepout\.radius_m was 200\.0, and is 190\.0 now; resume",
    ):
        run(listed, tmp_path / "run", "share=0.1", resume=True)


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('trials = ["sea_nowhere"]', "unknown scenario 'sea_nowhere'"),
        ('trials = ["sea_trial"]', "'sea_trial' is a study of trials; list scenarios of flights"),
        ("trials = []", r"trials is \[\]; tuple should"),
        (
            'trials = ["sea_wind"]\nset = "share=1"',
            "set is 'share=1'; input should be a valid tuple",
        ),
        ('trials = ["sea_wind"]\nset = ["vessel.colour=1"]', "unknown key 'vessel.colour'"),
        (
            'trials = ["sea_wind"]\nset = ["fidelity=kinematic", "fault.kind=engine"]',
            "fault.kind is 'engine'; .*what can fail is none, satellite_navigation, sniffer_dead, sniffer_saturated, vessel_data",
        ),
        (
            'trials = ["sea_wind"]\nset = ["speed_ratio=[0.9, 0.1]"]',
            r"speed_ratio is \[0.9, 0.1\]; its first value",
        ),
        ('trials = ["sea_wind"]\nset = ["aircraft=zeppelin"]', "unknown aircraft 'zeppelin'"),
    ],
)
def test_bad_trials_are_refused_in_one_line_before_anything_is_written(line, words, tmp_path):
    path = tmp_path / "list.toml"
    path.write_text(f'study = "trials"\ntitle = "bad"\n{line}\n', encoding="utf-8")
    with pytest.raises(InputError, match=words) as refused:
        run(path, tmp_path / "run", "start.spread_deg=10")
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "run").exists()


def state_of(directory):
    """Return content and time of every file."""
    files = (path for path in sorted(directory.rglob("*")) if path.is_file())
    return {
        path.relative_to(directory).as_posix(): (path.read_bytes(), path.stat().st_mtime_ns)
        for path in files
    }


def test_time_histories_that_were_deleted_or_cut_are_made_again_to_the_last_bit(
    listed, whole, tmp_path
):
    shutil.copytree(whole, tmp_path / "run")
    before = state_of(tmp_path / "run")
    deleted = [name for name in before if name.startswith("flights/")]
    assert len(deleted) == 8
    for number, name in enumerate(deleted):
        # Deleted, empty, or cut.
        path = tmp_path / "run" / name
        path.unlink() if number < 4 else path.write_bytes(
            before[name][0][: 0 if number < 6 else -1]
        )
    # Killed in between, it still knows which there were.
    flown = []

    def stop(doing, done, total):
        if doing == "flying":
            flown.append(done)
            raise KeyboardInterrupt

    assert run(listed, tmp_path / "run", resume=True, progress=stop).verdict.interrupted
    assert run(listed, tmp_path / "run", resume=True).all_met
    after = state_of(tmp_path / "run")
    assert set(after) == set(before)
    assert [name for name in deleted if after[name][0] != before[name][0]] == []
    # The verdict is written anew, and is the same.
    assert after["verdict.json"][0] == before["verdict.json"][0]
    written = {name for name in before if after[name] != before[name]}
    assert written == {*deleted, "manifest.json", "verdict.json"}
