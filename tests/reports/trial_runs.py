"""A small run of two kinematic trials, and how tests change it and look into its report."""

import json
from dataclasses import replace

from judged_runs import judged
from report_parts import blocks_of

from reports.document.blocks import Table
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.sections.experiment import TrialList
from scenarios.studies.base import run_study

# Both settle and cross a few times, within some 150 s; after that the vessel of the second turns,
# which takes it 40 s at most.
STEADY = """
extends = "operational"
study = "flights"
title = "Steady"
fidelity = "kinematic"
guidance.rate_hz = 10.0
flights = 2
draws = [{ key = "wind.speed_mps", uniform = [2.0, 4.0] }]
[flight]
crossings = 3
[criteria]
crossing_interval_error = 0.0321
"""
TURNS = """
extends = "operational"
study = "flights"
title = "Turns"
fidelity = "kinematic"
guidance.rate_hz = 10.0
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


def small_trials(folder):
    """Fly both trials, two flights each; return the run directory."""
    for name, text in (("steady", STEADY), ("turns", TURNS)):
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    study = TrialList(
        study="trials",
        title="Small",
        trials=[str(folder / "steady.toml"), str(folder / "turns.toml")],
    )
    run_study(study, "small", folder / "run", executor_factory=InProcessExecutor)
    return folder / "run"


def with_values(run, number, **values):
    """Return a run with other values in one row of its summary."""
    summary = run.summary.copy()
    for key, value in values.items():
        summary.loc[number, key] = value
    return judged(replace(run, summary=summary))


def rows_of(report, title):
    """Return the cells of a trial in the tables of all trials, but for its title."""
    return [
        row[1:]
        for table in blocks_of(report, Table, "trials")
        for row in table.rows
        if row[0] == title
    ]


def with_criterion(run, trial, key, value):
    manifest = json.loads(json.dumps(run.manifest))
    manifest["trials"][trial]["criteria"][key] = value
    return judged(replace(run, manifest=manifest))
