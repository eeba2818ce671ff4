"""Flights with look-ahead and steering that no state can drive beyond omega_max
(docs/actuation_bounds.md).
"""

import pandas as pd
import pytest
from study_runs import flown

pytestmark = pytest.mark.slow


def test_no_command_is_cut_none_exceeds_the_bound_and_the_line_of_sight_has_none(tmp_path):
    # README, "Bounds", on the kinematic vehicle; comparisons are flown too, line of sight among
    # them.
    keys = (
        "fidelity=kinematic", "sweep.nu=[0.5]", "guidance.tuning=bounded", "guidance.reserve=0.4",
        "flight.crossings=8",
    )  # fmt: skip
    (row,) = flown(tmp_path / "run", "sweep_nu", *keys).to_dict("records")
    assert row["criteria_met"]
    assert (
        row["heading_rate_demand_max_rad_s"]
        <= row["heading_rate_bound_rad_s"]
        <= row["heading_rate_limit_rad_s"]
    )
    assert row["saturation_fraction"] == 0.0
    # The look-ahead is the searched one, not the default of 60 m.
    assert row["look_ahead_m"] > 100.0
    comparison = pd.read_csv(tmp_path / "run" / "comparison.csv").set_index("flight_id")
    bounds = comparison["heading_rate_bound_rad_s"]
    assert pd.isna(bounds["nu_0.50_line_of_sight"])
    assert bounds["nu_0.50_no_preview"] > 0.0
