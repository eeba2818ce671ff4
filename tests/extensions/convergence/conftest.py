"""A small study from near by under three laws, and the same with failures written into it."""

import shutil
from unittest import mock

import numpy as np
import pandas as pd
import pytest

from reports.registry import content
from reports.run.run_data import read_run
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

TRAJECTORIES = 12
SETTINGS = (
    f"ensemble.trajectories={TRAJECTORIES}",
    "ensemble.distance_max_m=50",
    f"ensemble.samples={TRAJECTORIES}",
    'guidance.laws=["lyapunov","cascade","cascade_cut"]',
)
CUT_FAILURES, ROWS_SHOWN = 7, 5
FAILURES = [
    ("lyapunov", 3, "time_up"),
    ("cascade", 7, "steps_up"),
    ("cascade", 11, "not_finite"),
    *(("cascade_cut", number, "time_up") for number in range(CUT_FAILURES)),
]


@pytest.fixture(scope="session")
def directory(tmp_path_factory):
    path = tmp_path_factory.mktemp("convergence") / "run"
    study = load_study("convergence", SETTINGS)
    assert run_study(study, "convergence", path, executor_factory=InProcessExecutor).all_met
    return path


@pytest.fixture(scope="session")
def failed_path(directory, tmp_path_factory):
    path = shutil.copytree(directory, tmp_path_factory.mktemp("failed") / "run")
    rows = pd.read_csv(path / "summary.csv")
    figures = ["settling_time_s", "distance_final_m", "phi_final_rad"]
    for law, trajectory, outcome in FAILURES:
        chosen = (rows["law"] == law) & (rows["trajectory"] == trajectory)
        finite = outcome != "not_finite"
        rows.loc[chosen, ["outcome", "message"]] = (
            outcome,
            "812.3 m from the reference after 20000 s, phi 0.31 rad: raise time_max"
            if finite
            else "the step from there is not finite",
        )
        rows.loc[chosen, figures] = (np.nan, 812.3, 0.31) if finite else np.nan
    rows.to_csv(path / "summary.csv", index=False)
    rows[rows["outcome"] != "converged"].to_csv(path / "counterexamples.csv", index=False)
    return path


@pytest.fixture(scope="session")
def failed(failed_path):
    with mock.patch("extensions.convergence.report.FAILED_ROWS", ROWS_SHOWN):
        return content(read_run(failed_path))
