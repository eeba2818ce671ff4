"""Fixtures that several test packages share: designs made once per run, the X8 bare and under its
autopilot.

They import what they need when they are used: tests/gnc runs where neither JSBSim nor
python-control is installed.
"""

from __future__ import annotations

import contextlib
import functools
import gc
import os
import runpy
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

# Tests run in two processes; threads under each of their small matrices would only be in the way.
# Before numpy is imported.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# What `make fast` has compiled takes no stand-ins for its parts. PLUME_FLIGHT_SOURCES= tests that
# all the same.
os.environ.setdefault("PLUME_FLIGHT_SOURCES", "1")

import pytest

try:
    from hypothesis import settings
except ModuleNotFoundError:
    # tests/measurement runs with numpy, scipy, pandas and pytest alone.
    settings = None

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from aircraft.fdm import Fdm
    from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft
    from innerloop.schedule import Schedule
    from innerloop.store import Design, Designed

# No deadline, for time is not what is tested, and the same examples on every machine.
if settings is not None:
    settings.register_profile("reproducible", deadline=None, derandomize=True, max_examples=50)
    settings.load_profile("reproducible")


SWEPT_ALTITUDE = 60.0
"""Altitude of the catalog's flights, at which designs are made for all tests [m]."""

MEMORY, MEMORY_MIN = Path("/dev/shm"), 2 * 2**30
"""Where Linux keeps files in memory, and how much of it has to be free for those of the tests [B]:
a run leaves a tenth of it.
"""


def pytest_configure() -> None:
    """Leave what tests are collected from to stay: looking for garbage among it took a third of the
    time of collecting them.

    Bytecode is written even if the shell says otherwise: without it each run, and each process that tests
    begin, compiles all modules anew.
    """
    gc.disable()
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    sys.dont_write_bytecode = False
    # Some ten thousand files are written, synchronised and deleted: up to 5 ms each on a disk.
    if (
        "TMPDIR" not in os.environ
        and os.access(MEMORY, os.W_OK)
        and shutil.disk_usage(MEMORY).free > MEMORY_MIN
    ):
        os.environ["TMPDIR"] = tempfile.tempdir = str(MEMORY)


def pytest_collection_finish() -> None:
    """Look for garbage again, but not among what was imported and collected, which stays, and
    seldom among what fixtures keep.
    """
    gc.freeze()
    gc.set_threshold(7_000, 20, 50)
    gc.enable()


@pytest.fixture(scope="session", autouse=True)
def cache_home(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A cache directory for this run and all its workers, so that tests neither read nor leave
    designs in the user's.
    """
    base = tmp_path_factory.getbasetemp()
    home = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "cache"
    home.mkdir(exist_ok=True)
    with pytest.MonkeyPatch.context() as patch:
        # Matplotlib's list of fonts is in the same directory, and takes seconds to make again.
        fonts = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "matplotlib"
        if "MPLCONFIGDIR" not in os.environ:
            patch.setenv("MPLCONFIGDIR", str(fonts))
        patch.setenv("XDG_CACHE_HOME", str(home))
        yield home


@pytest.fixture(scope="session")
def designs(cache_home: Path) -> Callable[..., Designed]:
    """A function from an aircraft and an altitude [m] to its design and record, made by whichever
    worker asks first: seconds.
    """
    from aircraft.fleet.find import find_spec
    from innerloop.store import designed

    @functools.cache
    def design(name: str, altitude: float = SWEPT_ALTITUDE) -> Designed:
        with _alone(cache_home / f"{Path(name).name}.lock"):
            return designed(find_spec(name), altitude)

    return design


@contextlib.contextmanager
def _alone(lock: Path) -> Iterator[None]:
    """Wait while another worker is at the same work, for two minutes at most: then it does not live
    any more.
    """
    for _ in range(2400):
        with contextlib.suppress(FileExistsError):
            lock.touch(exist_ok=False)
            break
        time.sleep(0.05)
    try:
        yield
    finally:
        lock.unlink(missing_ok=True)


@pytest.fixture(scope="session")
def x8_design(designs: Callable[..., Designed]) -> Design:
    """The X8's autopilot and its margins."""
    return designs("x8").design


@pytest.fixture(scope="session")
def heavy_design(
    designs: Callable[..., Designed], tmp_path_factory: pytest.TempPathFactory
) -> Designed:
    """The autopilot of the Cessna of docs/scripts/aircraft_directory.py."""
    script = Path(__file__).parents[1] / "docs" / "scripts" / "aircraft_directory.py"
    folder = runpy.run_path(str(script))["write_heavy_cessna"](tmp_path_factory.mktemp("fleet"))
    return designs(str(folder))


@pytest.fixture(scope="session")
def x8_schedule(x8_design: Design) -> Schedule:
    """The tables of the X8's autopilot."""
    return x8_design.schedule


@pytest.fixture(scope="session")
def x8_root(x8_schedule: Schedule, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A JSBSim root that flies the X8 under its autopilot."""
    from innerloop.jsbsim.system import write_root

    return write_root(x8_schedule, tmp_path_factory.mktemp("x8_root"))


@pytest.fixture
def sketched(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have reports printed with an empty picture in the place of each figure: to draw them takes
    nearly all of their time.

    For tests that ask what a report says, of a kind that another test has drawn.
    """
    from matplotlib.figure import Figure

    monkeypatch.setattr("reports.render.figure_files.draw", lambda _: Figure(figsize=(1.0, 1.0)))


@pytest.fixture
def x8_aircraft(x8_root: Path) -> AutopilotedAircraft:
    """An X8 under its autopilot, as fresh from the factory."""
    from aircraft.fleet.x8 import X8
    from innerloop.flight.autopiloted_aircraft import AutopilotedAircraft

    return AutopilotedAircraft(X8, x8_root)


@pytest.fixture
def x8_fdm() -> Fdm:
    """A bare X8."""
    from aircraft.fdm import Fdm
    from aircraft.fleet.x8 import X8

    return Fdm(X8)
