"""The files of the worst flights, of a search whose margin allows for faults that most of its
flights do not have.
"""

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.scenarios.short_search import short_flights

pytestmark = pytest.mark.slow

SEARCH = f"""
study = "falsify"
title = "short"
description = "A search."
fidelity = "kinematic"
seed = 3
[search]
population = 16
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
{short_flights(30.0)}"""


def flown(path, out, *overrides):
    run_study(load_study(str(path), overrides), path.stem, out, executor_factory=InProcessExecutor)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    folder = tmp_path_factory.mktemp("worst")
    (folder / "short.toml").write_text(SEARCH, encoding="utf-8")
    flown(folder / "short.toml", folder / "run")
    return folder / "run"


@pytest.mark.parametrize("fault", ["none", "vessel_data", "satellite_navigation"])
def test_a_worst_flight_keeps_the_margin_that_allows_for_the_faults_of_the_whole_search(
    found, tmp_path, fault
):
    searched = pd.read_csv(found / "summary.csv").set_index("flight_id")
    path = next(
        path
        for path in sorted((found / "worst").iterdir())
        if searched.loc[path.stem[3:], "fault"] == fault
    )
    # What is said of the search is not said of one of its flights.
    assert "description" not in path.read_text(encoding="utf-8")
    flown(path, tmp_path / "again")
    (again,) = pd.read_csv(tmp_path / "again" / "summary.csv").to_dict("records")
    row = searched.loc[path.stem[3:]]
    for figure in (
        "fault",
        "seed",
        "keepout_margin_m",
        "min_distance_m",
        "guard_interventions",
        "guard_time_s",
    ):
        assert again[figure] == row[figure]
    first = pd.read_parquet(found / "flights" / f"{row.name}.parquet")
    second = pd.read_parquet(tmp_path / "again" / "flights" / f"{path.stem}_00000.parquet")
    pd.testing.assert_frame_equal(first, second, check_exact=True)
    # Without the declaration it would not: the margin of a flight that can lose no satellites is 1
    # m smaller here.
    if fault != "satellite_navigation":
        flown(path, tmp_path / "other", "fault.declared=[]")
        assert (
            pd.read_csv(tmp_path / "other" / "summary.csv")["keepout_margin_m"].item()
            < row["keepout_margin_m"] - 0.5
        )
