"""A small kinematic run of two trials, flown once, and its report."""

import pytest
from trial_runs import small_trials

from reports.registry import content
from reports.run.run_data import read_run


@pytest.fixture(scope="session")
def run_path(tmp_path_factory):
    return small_trials(tmp_path_factory.mktemp("trials"))


@pytest.fixture(scope="session")
def run(run_path):
    return read_run(run_path)


@pytest.fixture(scope="session")
def report(run):
    return content(run)
