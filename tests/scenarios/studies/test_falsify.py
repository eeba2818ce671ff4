"""The search for the worst flight, kinematic and short: its way, its files, and how it is resumed."""

import itertools
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from flight_cases import run_here

from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import ExecutorFactory
from scenarios.errors import InputError
from scenarios.studies import falsify as falsification
from tests.run_tables import manifest_of

pytestmark = pytest.mark.slow

POPULATION, GENERATIONS, KEPT, CONFIRMATIONS = 12, 7, 3, 2

FLIGHTS = """
[wind]
speed_mps = 3.0
[guidance]
rate_hz = 5.0
[reports]
interval_s = [1.0, 2.0]
[flight]
crossings = 0
duration_max_s = {duration}
log_rate_hz = 5.0
[criteria]
required = "keep_out"
settles = false
"""
"""Flights that are quick to fly, in which keeping out alone is required."""

SEARCH = f"""
study = "falsify"
title = "short"
fidelity = "kinematic"
histories = 0
[search]
population = {POPULATION}
generations = {GENERATIONS}
kept = {KEPT}
confirmations = {CONFIRMATIONS}
[[draws]]
key = "start.range_m"
uniform = [400.0, 1200.0]
[[draws]]
key = "start.course_deg"
uniform = [-180.0, 180.0]
[[draws]]
key = "wind.from_deg"
uniform = [0.0, 360.0]
{FLIGHTS.format(duration=4.0)}"""

TURNS = "search.generations=4"
"""Each method's turn, and one more: what the first turns found decides the later ones."""


@pytest.fixture(scope="module")
def search(tmp_path_factory):
    path = tmp_path_factory.mktemp("search") / "short.toml"
    path.write_text(SEARCH, encoding="utf-8")
    return path


