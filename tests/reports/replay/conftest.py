"""Small kinematic runs of every study whose report has a replay, each flown once."""

import pytest
from trial_runs import small_trials

from scenarios.engine.processes import InProcessExecutor
from scenarios.scenario.files import load_study
from scenarios.studies import paper
from scenarios.studies.base import run_study

OVERRIDES = {
    "sweep_nu": ("sweep.nu=[0.5]", "flight.crossings=3", "comparison={}"),
    "monte_carlo": ("flights=1", "flight.duration_max_s=60", "draws=[]", "turbulence={}"),
    "sulphur": (
        "reports.interval_s=[0,0]",
        "sensors={}",
        "start.place_m=[-250,-120]",
        "flight.after_settling_s=30",
    ),
    "paper": ("flight.crossings=5",),
}


@pytest.fixture(scope="session")
def run_of(tmp_path_factory):
    """A function from a study's name to its run directory."""
    directory, flown = tmp_path_factory.mktemp("replay"), {}

    def run(name):
        if name == "trials" and name not in flown:
            flown[name] = small_trials(directory)
        elif name not in flown:
            with pytest.MonkeyPatch.context() as patch:
                # The bounds of the paper's run are not what is tested here, and take most of its
                # time.
                patch.setattr(paper, "SEARCH_STATES", 10_000)
                patch.setattr(paper, "RESERVES", (0.0, 0.2, 0.4))
                study = load_study(
                    name, ("fidelity=kinematic", "guidance.rate_hz=10", *OVERRIDES[name])
                )
                run_study(study, name, directory / name, executor_factory=InProcessExecutor)
            flown[name] = directory / name
        return flown[name]

    return run
