"""Fixtures that several test packages share: the X8, bare and under an autopilot that is designed once per session.

They import what they need when they are used: tests/gnc runs where neither JSBSim nor python-control is installed.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import settings

if TYPE_CHECKING:
    from pathlib import Path

    from aircraft.fdm import Fdm
    from innerloop.designer import Design
    from innerloop.flight import AutopilotedAircraft
    from innerloop.schedule import Schedule

# No deadline, for time is not what is tested, and the same examples on every machine.
settings.register_profile("reproducible", deadline=None, derandomize=True)
settings.load_profile("reproducible")


@pytest.fixture(scope="session")
def x8_design() -> Design:
    """The X8's autopilot at its default altitude, and its margins; two seconds of work."""
    from aircraft.spec import X8
    from innerloop.designer import design_autopilot

    return design_autopilot(X8)


@pytest.fixture(scope="session")
def x8_schedule(x8_design: Design) -> Schedule:
    """The tables of the X8's autopilot."""
    return x8_design.schedule


@pytest.fixture(scope="session")
def x8_root(x8_schedule: Schedule, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A JSBSim root that flies the X8 under its autopilot."""
    from innerloop.jsbsim_root import write_root

    return write_root(x8_schedule, tmp_path_factory.mktemp("x8_root"))


@pytest.fixture
def x8_aircraft(x8_root: Path) -> AutopilotedAircraft:
    """An X8 under its autopilot, as fresh from the factory."""
    from aircraft.spec import X8
    from innerloop.flight import AutopilotedAircraft

    return AutopilotedAircraft(X8, x8_root)


@pytest.fixture
def x8_fdm() -> Fdm:
    """A bare X8."""
    from aircraft.fdm import Fdm
    from aircraft.spec import X8

    return Fdm(X8)
