"""Small kinematic runs of studies whose report has a replay, each flown once."""

import pytest
from report_parts import flown
from trial_runs import small_trials

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
def run_of(tmp_path_factory):
    """A function from a study's name to its run directory."""
    paths = {}

    def run(name):
        if name not in paths:
            given = ("fidelity=kinematic", "guidance.rate_hz=10", *OVERRIDES.get(name, ()))
            paths[name] = (
                small_trials(tmp_path_factory.mktemp("replay"))
                if name == "trials"
                else flown(tmp_path_factory, name, given)
            )
        return paths[name]

    return run
