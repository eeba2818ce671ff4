"""The same flights, flown twice: every file of results is the same to the last byte."""

import pandas as pd
import pytest

from scenarios.engine.runner import ExecutorFactory
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

pytestmark = pytest.mark.slow

LISTED = """
study = "trials"
title = "short"
trials = ["sim3", "sea_together"]
set = ["flights=1", "flight.duration_max_s=120", "flight.crossings=3", "turbulence={gusts=2, gust_speed_mps=4}", "histories=2"]
"""
"""The paper's flight with gusts, and everything random at once: start, wind, vessel, reports,
sensors, turbulence, gusts.
"""

TABLES = ("crossings.csv", "interventions.csv", "draws.csv")


def test_the_same_flights_leave_the_same_bytes_whatever_the_number_of_processes(tmp_path):
    path = tmp_path / "short.toml"
    path.write_text(LISTED, encoding="utf-8")
    for jobs in (1, 2):
        run_study(
            load_study(str(path)),
            "short",
            tmp_path / f"{jobs}",
            executor_factory=ExecutorFactory(jobs=jobs),
        )
    one, two = tmp_path / "1", tmp_path / "2"
    for name in TABLES:
        # Long enough for crossings and for the guard.
        assert len((one / name).read_text(encoding="utf-8").splitlines()) > 1, name
        assert (one / name).read_bytes() == (two / name).read_bytes(), name
    # Of a row, all but how long its flight took to compute.
    rows = [
        pd.read_csv(out / "summary.csv", dtype=str).drop(columns="wall_time_s")
        for out in (one, two)
    ]
    pd.testing.assert_frame_equal(*rows, check_exact=True)
    assert len(rows[0]) == 2
    flights = sorted(path.name for path in (one / "flights").iterdir())
    assert len(flights) >= 2
    for name in flights:
        assert (one / "flights" / name).read_bytes() == (two / "flights" / name).read_bytes(), name
