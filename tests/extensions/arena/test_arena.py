"""An arena of a few laws on the kinematic vehicle: tuned, flown, compared, resumed and replayed."""

import json

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.in_process import assert_refused, run_command
from tests.run_tables import manifest_of, rows_of
from tests.scenarios.plugin_files import LAW

pytestmark = pytest.mark.slow

QUICK = (
    "fidelity=kinematic", "guidance.rate_hz=5", "flight.log_rate_hz=5",
    "flights=2", "flight.duration_max_s=60", "arena.window_s=30", "arena.tuning_duration_s=30",
    "arena.evaluations=3", "arena.tuning_flights=1", "arena.resamples=100", "start.distance_m=[300,350]", "start.spread_deg=20",
    'arena.tracking=["npfg"]', 'arena.standoff=["lgvf"]', "arena.limits=[[0.0,5.0],[1.0,9.0]]",
    'arena.conditions=[{name="calm",title="Calm"},{name="wind",title="Wind",set={"wind.speed_mps"=4.0}}]',
)  # fmt: skip


def arena(*overrides):
    return load_study("arena", [*QUICK, *overrides])


@pytest.fixture(scope="module")
def law(tmp_path_factory):
    path = tmp_path_factory.mktemp("law") / "mylaw.py"
    path.write_text(LAW, encoding="utf-8")
    return f"{path}:Pursuit"


@pytest.fixture(scope="module")
def run(tmp_path_factory, law):
    out = tmp_path_factory.mktemp("arena") / "run"
    run_study(arena(f'laws=["{law}"]'), "arena", out, executor_factory=InProcessExecutor)
    return out


@pytest.fixture(scope="module")
def record(run):
    return json.loads((run / "arena.json").read_text(encoding="utf-8"))


def test_every_law_flies_every_task_that_it_can_in_every_condition_from_the_same_starts(run):
    rows = pd.DataFrame(rows_of(run))
    cases = ["npfg", "pursuit", "pursuit_standoff", "lgvf_standoff"]
    assert rows["flight_id"].tolist() == [
        f"{trial}_{case}_kinematic_{i:05d}"
        for trial in ("calm", "wind")
        for case in cases
        for i in range(2)
    ]
    # Two starts in each condition, one for each flight of a law: seeds follow from condition and
    # number alone.
    assert rows.groupby("trial")["seed"].nunique().tolist() == [2, 2]
    assert rows.groupby("trial")["start_distance_m"].nunique().tolist() == [2, 2]


def test_every_law_has_the_same_budget_and_seeds_that_the_comparison_does_not_use(run, record):
    tuning = pd.read_csv(run / "tuning.csv")
    assert set(tuning.groupby("entrant").size()) == {3}
    assert tuning["message"].isna().all()
    for entrant in record["entrants"]:
        tried = tuning[tuning["entrant"] == entrant["name"]].sort_values("evaluation")
        first, best = tried.iloc[0], tried.loc[tried["cost_m"].idxmin()]
        assert json.loads(first["parameters"]) == entrant["defaults"]
        assert json.loads(best["parameters"]) == entrant["tuned"]
        assert entrant["cost_tuned_m"] <= entrant["cost_default_m"]
        for key, value in entrant["tuned"].items():
            # The range of the scenario, 4 times either way; six digits are kept.
            assert 0.2499 < value / entrant["defaults"][key] < 4.001


def test_flights_have_the_tuned_parameters_and_the_manifest_says_them(run, record):
    manifest = manifest_of(run)
    tuned = {entrant["name"]: entrant["tuned"] for entrant in record["entrants"]}
    assert manifest["tuned"] == tuned
    for case in manifest["trials"]["calm"]["cases"]:
        assert (
            tuned[case["name"]].items()
            <= {k.removeprefix("guidance."): v for k, v in case["set"].items()}.items()
        )
    draws = pd.read_csv(run / "draws.csv").set_index("flight_id")
    assert (
        draws.loc["wind_npfg_kinematic_00001", "guidance.npfg_period_s"]
        == tuned["npfg"]["npfg_period_s"]
    )


def test_a_resumed_arena_has_nothing_to_do_and_a_flight_replays_as_it_was(run, tmp_path, law):
    before = (run / "arena.json").read_bytes()
    result = run_study(
        arena(f'laws=["{law}"]'), "arena", run, executor_factory=InProcessExecutor, resume=True
    )
    assert not result.changed
    assert (run / "arena.json").read_bytes() == before
    flight = "wind_npfg_kinematic_00001"
    ended = run_command(
        "scenarios.run", run / "flights" / flight, "--out", tmp_path / "replay", "--no-report"
    )
    assert ended.status == 0, ended.errors
    (row,) = [row for row in rows_of(run) if row["flight_id"] == flight]
    (again,) = rows_of(tmp_path / "replay")
    assert {k: v for k, v in again.items() if k != "wall_time_s"} == {
        k: v for k, v in row.items() if k != "wall_time_s"
    }


class LosingTuner(InProcessExecutor):
    """Loses the task that tunes the first law, as if its process had been killed."""

    def fly(self, tasks):
        flights = self._work._ends[-1]
        return (
            self._work.lost(task, "was killed") if task.number == flights else self._work.run(task)
            for task in tasks
        )


def test_a_law_whose_tuning_was_lost_is_tuned_when_the_run_continues(tmp_path):
    calm = 'arena.conditions=[{name="calm",title="Calm"}]'
    keys = (calm, "flights=1", "arena.standoff=[]", "flight.duration_max_s=40")
    words = r"the tuning of 'npfg' was lost \(was killed\), and .*: continue with --resume"
    with pytest.raises(InputError, match=words):
        run_study(arena(*keys), "arena", tmp_path / "lost", executor_factory=LosingTuner)
    for name, resume in (("lost", True), ("whole", False)):
        path = tmp_path / name
        run_study(arena(*keys), "arena", path, executor_factory=InProcessExecutor, resume=resume)
    lost, whole = tmp_path / "lost", tmp_path / "whole"
    assert (lost / "arena.json").read_bytes() == (whole / "arena.json").read_bytes()
    assert (lost / "draws.csv").read_bytes() == (whole / "draws.csv").read_bytes()
    tuned = manifest_of(lost)["tuned"]["npfg"]
    assert pd.read_csv(lost / "draws.csv")["guidance.npfg_period_s"][0] == tuned["npfg_period_s"]


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ('laws=["npgf"]', ("laws: unknown steering law 'npgf'", "'npfg'")),
        ('laws=["npfg"]', ("'npfg' is named 2 times for tracking", "name each law once")),
        ('arena.conditions=[{name="a",title="A",set={"wind.sped_mps"=1}}]', ("wind.sped_mps",)),
        ("flight.measured_s=60", ("flight.measured_s is given", "arena.window_s")),
    ],
)
def test_bad_input_is_one_line(override, words, tmp_path):
    arguments = [argument for key in (*QUICK, override) for argument in ("--set", key)]
    ended = run_command("scenarios.run", "arena", *arguments, "--out", tmp_path / "run")
    assert_refused(ended, *words)
