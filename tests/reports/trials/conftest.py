"""The small run of two trials as read, and its report."""

import pytest

from reports.registry import content
from reports.run.run_data import read_run


@pytest.fixture(scope="session")
def run(small_run):
    return read_run(small_run)


@pytest.fixture(scope="session")
def report(run):
    return content(run)
