"""A small kinematic run of two trials, flown once, and its report."""

import pytest

from reports.registry import content
from reports.run.run_data import read_run
from scenarios.schema.experiment import TrialList
from scenarios.studies.registry import run_study

# Both settle and cross a few times, within some 150 s; after that the vessel of the second turns, which takes it 40 s at most.
STEADY = """
study = "sea"
title = "Steady"
fidelity = "kinematic"
flights = 2
draws = [{ key = "wind.speed_mps", uniform = [2.0, 4.0] }]
[flight]
crossings = 3
[criteria]
crossing_interval_error = 0.0321
"""
TURNS = """
study = "sea"
title = "Turns"
fidelity = "kinematic"
flights = 2
[wind]
speed_mps = 3.0
[reports]
interval_s = [2.0, 10.0]
[following]
vessel_acceleration_mps2 = 0.1
[[draws]]
key = "vessel.manoeuvres"
choice = [[{ at_s = 150.0, turn_deg = 20.0, turn_rate_deg_s = 0.5 }], [{ at_s = 150.0, turn_deg = -10.0, turn_rate_deg_s = 0.5 }]]
[flight]
crossings = 0
duration_max_s = 220.0
[criteria]
settles = false
"""


@pytest.fixture(scope="session")
def run_path(tmp_path_factory):
    folder = tmp_path_factory.mktemp("trials")
    for name, text in (("steady", STEADY), ("turns", TURNS)):
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    study = TrialList(study="trials", title="Small", trials=[str(folder / "steady.toml"), str(folder / "turns.toml")])
    run_study(study, "small", folder / "run")
    return folder / "run"


@pytest.fixture(scope="session")
def run(run_path):
    return read_run(run_path)


@pytest.fixture(scope="session")
def report(run):
    return content(run)
