"""The Monte Carlo study as it comes, with few and short flights of the X8; thousands are flown by
the command.
"""

import json

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

pytestmark = pytest.mark.slow

FLIGHTS = 6


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    out = tmp_path_factory.mktemp("monte_carlo") / "run"
    scenario = load_study(
        "monte_carlo", [f"flights={FLIGHTS}", "flight.duration_max_s=60", "histories=1"]
    )
    run_study(scenario, "monte_carlo", out, executor_factory=InProcessExecutor)
    return out


def test_no_flight_enters_the_keep_out_area(directory):
    summary = pd.read_csv(directory / "summary.csv")
    assert len(summary) == FLIGHTS
    # Not all of them settle within 60 s: those are not met, and keep out all the same.
    assert set(summary["outcome"]) <= {"completed", "not_settled", "incomplete"}
    assert (summary["criteria_met"] == (summary["outcome"] == "completed")).all()
    assert summary["kept_out"].all()
    # Issue: zero violations; r_min is 200 m.
    assert (summary["keepout_violations"] == 0).all()
    assert summary["min_distance_m"].min() >= 200.0
    # Light and moderate turbulence plan more than still air does.
    margin = summary.groupby("turbulence")["keepout_margin_m"].min()
    assert margin["none"] < margin["light"] < margin["moderate"]


def test_the_bound_follows_from_their_number(directory):
    statistics = json.loads((directory / "statistics.json").read_text(encoding="utf-8"))
    # One-sided, Clopper and Pearson: 0 of n.
    assert statistics["violation"]["pessimistic"]["upper"] == pytest.approx(
        1.0 - 0.05 ** (1.0 / FLIGHTS), rel=1e-9
    )
