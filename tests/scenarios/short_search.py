"""A search for the worst flight, kinematic and short, and what its runs hold."""

import pandas as pd

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

POPULATION, GENERATIONS, KEPT, CONFIRMATIONS = 12, 7, 3, 2

METHODS = ("corners", "differential_evolution", "local", "cma")


def short_flights(duration):
    """Return the tables of flights that are quick to fly, of so many seconds, in which keeping out
    alone is required.
    """
    return f"""
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
{short_flights(4.0)}"""


def run(search, out, *overrides, factory=InProcessExecutor, resume=False, progress=lambda *_: None):
    """Fly the search of a scenario file."""
    scenario = load_study(str(search), overrides)
    return run_study(
        scenario,
        "short",
        out,
        executor_factory=factory,
        resume=resume,
        progress=progress,
        overrides=overrides,
    )


def tables(out):
    """Return a run's flights of the search, and those that repeat the worst, each with its row of
    inputs.
    """
    rows = pd.read_csv(out / "summary.csv").merge(
        pd.read_csv(out / "draws.csv"), on="flight_id", validate="one_to_one"
    )
    repeated = rows["confirms"].notna()
    return rows[~repeated], rows[repeated]


def same_tables(one, other):
    """Assert that two runs have the same flights, and keep the same worst ones."""
    for name in ("summary.csv", "draws.csv"):
        rows = [
            pd.read_csv(run / name).drop(columns="wall_time_s", errors="ignore")
            for run in (one, other)
        ]
        pd.testing.assert_frame_equal(*rows, check_exact=True)
    assert {p.name: p.read_bytes() for p in (one / "worst").iterdir()} == {
        p.name: p.read_bytes() for p in (other / "worst").iterdir()
    }
