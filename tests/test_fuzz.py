"""Bits flipped, files missing, cut, empty and of the wrong kind, numbers of every size: a line and
a documented exit status.

Each example is a command in this process. Whatever it lets through would be a traceback, and fails
the test; so does a file outside of its run directory. The environment variable FUZZ_DEPTH
multiplies the number of examples, which are then others each time.
"""

import contextlib
import json
import math
import os
import resource
import shutil
import signal
from pathlib import Path

import pandas as pd
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from common.command_line import BAD_INPUT
from reports.errors import ReportError
from reports.registry import content
from reports.run.files import damage_named
from reports.run.run_data import read_run
from scenarios.engine.processes import InProcessExecutor, data_memory
from scenarios.errors import InputError
from scenarios.scenario.files import load_study
from scenarios.scenario.scenario import Scenario
from scenarios.studies.base import study_of
from tests.in_process import run_command
from tests.scenarios.short_trial import short_trial

pytestmark = pytest.mark.slow

DEPTH = int(os.environ.get("FUZZ_DEPTH", "1"))
TIME_MAX = 60
"""Longest example [s]."""

MEMORY_MAX = 2**30
"""What examples may use beside what the test had before them [bytes]."""

FLIGHTS = 3
KINEMATIC = ("kinematic", "x8")

SIZES = [
    0,
    -1,
    1,
    2**31,
    2**63,
    -(2**63) - 1,
    10**30,
    1e-300,
    1e-9,
    1e9,
    1e300,
    -1e300,
    5e-324,
    math.inf,
    math.nan,
]
NUMBERS = st.one_of(st.sampled_from(SIZES), st.integers(), st.floats())
NAMES = [
    "", ".", "..", "/", "../../x", "a\x00b", "=1+1", "<!--<script>", "none", "x8", "a" * 300,
    "x.py:X", "é", "\u2028",
]  # fmt: skip
WORDS = st.one_of(st.sampled_from(NAMES), st.text(max_size=8))
VALUES = st.recursive(
    st.one_of(NUMBERS, WORDS, st.booleans()),
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(WORDS, inner, max_size=2)),
    max_leaves=6,
)


def keys_of(document, before=""):
    """Return every dotted key of a scenario."""
    keys = []
    for key, value in document.items():
        keys.append(f"{before}{key}")
        keys += keys_of(value, f"{before}{key}.") if isinstance(value, dict) else []
    return keys


SWEPT = ["sweep.nu", "sweep.wind.speed_mps", "draws.0.key"]
KEYS = st.sampled_from([*keys_of(Scenario(title="all").model_dump(mode="json")), *SWEPT]) | WORDS
FLAGS = ["--resume", "--no-report", "--list"]
OPTIONS = st.sampled_from(
    [
        "--out",
        "--jobs",
        "--seed",
        "--set",
        "--time-limit",
        "--memory-limit",
        "--nothing",
        "--export",
        *FLAGS,
    ]
)


