"""The search for the worst flight, kinematic and short, and the files that it keeps."""

import json
import shutil

import numpy as np
import pandas as pd
import pytest

from reports.build import build_reports
from scenarios.engine.executors import ExecutorFactory
from scenarios.errors import InputError
from scenarios.schema.load import load_study
from scenarios.studies.registry import run_study

POPULATION, GENERATIONS, KEPT = 16, 5, 3

SEARCH = f"""
study = "falsify"
title = "short"
fidelity = "kinematic"
histories = 0
[search]
population = {POPULATION}
generations = {GENERATIONS}
kept = {KEPT}
[[draws]]
key = "start.range_m"
uniform = [400.0, 1200.0]
[[draws]]
key = "start.course_deg"
uniform = [-180.0, 180.0]
[[draws]]
key = "wind.from_deg"
uniform = [0.0, 360.0]
[wind]
speed_mps = 3.0
[flight]
crossings = 0
duration_max_s = 4.0
[criteria]
required = "keep_out"
settles = false
"""


@pytest.fixture(scope="module")
def search(tmp_path_factory):
    path = tmp_path_factory.mktemp("search") / "short.toml"
    path.write_text(SEARCH, encoding="utf-8")
    return path


def run(search, out, *, jobs=2, resume=False, progress=lambda *_: None):
    scenario = load_study(str(search))
    return run_study(scenario, "short", out, executor_factory=ExecutorFactory(jobs=jobs), resume=resume, progress=progress)


@pytest.fixture(scope="module")
def found(search, tmp_path_factory):
    out = tmp_path_factory.mktemp("falsify") / "run"
    assert run(search, out).all_met
    return out


def distances(out):
    return pd.read_csv(out / "summary.csv")["min_distance_m"].to_numpy()


def test_the_search_closes_in_on_the_nearest_start_that_flies_at_the_vessel(found):
    every = distances(found)
    assert len(every) == POPULATION * (GENERATIONS + 1)
    # In 4 s nothing comes nearer than the shortest start, 400 m, less what vessel and UAV fly: 8 and 19.42 m/s, and gets close to
    # that only from there and on a course towards it. A Sobol sequence of the first generation has spacings of 50 m.
    nearest_possible = 400.0 - 4.0 * (8.0 + 19.42)
    assert nearest_possible < every.min() < nearest_possible + 100.0
    generations = every.reshape(-1, POPULATION)
    assert np.median(generations[-1]) < np.median(generations[0]) - 100.0


def test_the_worst_flights_are_kept_as_scenarios_that_fly_again_to_the_last_bit(found, tmp_path):
    kept = sorted((found / "worst").iterdir())
    assert [path.name[:3] for path in kept] == ["01_", "02_", "03_"]
    worst = np.sort(distances(found))[:KEPT]
    for rank, path in enumerate(kept):
        out = tmp_path / path.stem
        result = run_study(load_study(str(path)), path.stem, out)
        assert result.all_met
        assert distances(out) == [worst[rank]]
        flight_id = path.stem[3:]
        first = pd.read_parquet(found / "flights" / f"{flight_id}.parquet")
        again = pd.read_parquet(out / "flights" / f"{path.stem}_00000.parquet")
        pd.testing.assert_frame_equal(first, again, check_exact=True)
    # And what is flown again can be changed.
    other = run_study(load_study(str(kept[0]), ["keepout.radius_m=150"]), "changed", tmp_path / "changed")
    assert other.summary.done == 1


def test_the_search_goes_the_same_way_whatever_the_number_of_processes_and_where_it_was_interrupted(search, found, tmp_path):
    def interrupt(doing, done, _):
        if done == POPULATION + 5:
            raise KeyboardInterrupt

    out = tmp_path / "run"
    assert run(search, out, jobs=1, progress=interrupt).interrupted
    assert len(distances(out)) == POPULATION + 5
    assert run(search, out, jobs=1, resume=True).all_met
    for name in ("summary.csv", "draws.csv"):
        one, other = (pd.read_csv(run / name).drop(columns="wall_time_s", errors="ignore") for run in (found, out))
        pd.testing.assert_frame_equal(one, other, check_exact=True)
    assert {p.name: p.read_bytes() for p in (out / "worst").iterdir()} == {
        p.name: p.read_bytes() for p in (found / "worst").iterdir()
    }


def test_its_report_says_what_was_found(found, tmp_path):
    copy = shutil.copytree(found, tmp_path / "copy")
    html, pdf = build_reports(copy)
    text = html.read_text(encoding="utf-8")
    least = distances(found).min() - 200.0
    assert f"The closest that it found stayed {least:.1f} m outside the keep-out area." in text
    assert pdf.read_bytes().startswith(b"%PDF")
    manifest = json.loads((found / "manifest.json").read_text(encoding="utf-8"))
    assert manifest["worst_clearance_m"] == pytest.approx(least, rel=1e-12)


def test_a_search_without_anything_to_search_is_refused(search, tmp_path):
    with pytest.raises(InputError, match="draws is empty; give the keys to search over"):
        load_study(str(search), ["draws=[]"])
