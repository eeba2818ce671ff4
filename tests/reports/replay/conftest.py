"""Small kinematic runs of studies whose report has a replay, each flown once."""

import pytest
from report_parts import flown

OVERRIDES = {
    "sweep_nu": ("sweep.nu=[0.5]", "flight.crossings=3", "comparison={}"),
    "sulphur": (
        "reports.interval_s=[0,0]",
        "sensors={}",
        "start.place_m=[-250,-120]",
        "flight.after_settling_s=30",
    ),
}


@pytest.fixture(scope="session")
def run_of(small_run, tmp_path_factory):
    """A function from a study's name to its run directory."""
    paths = {"trials": small_run}

    def run(name):
        if name not in paths:
            given = ("fidelity=kinematic", "guidance.rate_hz=10", *OVERRIDES[name])
            paths[name] = flown(tmp_path_factory, name, given)
        return paths[name]

    return run
