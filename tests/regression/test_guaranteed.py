"""Flights with look-ahead and steering that no state can drive beyond omega_max
(docs/actuation_bounds.md).
"""

import pandas as pd
import pytest

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def directory(tmp_path_factory):
    # README, "Bounds", on the kinematic vehicle and at two speed ratios; comparisons are flown too,
    # line of sight among them.
    path = tmp_path_factory.mktemp("guaranteed") / "run"
    overrides = [
        "fidelity=kinematic",
        "sweep.nu=[0.5, 0.7]",
        "guidance.tuning=bounded",
        "guidance.reserve=0.4",
        "flight.crossings=10",
    ]
    scenario = load_study("sweep_nu", overrides)
    result = run_study(
        scenario, "sweep_nu", path, executor_factory=InProcessExecutor, overrides=overrides
    )
    assert result.all_met
    return path


def test_no_command_is_cut_and_none_exceeds_the_bound(directory):
    for _, row in pd.read_csv(directory / "summary.csv").iterrows():
        assert (
            row["heading_rate_demand_max_rad_s"]
            <= row["heading_rate_bound_rad_s"]
            <= row["heading_rate_limit_rad_s"]
        )
        assert row["saturation_fraction"] == 0.0
        # The look-ahead is the searched one, not the default of 60 m.
        assert row["look_ahead_m"] > 100.0


def test_the_line_of_sight_has_no_bound(directory):
    comparison = pd.read_csv(directory / "comparison.csv").set_index("flight_id")
    assert pd.isna(comparison.loc["nu_0.50_line_of_sight", "heading_rate_bound_rad_s"])
    assert comparison.loc["nu_0.50_no_preview", "heading_rate_bound_rad_s"] > 0.0