@pytest.fixture
def timed(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(SEARCH.replace(f"generations = {GENERATIONS}", "time_s = 4.0"), "utf-8")
    return path


def tables(out):
    """Return the flights of the search, and those that repeat the worst, with their inputs."""
    rows = pd.read_csv(out / "summary.csv").drop(columns="wall_time_s")
    rows = rows.merge(pd.read_csv(out / "draws.csv"), on="flight_id", validate="one_to_one")
    repeated = rows["confirms"].notna()
    return rows[~repeated], rows[repeated]


def assert_same(one, other):
    """Assert that two runs have the same flights, and keep the same worst ones."""
    for ours, theirs in zip(tables(one), tables(other), strict=True):
        pd.testing.assert_frame_equal(ours, theirs, check_exact=True)
    kept = [{p.name: p.read_bytes() for p in (of / "worst").iterdir()} for of in (one, other)]
    assert kept[0] == kept[1]


def losing(number):
    """Return a factory of executors that lose the process of a flight."""

    class LosingExecutor(InProcessExecutor):
        def fly(self, tasks):
            for task in tasks:
                lost = task.number == number
                yield self._work.lost(task, "was killed") if lost else self._work.run(task)

    return LosingExecutor


@pytest.fixture(scope="module")
def found(search, tmp_path_factory):
    out = tmp_path_factory.mktemp("falsify") / "run"
    assert run_here(search, out, executor_factory=ExecutorFactory(jobs=2)).all_met
    return out


def test_the_search_closes_in_on_the_nearest_start_that_flies_at_the_vessel(found):
    every = tables(found)[0]["min_distance_m"].to_numpy()
    assert POPULATION * GENERATIONS < len(every) <= POPULATION * (GENERATIONS + 1)
    # In 4 s nothing comes nearer than the shortest start, 400 m, less what vessel and UAV fly: 8
    # and 19.42 m/s, and 3 m/s more downwind; and it gets close to that only from there, on a course
    # towards the vessel, and with the wind.
    nearest_possible = 400.0 - 4.0 * (8.0 + 19.42 + 3.0)
    assert nearest_possible < every.min() < nearest_possible + 25.0
    assert np.median(every[-POPULATION:]) < np.median(every[:POPULATION]) - 100.0


def test_the_worst_flights_are_repeated_with_fresh_noise(found):
    searched, repeats = tables(found)
    worst = manifest_of(found)["search"]["worst"]
    named = sorted(entry["flight_id"] for entry in worst)
    assert repeats["confirms"].tolist() == [name for name in named for _ in range(CONFIRMATIONS)]
    assert repeats["seed"].nunique() == len(repeats) == KEPT * CONFIRMATIONS
    assert not set(repeats["seed"]) & set(searched["seed"])
    keys = ["start.range_m", "start.course_deg", "wind.from_deg"]
    for entry in worst:
        again = repeats[repeats["confirms"] == entry["flight_id"]]
        (first,) = searched[searched["flight_id"] == entry["flight_id"]][keys].to_numpy()
        assert (again[keys].to_numpy() == first).all()
        assert (entry["confirmations"], entry["confirmations_violating"]) == (CONFIRMATIONS, 0)
        nearest = again["min_distance_m"].min() - 200.0
        assert entry["confirmations_nearest_m"] == pytest.approx(nearest, rel=1e-12)


def test_the_search_goes_the_same_way_for_any_number_of_processes_and_where_it_was_interrupted(
    search, found, tmp_path
):
    out = tmp_path / "run"
    # In the second turn of a method, and among the flights that repeat the worst.
    for after in (POPULATION + 5, len(tables(found)[0]) + KEPT):

        def interrupt(_doing, done, _, after=after):
            if done == after:
                raise KeyboardInterrupt

        assert run_here(search, out, resume=out.exists(), progress=interrupt).verdict.interrupted
        assert len(pd.read_csv(out / "summary.csv")) == after
    assert run_here(search, out, resume=True).all_met
    assert_same(found, out)


def test_a_search_is_resumed_after_a_lost_flight_on_which_others_depend(search, tmp_path):
    out = tmp_path / "run"

    def interrupt(_doing, done, _):
        if done == 3 * POPULATION:
            raise KeyboardInterrupt

    # The eighth flight of the first turn: what the third turn proposes depends on it.
    assert run_here(
        search, out, TURNS, executor_factory=losing(7), progress=interrupt
    ).verdict.interrupted
    result = run_here(search, out, TURNS, resume=True)
    searched = tables(out)[0].set_index("flight_id")
    assert "short_00007" not in searched.index[searched["min_distance_m"].notna()]
    assert result.verdict.counts.done == result.verdict.counts.planned
    assert not result.all_met
    # It stays its method's, and is not the nearest of any.
    assert searched.loc["short_00007", "search_method"] == "corners"
    run_here(search, tmp_path / "whole", TURNS, executor_factory=losing(7))
    assert_same(tmp_path / "whole", out)


def clock(monkeypatch):
    """Have the search's time advance by a second whenever it is looked at."""
    ticks = itertools.count()
    time = SimpleNamespace(monotonic=lambda: float(next(ticks)))
    monkeypatch.setattr(falsification, "time", time)


def test_a_search_by_time_ends_after_it_and_a_resumed_one_continues_for_as_long(
    timed, tmp_path, monkeypatch
):
    clock(monkeypatch)
    out = tmp_path / "run"
    assert run_here(timed, out).all_met
    before, repeats = tables(out)
    assert len(repeats) == KEPT * CONFIRMATIONS
    clock(monkeypatch)
    assert run_here(timed, out, resume=True).all_met
    after, repeats_after = tables(out)
    assert len(after) > len(before)
    pd.testing.assert_frame_equal(after.iloc[: len(before)], before, check_exact=True)
    worst = {entry["flight_id"] for entry in manifest_of(out)["search"]["worst"]}
    # What the first run repeated stays in the tables, also where it is not among the worst any
    # more.
    assert set(repeats_after["confirms"]) == worst | set(repeats["confirms"])
    assert manifest_of(out)["flights_planned"] == len(after) + len(repeats_after)
    assert len(list((out / "worst").iterdir())) == KEPT


FAULTY = f"""
study = "falsify"
title = "short"
description = "A search."
fidelity = "kinematic"
seed = 3
[search]
population = 12
generations = 1
kept = 12
confirmations = 0
[[draws]]
key = "start.course_deg"
uniform = [-180.0, 180.0]
[[draws]]
key = "fault.kind"
choice = ["none", "vessel_data", "satellite_navigation"]
[fault]
at_s = 2.0
[start]
range_m = 400.0
aspect_deg = 0.0
{FLIGHTS.format(duration=20.0)}"""


def test_a_worst_flight_is_a_scenario_that_flies_again_with_the_margin_for_all_faults(tmp_path):
    (tmp_path / "short.toml").write_text(FAULTY, encoding="utf-8")
    run_here(tmp_path / "short.toml", tmp_path / "run")
    searched = pd.read_csv(tmp_path / "run" / "summary.csv").set_index("flight_id")
    kept = sorted((tmp_path / "run" / "worst").iterdir())
    assert [path.name[:3] for path in kept[:3]] == ["01_", "02_", "03_"]
    assert searched.loc[kept[0].stem[3:], "min_distance_m"] == searched["min_distance_m"].min()
    by_fault = {searched.loc[path.stem[3:], "fault"]: path for path in kept}
    assert len(by_fault) == 3
    for fault, path in by_fault.items():
        # What is said of the search is not said of one of its flights.
        assert "description" not in path.read_text(encoding="utf-8")
        out, row = tmp_path / path.stem, searched.loc[path.stem[3:]]
        run_here(path, out)
        (again,) = pd.read_csv(out / "summary.csv").to_dict("records")
        for figure in ("fault", "seed", "keepout_margin_m", "min_distance_m", "guard_time_s"):
            assert again[figure] == row[figure]
        first = pd.read_parquet(tmp_path / "run" / "flights" / f"{row.name}.parquet")
        second = pd.read_parquet(out / "flights" / f"{path.stem}_00000.parquet")
        pd.testing.assert_frame_equal(first, second, check_exact=True)
        # Without the declaration the margin of a flight that can lose no satellites is 1 m smaller.
        if fault == "none":
            run_here(path, tmp_path / "other", "fault.declared=[]")
            margin = pd.read_csv(tmp_path / "other" / "summary.csv")["keepout_margin_m"].item()
            assert margin < row["keepout_margin_m"] - 0.5


METHODS = """
import numpy as np

class Centre:
    exhausted = False
    batches = 0

    def __init__(self, space, settings, generator):
        self.space = space

    def ask(self, found, room):
        self.batches += 1
        if self.batches > 50:
            raise RuntimeError("the search does not end")
        return np.full((min(room, 1), self.space.dimension), 0.5)

    def tell(self, clearances):
        pass

class Raising(Centre):
    def ask(self, *_):
        raise RuntimeError("boom")
"""
TURNING = (
    "vessel.manoeuvres=[{at_s=1.0,turn_deg=60.0}]", "following.vessel_acceleration_mps2=0.05",
    'draws=[{key="vessel.manoeuvres.0.turn_rate_deg_s",uniform=[4.5,5.0]}]',
)  # fmt: skip
"""4.5 deg/s at 8 m/s are 0.63 m/s2, at every point."""


@pytest.mark.parametrize(
    ("name", "keys", "words"),
    [
        ("Centre", TURNING, "within speed_ratio and following.vessel_acceleration_mps2, and none"),
        ("Raising", (), "ask(12) failed: RuntimeError: boom (own.py:"),
    ],
)
def test_a_search_that_finds_nothing_to_fly_and_a_method_that_raises_end_in_one_line(
    timed, tmp_path, monkeypatch, name, keys, words
):
    clock(monkeypatch)
    (tmp_path / "own.py").write_text(METHODS, encoding="utf-8")
    with pytest.raises(InputError) as refused:
        run_here(timed, tmp_path / "run", f'search.methods=["{tmp_path}/own.py:{name}"]', *keys)
    assert words in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_method_of_ones_own_takes_its_turns(search, tmp_path):
    (tmp_path / "own.py").write_text(METHODS, encoding="utf-8")
    name = f"{tmp_path}/own.py:Centre"
    run_here(
        search, tmp_path / "run", f'search.methods=["corners","{name}"]', "search.generations=2"
    )
    searched, _ = tables(tmp_path / "run")
    own = searched[searched["search_method"] == name]
    assert set(searched["search_method"]) == {"corners", name}
    assert (own["start.range_m"] == 800.0).all()
    assert list(manifest_of(tmp_path / "run")["plugins"]) == [name]
