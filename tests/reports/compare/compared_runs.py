"""Runs to compare: short kinematic sweeps that are flown, and made-up ones with given rows."""

from pathlib import Path

import pandas as pd

from reports.compare.pairs import Run
from reports.run.run_data import RunData
from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.reports.run_columns import RUN_COLUMNS

SWEEP = (
    "fidelity=kinematic",
    "guidance.rate_hz=10",
    "sweep.nu=[0.3, 0.5, 0.7]",
    "flight.crossings=3",
    "comparison={}",
    # Three crossings are too few for the study's own criteria.
    "criteria.crossing_interval_error=0.1",
    "criteria.tracking_error_rms_m=5.0",
)


def flown(path, *overrides):
    """Fly a short sweep into a directory and return its path."""
    given = [*SWEEP, *overrides]
    study = load_study("sweep_nu", given)
    run_study(study, "sweep_nu", path, executor_factory=InProcessExecutor, overrides=given)
    return path


def made_run(letter, rows, draws=None):
    """Return a run with these rows and values of its random variables, and nothing else."""
    data = RunData(
        path=Path(letter.lower()),
        manifest={},
        summary=pd.DataFrame(rows),
        comparison=pd.DataFrame(),
        crossings=pd.DataFrame(),
        innerloop=None,
        statistics=None,
        columns=RUN_COLUMNS,
        draws=pd.DataFrame(draws if draws is not None else {"flight_id": []}),
    )
    return Run(letter=letter, data=data, trials=[])


def rows_of(numbers, *, trial="sea", seed=100, prefix="", **columns):
    """Return a row for each number: its flight's name and seed follow from it, other columns are
    lists.
    """
    return [
        {
            "flight_id": f"{prefix}{number:05d}",
            "trial": trial,
            "seed": seed + number,
            "outcome": "completed",
            "message": "",
            "criteria_met": True,
            "kept_out": True,
            "keepout_violations": 0,
            "keepout_radius_m": 200.0,
            "min_distance_m": 201.0,
        }
        | {name: values[i] for name, values in columns.items()}
        for i, number in enumerate(numbers)
    ]