@contextlib.contextmanager
def bounded():
    """Fail an example that hangs or fills the memory."""

    def hangs(*_):
        raise TimeoutError(f"an example took more than {TIME_MAX} s")

    soft, hard = resource.getrlimit(resource.RLIMIT_DATA)
    before = signal.signal(signal.SIGALRM, hangs)
    resource.setrlimit(resource.RLIMIT_DATA, (data_memory() + MEMORY_MAX, hard))
    signal.alarm(TIME_MAX)
    full = False
    try:
        yield
    except MemoryError:
        full = True
    finally:
        signal.alarm(0)
        resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))
        signal.signal(signal.SIGALRM, before)
    assert not full, f"an example used more than {MEMORY_MAX / 2**30:g} GiB"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A directory with a short trial, its run, and nothing else; examples leave it as it was but
    for their run directory.
    """
    place = tmp_path_factory.mktemp("fuzz")
    (place / "short.toml").write_text(short_trial(flights=FLIGHTS, duration=5.0), encoding="utf-8")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(place)
        # In this process: what examples damage is not how flights are spread over processes.
        patch.setattr(
            "scenarios.engine.runner.LocalExecutor", lambda work, **_: InProcessExecutor(work)
        )
        words = ("short.toml", "--out", "whole", "--jobs", "1", "--no-report")
        assert run_command("scenarios.run", *words).status == 0
        yield place


def files_in(place):
    paths = [path.relative_to(place) for path in place.rglob("*")]
    return sorted(path.as_posix() for path in paths if path.parts[0] != "run")


def ended(place, module, *arguments):
    """Run a command; check its status, its message, and that it left everything but ``run`` alone.
    Return how it ended.
    """
    before = files_in(place)
    with bounded():
        found = run_command(module, *arguments)
    assert found.status in (0, 1, 2), (arguments, found)
    assert "Traceback" not in found.errors
    if found.status == BAD_INPUT:
        # One line, also where a name has a line separator of Unicode's.
        *_, last = found.errors.splitlines()
        assert last.startswith("error: "), (arguments, found)
    assert files_in(place) == before, arguments
    return found


def fresh(place):
    shutil.rmtree(place / "run", ignore_errors=True)
    return shutil.copytree(place / "whole", place / "run")


@given(st.lists(st.tuples(KEYS, VALUES), min_size=1, max_size=3))
@settings(max_examples=100 * DEPTH, derandomize=DEPTH == 1)
def test_any_configuration_is_a_study_or_refused_in_a_line(place, pairs):
    with bounded(), contextlib.suppress(InputError):
        words = [f"{key}={json.dumps(value, ensure_ascii=False)}" for key, value in pairs]
        scenario = load_study("short.toml", words)
        if isinstance(scenario, Scenario) and (scenario.fidelity, scenario.aircraft) == KINEMATIC:
            study_of(scenario, "short")


@given(st.binary(max_size=60) | st.text(max_size=60).map(str.encode), st.integers(0, 1000))
@settings(max_examples=60 * DEPTH, derandomize=DEPTH == 1)
def test_any_scenario_file_is_a_study_or_refused_in_a_line(place, junk, at):
    whole = (place / "short.toml").read_bytes()
    path = place / "run" / "fuzzed.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(whole[: at % len(whole)] + junk + whole[at % len(whole) :])
    with contextlib.suppress(InputError):
        load_study(str(path))


@given(
    st.lists(st.tuples(OPTIONS, st.one_of(NUMBERS.map(str), WORDS)), min_size=1, max_size=3),
    st.booleans(),
)
@settings(max_examples=60 * DEPTH, derandomize=DEPTH == 1)
def test_any_command_line_ends_with_a_documented_status(place, options, named):
    # Nothing is flown: a scenario that there is not is the last that is looked for.
    words = ["nothing.toml"] if named else []
    for option, value in options:
        if "\x00" in value:
            continue  # No program can be given that.
        words += [option] if option in FLAGS else [option, value]
    for module in ("scenarios.run", "reports.build"):
        ended(place, module, *words)


DAMAGES = st.sampled_from(["flip", "cut", "empty", "gone", "directory", "junk", "digit"])


def damage(path, how, at):
    """Damage a file of a run."""
    whole = bytearray(path.read_bytes())
    at %= max(1, len(whole))
    path.unlink()
    if how == "directory":
        path.mkdir()
    elif how != "gone":
        if how == "flip" and whole:
            whole[at] ^= 1 << (at % 8)
        elif how == "digit":
            digits = [i for i, byte in enumerate(whole) if byte in b"0123456789"] or [0]
            place = digits[at % len(digits)]
            whole[place : place + 1] = b"7" if whole[place : place + 1] != b"7" else b"3"
        content = {"cut": whole[:at], "empty": b"", "junk": b"\x00\xff{[" * 20}.get(how, whole)
        path.write_bytes(content)


def table(run):
    return pd.read_csv(run / "summary.csv").drop(columns="wall_time_s")


RUN_FILES = [
    "manifest.json", "journal.sqlite", "journal.sqlite", "summary.csv", "draws.csv",
    "flights/short_00001.parquet",
]  # fmt: skip

DAMAGED = given(st.sampled_from(RUN_FILES), DAMAGES, st.integers(0, 10**6))
FEW = settings(max_examples=10 * DEPTH, derandomize=DEPTH == 1)


@DAMAGED
@FEW
def test_a_damaged_run_is_continued_to_the_same_rows_or_refused(place, name, how, at):
    run = fresh(place)
    damage(run / name, how, at)
    words = ("short.toml", "--out", "run", "--resume", "--jobs", "1", "--no-report")
    found = ended(place, "scenarios.run", *words)
    if found.status != BAD_INPUT:
        # Nothing is believed that does not add up.
        assert found.status == 0, found
        pd.testing.assert_frame_equal(table(run), table(place / "whole"), check_exact=True)


@DAMAGED
@FEW
def test_a_flight_of_a_damaged_run_is_replayed_or_refused(place, name, how, at):
    original = fresh(place)
    damage(original / name, how, at)
    inside = original / "again"
    words = ("run/flights/short_00001", "--out", inside, "--jobs", "1", "--no-report")
    found = ended(place, "scenarios.run", *words)
    if found.status == 0:
        one = table(place / "whole").iloc[[1]].reset_index(drop=True)
        pd.testing.assert_frame_equal(table(inside), one, check_exact=True, check_dtype=False)


@DAMAGED
@FEW
def test_a_report_of_a_damaged_run_names_it_or_is_refused(place, name, how, at):
    run = fresh(place)
    damage(run / name, how, at)
    with bounded(), contextlib.suppress(ReportError):
        data = read_run(run)
        with damage_named(run):
            shown = content(data)
        # A file that is gone is named; one that is changed may be read as something else.
        if how == "gone" and not name.startswith("journal"):
            assert shown.sections[0].anchor == "missing"


def test_the_whole_run_is_as_it_was(place):
    assert Path("whole", "summary.csv").is_file()
    words = ("short.toml", "--out", "whole", "--resume", "--no-report")
    assert ended(place, "scenarios.run", *words).status == 0
