"""Flights, lists of trials and the study of the premises, and the files that a run takes parts
from.
"""

import json
import shutil
from dataclasses import replace

import pandas as pd
import pytest
from flight_cases import run_here

from common.premises import TERMS
from common.registry import file_hash
from common.run_layout import COLUMNS, FLIGHTS
from scenarios.errors import InputError
from scenarios.flight.guard_belief import GuardBelief
from scenarios.measures import figures
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from scenarios.studies.manifest import plugins
from tests.scenarios.plugin_files import INSTRUMENT, LAW
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
    return written(tmp_path_factory.mktemp("trials"))


@pytest.fixture(scope="module")
def whole(listed, tmp_path_factory):
    """All flights of the list, flown one after the other."""
    directory = tmp_path_factory.mktemp("runs") / "whole"
    assert run_here(listed, directory).all_met
    return directory


def test_a_run_that_is_to_keep_no_history_keeps_those_that_tell_most(listed, whole, tmp_path):
    # Of each trial the closest flight, the median one, and the first that did not settle; they are
    # flown again for it, and their rows are as they were.
    assert run_here(listed, tmp_path / "run", "histories=0").all_met
    summaries = [pd.read_csv(of / "summary.csv") for of in (whole, tmp_path / "run")]
    summary, again = (of.drop(columns="wall_time_s") for of in summaries)
    pd.testing.assert_frame_equal(summary, again, check_exact=True)
    # Same scenario and seed, another name of the trial: other flights.
    assert summary["wind_speed_mps"].nunique() == 8
    kept_names = set()
    for trial, flights in summary.groupby("trial"):
        assert list(flights["flight_id"]) == [f"{trial}_{i:05d}" for i in range(4)]
        nearest_first = list(flights.sort_values("min_distance_m")["flight_id"])
        # Of four, the median is taken to be the third: half of all are nearer.
        kept_names |= {nearest_first[0], nearest_first[2], flights["flight_id"].iloc[0]}
    kept = tmp_path / "run" / "flights"
    assert {path.stem for path in kept.iterdir()} == kept_names
    for path in kept.iterdir():
        histories = [pd.read_parquet(of / path.name) for of in (kept, whole / "flights")]
        pd.testing.assert_frame_equal(*histories, check_exact=True)


BAD = [
    ('trials = ["sea_nowhere"]', "unknown scenario 'sea_nowhere'"),
    ('trials = ["sea_trial"]', "'sea_trial' is a study of trials; list scenarios of flights"),
    ("trials = []", r"trials is \[\]; tuple should"),
    ('trials = ["sea_wind"]\nset = "share=1"', "set is 'share=1'; input should be a valid tuple"),
    ('trials = ["sea_wind"]\nset = ["vessel.colour=1"]', "unknown key 'vessel.colour'"),
    ('trials = ["sea_wind"]\nset = ["aircraft=zeppelin"]', "unknown aircraft 'zeppelin'"),
]


@pytest.mark.parametrize(("line", "words"), BAD)
def test_bad_trials_are_refused_in_one_line_before_anything_is_written(line, words, tmp_path):
    path = tmp_path / "list.toml"
    path.write_text(f'study = "trials"\ntitle = "bad"\n{line}\n', encoding="utf-8")
    with pytest.raises(InputError, match=words) as refused:
        run_here(path, tmp_path / "run", "start.spread_deg=10")
    assert "\n" not in str(refused.value)
    assert not (tmp_path / "run").exists()


