"""The search for the worst flight, kinematic and short, the flights that it repeats and the files
that it keeps.
"""

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.runner import ExecutorFactory
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.run_tables import manifest_of
from tests.scenarios.short_search import (
    CONFIRMATIONS,
    GENERATIONS,
    KEPT,
    POPULATION,
    run,
    same_tables,
    tables,
)  # fmt: skip

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def found(search, tmp_path_factory):
    out = tmp_path_factory.mktemp("falsify") / "run"
    assert run(search, out, factory=ExecutorFactory(jobs=2)).all_met
    return out


def distances(out):
    return tables(out)[0]["min_distance_m"].to_numpy()


def test_the_search_closes_in_on_the_nearest_start_that_flies_at_the_vessel(found):
    every = distances(found)
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
    assert repeats["confirms"].tolist() == [entry["flight_id"] for entry in sorted(worst, key=lambda of: of["flight_id"])
                                            for _ in range(CONFIRMATIONS)]  # fmt: skip
    assert repeats["seed"].nunique() == len(repeats) == KEPT * CONFIRMATIONS
    assert not set(repeats["seed"]) & set(searched["seed"])
    keys = ["start.range_m", "start.course_deg", "wind.from_deg"]
    for entry in worst:
        again = repeats[repeats["confirms"] == entry["flight_id"]]
        (first,) = searched[searched["flight_id"] == entry["flight_id"]][keys].to_numpy()
        assert (again[keys].to_numpy() == first).all()
        assert (entry["confirmations"], entry["confirmations_violating"]) == (CONFIRMATIONS, 0)
        assert entry["confirmations_nearest_m"] == pytest.approx(
            again["min_distance_m"].min() - 200.0, rel=1e-12
        )


def test_the_worst_flights_are_kept_as_scenarios_that_fly_again_to_the_last_bit(found, tmp_path):
    kept = sorted((found / "worst").iterdir())
    assert [path.name[:3] for path in kept] == ["01_", "02_", "03_"]
    searched = tables(found)[0].set_index("flight_id")["min_distance_m"]
    assert searched[kept[0].stem[3:]] == searched.min()
    for path in kept:
        out, flight_id = tmp_path / path.stem, path.stem[3:]
        result = run_study(
            load_study(str(path)), path.stem, out, executor_factory=InProcessExecutor
        )
        assert result.all_met
        assert pd.read_csv(out / "summary.csv")["min_distance_m"].tolist() == [searched[flight_id]]
        first = pd.read_parquet(found / "flights" / f"{flight_id}.parquet")
        again = pd.read_parquet(out / "flights" / f"{path.stem}_00000.parquet")
        pd.testing.assert_frame_equal(first, again, check_exact=True)
    # And what is flown again can be changed.
    changed = load_study(str(kept[0]), ["keepout.radius_m=150"])
    other = run_study(changed, "changed", tmp_path / "changed", executor_factory=InProcessExecutor)
    assert other.verdict.counts.done == 1


def test_the_search_goes_the_same_way_whatever_the_number_of_processes_and_where_it_was_interrupted(
    search, found, tmp_path
):
    out = tmp_path / "run"
    # In the second turn of a method, in the last one, and among the flights that repeat the worst.
    searched = len(tables(found)[0])
    for after in (POPULATION + 5, searched - 3, searched + KEPT):

        def interrupt(_doing, done, _, after=after):
            if done == after:
                raise KeyboardInterrupt

        assert run(search, out, resume=out.exists(), progress=interrupt).verdict.interrupted
        assert len(pd.read_csv(out / "summary.csv")) == after
    assert run(search, out, resume=True).all_met
    same_tables(found, out)


OWN_METHOD = """
class Centre:
    exhausted = False

    def __init__(self, space, settings, generator):
        self.space, self.generator = space, generator

    def ask(self, found, room):
        return 0.4 + 0.2 * self.generator.random((min(room, 5), self.space.dimension))

    def tell(self, clearances):
        pass
"""


def test_a_method_of_ones_own_takes_its_turns(search, tmp_path):
    (tmp_path / "own.py").write_text(OWN_METHOD, encoding="utf-8")
    name = str(tmp_path / "own.py:Centre")
    out = tmp_path / "run"
    run(
        search,
        out,
        f'search.methods=["corners","{name}"]',
        "search.generations=3",
        "search.confirmations=0",
    )
    searched, repeats = tables(out)
    assert searched["search_method"].value_counts().to_dict() == {
        "corners": 2 * POPULATION,
        name: 2 * POPULATION,
    }
    assert (
        searched[searched["search_method"] == name]["start.range_m"]
        .between(400.0 + 0.4 * 800.0, 400.0 + 0.6 * 800.0)
        .all()
    )
    assert not len(repeats)
    assert list(manifest_of(out)["plugins"]) == [name]
