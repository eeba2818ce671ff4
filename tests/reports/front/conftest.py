"""Short kinematic flights that the tests of page 1 share: five, and one."""

import pytest
from report_parts import flown_text

SHORT = """
title = "Short"
fidelity = "kinematic"
guidance.rate_hz = 10.0
seed = 3
vessel.speed_mps = 8.0
flight.crossings = 2
start.distance_m = [300.0, 400.0]
criteria.tracking_error_rms_m = 5.0
report.author = "A. Author"
"""


@pytest.fixture(scope="session")
def five_path(tmp_path_factory):
    return flown_text(tmp_path_factory, "short", f"{SHORT}flights = 5\n")


@pytest.fixture(scope="session")
def one_path(tmp_path_factory):
    return flown_text(tmp_path_factory, "short", f"{SHORT}flights = 1\n")


@pytest.fixture(scope="session")
def sweep_path(tmp_path_factory):
    text = SHORT.replace("vessel.speed_mps = 8.0\n", "")
    return flown_text(tmp_path_factory, "short", f"{text}[sweep]\nnu = [0.2, 0.4]\n")
