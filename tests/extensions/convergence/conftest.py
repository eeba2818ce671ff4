"""Two made-up studies, in one of which all trajectories converged, and their reports."""

import pytest
from convergence_runs import SAMPLES, TRAJECTORIES, write_convergence_run

from reports.registry import content
from reports.run.run_data import read_run

FAILURES = [("lyapunov", 3, "time_up"), ("cascade", 7, "steps_up"), ("cascade", 200, "not_finite")]


@pytest.fixture(scope="session")
def converged_path(tmp_path_factory):
    return write_convergence_run(
        tmp_path_factory.mktemp("converged") / "run", TRAJECTORIES, samples=SAMPLES
    )


@pytest.fixture(scope="session")
def failed_path(tmp_path_factory):
    return write_convergence_run(
        tmp_path_factory.mktemp("failed") / "run",
        TRAJECTORIES,
        samples=SAMPLES,
        failures=FAILURES,
        cut_failures=40,
    )


@pytest.fixture(scope="session")
def converged(converged_path):
    return content(read_run(converged_path))


@pytest.fixture(scope="session")
def failed(failed_path):
    return content(read_run(failed_path))