def test_a_run_is_resumed_with_the_same_trials_only(tmp_path):
    listed = written(tmp_path)
    run_here(listed, tmp_path / "run", "share=0.1")
    one = tmp_path / "one.toml"
    one.write_text(TRIAL.replace("[0.0, 5.0]", "[0.0, 6.0]"), encoding="utf-8")
    with pytest.raises(InputError, match="was run with another configuration"):
        run_here(listed, tmp_path / "run", "share=0.1", resume=True)
    # The list does not change with what it lists.
    one.write_text(TRIAL + "[keepout]\nradius_m = 190.0\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"one\.keepout\.radius_m was 200\.0, and is 190\.0 now"):
        run_here(listed, tmp_path / "run", "share=0.1", resume=True)


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
        content = before[name][0][: 0 if number < 6 else -1]
        path.unlink() if number < 4 else path.write_bytes(content)

    # Killed in between, it still knows which there were.
    def stop(doing, *_):
        if doing == "flying":
            raise KeyboardInterrupt

    assert run_here(listed, tmp_path / "run", resume=True, progress=stop).verdict.interrupted
    assert run_here(listed, tmp_path / "run", resume=True).all_met
    after = state_of(tmp_path / "run")
    assert set(after) == set(before)
    assert [name for name in deleted if after[name][0] != before[name][0]] == []
    # The verdict is written anew, and is the same.
    assert after["verdict.json"][0] == before["verdict.json"][0]
    written = {name for name in before if after[name] != before[name]}
    assert written == {*deleted, "manifest.json", "verdict.json"}


QUICK = [
    "fidelity='kinematic'", "flights=1", "flight.duration_max_s=40",
    'cases=[{name="calm",set={"wind.speed_mps"=0.0}},{name="wind"}]',
]  # fmt: skip


def test_the_study_has_a_row_for_each_case_and_term(tmp_path):
    result = run_here("premises", tmp_path / "run", *QUICK)
    table = pd.read_csv(tmp_path / "run" / "premises.csv")
    assert list(dict.fromkeys(table["case"])) == ["calm_kinematic", "wind_kinematic"]
    assert set(table["term"]) <= set(TERMS)
    assert (table["ratio_max"] >= table["ratio_median"]).all()
    assert any("median / largest" in line for line in result.lines)
    assert result.verdict.counts.unexplained == 0
    declared = json.loads((tmp_path / "run" / COLUMNS).read_text())
    assert list(declared["premises.csv"]) == list(table)
    assert set(GuardBelief.COLUMNS) <= set(declared[FLIGHTS])


def test_a_violation_with_every_premise_held_has_an_exit_status_of_its_own(tmp_path, monkeypatch):
    measured = figures.keepout_figures
    monkeypatch.setattr(
        figures, "keepout_figures", lambda *path: replace(measured(*path), violations=1, depth=1.0)
    )
    monkeypatch.setattr(figures, "premise_figures", lambda *_: {"premises_exceeded": "none"})
    result = run_here("premises", tmp_path / "run", *QUICK)
    assert result.verdict.counts.unexplained == 2
    assert "THE KEEP-OUT GUARD IS WRONG" in result.lines[0]
    assert not result.all_met
    assert result.verdict.exit_status == 3
    row = pd.read_csv(tmp_path / "run" / "summary.csv").iloc[0]
    assert row["outcome"] == "unexplained_violation"
    assert not row["kept_out"]


def document_of(folder, text):
    path = folder / "own.toml"
    path.write_text(f'title = "own"\n{text}', encoding="utf-8")
    return load_study(str(path))


@pytest.mark.parametrize(
    ("key", "name", "words"),
    [
        ("reference.shape", "gone.py:X", "gone.py: cannot be read: No such file or directory"),
        ("wind.table", "gone.csv", "gone.csv: cannot be read: No such file or directory"),
        ("aircraft", "gone/x", "gone/x': there is no such directory"),
    ],
)
def test_a_part_whose_file_is_gone_is_refused_in_one_line(tmp_path, key, name, words):
    scenario = document_of(tmp_path, f'{key} = "{name}"\n')
    for resume in (False, True):
        with pytest.raises(InputError) as refused:
            run_study(scenario, "own", tmp_path / "run", resume=resume)
        assert str(refused.value).startswith(f"{key}: ")
        assert words in str(refused.value)
        assert "\n" not in str(refused.value)


SNIFFERS = '[[draws]]\nkey = "payload.instruments"\nchoice = [[], ["own.py:Sniffer"]]\n'
MARGIN = 'following.margin_law = "own.py:Pursuit"\nturbulence.level = "light"\n'


@pytest.mark.parametrize(
    ("text", "part", "code"),
    [
        (SNIFFERS, "own.py:Sniffer", INSTRUMENT),
        (MARGIN, "own.py:Pursuit", LAW),
        ('study = "own.py:Closest"\n', "own.py:Closest", "class Closest: ...\n"),
    ],
)
def test_every_file_that_a_part_comes_from_is_hashed(tmp_path, text, part, code):
    (tmp_path / "own.py").write_text(code, encoding="utf-8")
    name = str(tmp_path / part)
    assert plugins([document_of(tmp_path, text)]) == {name: file_hash(name)}
