"""Short kinematic sweeps, flown once: a first one, one with a larger keep-out area, and the first
once more.
"""

import pytest

from reports.compare.content import compare, comparison_content
from reports.compare.pairs import read_runs
from tests.reports.compare.compared_runs import flown


@pytest.fixture(scope="session")
def first(tmp_path_factory):
    return flown(tmp_path_factory.mktemp("compare") / "first")


@pytest.fixture(scope="session")
def larger(tmp_path_factory):
    # No flight tracks to a nanometre: none meets its criteria here, and all do in the first.
    return flown(
        tmp_path_factory.mktemp("compare") / "larger",
        "keepout.radius_m=230.0",
        "criteria.tracking_error_rms_m=1e-9",
    )


@pytest.fixture(scope="session")
def same(tmp_path_factory):
    return flown(tmp_path_factory.mktemp("compare") / "same")


@pytest.fixture(scope="session")
def runs(first, larger):
    return read_runs([first, larger])


@pytest.fixture(scope="session")
def compared(runs):
    return compare(runs)


@pytest.fixture(scope="session")
def report(runs, compared):
    return comparison_content(runs, compared)
