"""Monte Carlo by subset simulation from its file to its report, kinematic and short."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest

from common.intervals import clopper_pearson
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import ExecutorFactory
from scenarios.experiment.sampling import beyond_declared
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study, study_of
from scenarios.studies.replay import Replay

pytestmark = pytest.mark.slow

RARE = """
study = "monte_carlo"
method = "subset"
title = "short"
fidelity = "kinematic"
seed = 11
histories = 0
speed_ratio = [0.3, 0.5]
[guidance]
keepout_guard = false
rate_hz = 5.0
[subset]
flights_per_level = 50
conditional_probability = 0.2
repeats = 3
[reports]
interval_s = [1.0, 2.0]
missing = 0.5
[[draws]]
key = "start.range_m"
uniform = [215.0, 350.0]
[[draws]]
key = "start.course_deg"
uniform = [-180.0, 180.0]
[[draws]]
key = "start.aspect_deg"
uniform = [-180.0, 180.0]
[[draws]]
key = "vessel.speed_mps"
uniform = [4.0, 10.0]
[flight]
crossings = 0
duration_max_s = 3.0
log_rate_hz = 5.0
[criteria]
settles = false
"""
"""Starts near r_min, of which about one in 20 is so near, and flown so straight at the vessel, that
3 s are enough.
"""


@pytest.fixture(scope="module")
def rare(tmp_path_factory):
    path = tmp_path_factory.mktemp("rare") / "short.toml"
    path.write_text(RARE, encoding="utf-8")
    return path


def run(rare, out, *, factory=InProcessExecutor, resume=False, progress=lambda *_: None):
    return run_study(
        load_study(str(rare)),
        "short",
        out,
        executor_factory=factory,
        resume=resume,
        progress=progress,
    )


@pytest.fixture(scope="module")
def whole(rare, tmp_path_factory):
    out = tmp_path_factory.mktemp("subset") / "run"
    return run(rare, out, factory=ExecutorFactory(jobs=2)), out


def statistics_of(out):
    return json.loads((out / "statistics.json").read_text(encoding="utf-8"))


def test_it_agrees_with_plain_sampling_where_both_can_see(rare, whole, tmp_path):
    scenario = load_study(str(rare), ["method=plain", "flights=120", "sampling=random"])
    run_study(scenario, "short", tmp_path / "plain", executor_factory=InProcessExecutor)
    plain = statistics_of(tmp_path / "plain")["violation"]["measured"]
    # About 5 %: neither method may see nothing.
    assert 2 <= plain["events"] <= 16
    found = statistics_of(whole[1])["violation"]
    interval = clopper_pearson(plain["events"], plain["flights"], 0.95)
    # Two intervals of 95 % of the same probability.
    assert found["low"] <= interval.high
    assert interval.low <= found["high"]
    assert found["reached"] == found["repeats"] == 3


def test_every_flight_has_a_row_and_every_level_its_figures(whole):
    result, out = whole
    summary = pd.read_csv(out / "summary.csv")
    found = statistics_of(out)
    levels = [level for simulation in found["simulations"] for level in simulation["levels"]]
    assert (
        len(summary)
        == result.verdict.counts.done
        == sum(level["flights"] for level in levels)
        == result.verdict.counts.planned
    )
    assert list(summary["flight_id"]) == [f"short_{i:05d}" for i in range(len(summary))]
    assert found["violation"]["first_levels"]["flights"] == 150
    for simulation in found["simulations"]:
        first, *others = simulation["levels"]
        assert first["below_m"] is None
        assert first["moved"] == first["renewed"] == 0
        for before, level in zip(simulation["levels"], others, strict=False):
            assert level["below_m"] == before["threshold_m"]
            assert 0 < level["accepted"] < level["moved"]
        product = np.prod([level["probability"] for level in simulation["levels"]])
        assert simulation["probability"] == pytest.approx(product, rel=1e-12)
    assert {entry["key"] for entry in found["inputs"]} == {
        "start.range_m",
        "start.course_deg",
        "start.aspect_deg",
        "vessel.speed_mps",
    }
    # Nothing enters from 350 m within 3 s, so the range decides.
    assert found["inputs"][0]["distance"] > found["noise_floor"]
    ranges = next(entry for entry in found["inputs"] if entry["key"] == "start.range_m")
    assert ranges["median_near"] < 280.0 < ranges["median"]
    assert "probability of a keep-out violation in a flight" in result.lines[-1]


TURNING = [
    "subset.levels_max=1",
    "vessel.manoeuvres=[{at_s=1.0, turn_deg=5.0, turn_rate_deg_s=5.0}, {at_s=1.5, turn_deg=5.0, turn_rate_deg_s=5.0}]",
]


def test_flights_are_those_of_the_plain_study_also_beyond_what_is_declared_of_the_vessel(
    rare, tmp_path
):
    # At 5 deg/s, from 2.5 degrees on, the second turn begins before the end of the first; and 0.05
    # s, a step, are allowed for.
    draw = 'draws=[{key="vessel.manoeuvres.0.turn_deg", uniform=[0.5, 5.0]}, {key="start.range_m", uniform=[215.0, 350.0]}]'
    scenario = load_study(str(rare), [*TURNING, draw])
    # At 8 m/s and 5 deg/s it accelerates by 0.7 m/s2.
    gentle = study_of(
        load_study(str(rare), [*TURNING, draw, "following.vessel_acceleration_mps2=0.1"]), "short"
    )
    assert beyond_declared(gentle.trials["short"], [0.1, 0.5]) > 1.0
    assert gentle._allowed(np.array([0.1, 0.5]))
    result = run_study(scenario, "short", tmp_path / "run", executor_factory=InProcessExecutor)
    rows = pd.read_csv(tmp_path / "run" / "summary.csv").merge(
        pd.read_csv(tmp_path / "run" / "draws.csv"), on="flight_id"
    )
    overlap = rows["vessel.manoeuvres.0.turn_deg"] > 2.75
    assert len(rows) == 150
    assert set(rows["outcome"][overlap]) == {"infeasible"}
    assert rows["min_distance_m"][~overlap].notna().all()
    found = statistics_of(tmp_path / "run")
    assert [simulation["levels"][0]["outside"] for simulation in found["simulations"]] == [0, 0, 0]
    unknown = found["violation"]["first_levels_unknown"]
    assert unknown == rows["min_distance_m"].isna().sum()
    # Half of 150, within 4 standard deviations of 6.1.
    assert 50 <= unknown <= 100
    upper = found["violation"]["pessimistic"]["upper"]
    assert any(
        line.startswith(f"of 150 flights of the first levels {unknown} are of unknown end")
        and f"at most {upper:.2g}" in line
        for line in result.lines
    )


def test_the_same_seed_gives_the_same_rows_whatever_the_number_of_processes_and_where_it_was_interrupted(
    rare, whole, tmp_path
):
    def interrupt(doing, done, _):
        if done == 170:
            raise KeyboardInterrupt

    out = tmp_path / "run"
    assert run(rare, out, progress=interrupt).verdict.interrupted
    assert not (out / "statistics.json").exists()
    run(rare, out, resume=True)
    for name in ("summary.csv", "draws.csv"):
        one, other = (
            pd.read_csv(of / name).drop(columns="wall_time_s", errors="ignore")
            for of in (whole[1], out)
        )
        pd.testing.assert_frame_equal(one, other, check_exact=True)
    assert statistics_of(out) == statistics_of(whole[1])


def test_a_flight_of_a_late_level_is_replayed_to_the_last_bit_its_blended_noise_included(
    whole, tmp_path
):
    last = pd.read_csv(whole[1] / "summary.csv")["flight_id"].iloc[-1]
    replay = Replay(str(whole[1] / "flights" / last))
    from scenarios.engine.runner import fly_study

    result = fly_study(
        replay,
        tmp_path / "replay",
        executor_factory=InProcessExecutor,
        resume=False,
        progress=lambda *_: None,
    )
    assert result.all_met, result.lines


def test_a_lost_flight_is_not_flown_again_once_others_depend_on_it(rare, whole, tmp_path):
    import sqlite3

    from scenarios.engine.journal import _checksum

    out = shutil.copytree(whole[1], tmp_path / "copy")
    with sqlite3.connect(out / "journal.sqlite") as database:
        (fields,) = database.execute(
            "SELECT number, point, items, lost, tables FROM results WHERE number = 3"
        ).fetchall()
        lost = (*fields[:3], 1, fields[4])
        database.execute(
            "UPDATE results SET lost = 1, checksum = ? WHERE number = 3", (_checksum(*lost),)
        )
    database.close()
    flown = []
    run(rare, out, resume=True, progress=lambda *p: flown.append(p))
    done = len(pd.read_csv(out / "summary.csv"))
    assert [p[1] for p in flown if p[0] == "flying"] == [done - 1]
    assert statistics_of(out) == statistics_of(whole[1])
