"""The commands as a user types them: in another process where that is tested, else in this one,
which has imported all.
"""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pandas as pd
import pytest

from common.verdict import read_verdict
from scenarios.run import main
from tests.in_process import assert_refused, run_command
from tests.run_tables import manifest_of
from tests.scenarios.short_trial import short_trial

ROOT = Path(__file__).parents[2]


def run_here(name, *keys, out=None, more=()):
    """Run a study with some keys in this process."""
    place = ("--out", out) if out else ()
    given = [word for key in keys for word in ("--set", key)]
    return run_command("scenarios.run", name, *given, *place, "--no-report", *more)


HEAVY = {"scipy", "pandas", "control", "matplotlib", "typst"}
DESIGNING = {"control", "slycot", "matplotlib", "scipy.signal", "plotly", "jinja2", "typst"}
"""What designs an autopilot, evaluates readings and writes reports."""
FLIGHTS = """
from scenarios import fly
for fidelity in ("kinematic", "six_dof"):
    fly("sweep_nu", nu=0.5, fidelity=fidelity, **{"flight.duration_max_s": 5.0})
"""
"""Flights of both vehicles, the autopilot of one of them in the cache."""

NAMES = {"numpy", "jsbsim", "plotly", "pydantic"}
STEPS = {
    "import scenarios": HEAVY | NAMES | {"typer"},
    "import scenarios.run, innerloop.design, reports.build": HEAVY | NAMES,
    "from scenarios.cli.describe import described; described('payload.sensor')": HEAVY,
    FLIGHTS: DESIGNING,
}
"""The package, help, what is said of a key, and flights: one after the other, with what none of
them needs so far.
"""


@pytest.mark.slow
@pytest.mark.usefixtures("x8_design")
def test_what_is_not_needed_is_not_imported():
    code = ["import sys"]
    for step, heavy in STEPS.items():
        code += [step, f"if found := sorted({heavy} & set(sys.modules)): sys.exit(f'{{found}}')"]
    command = [sys.executable, "-c", "\n".join(code)]
    found = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert (found.returncode, found.stderr) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["sweep_mu"], ["unknown scenario 'sweep_mu'"]),
        (["sweep_nu", "--set", "keepout.radius=5"], ["unknown key 'keepout.radius'"]),
        (
            ["sweep_nu", "--set", "guidance.airspeed_mps=60"],
            ["guidance.airspeed_mps is 60", "Skywalker X8 flies 15.0 to 25.0 m/s"],
        ),
        (["sweep_nu", "--set", "aircraft=t37"], ["unknown aircraft 't37'", "did you mean 'T37'"]),
        (
            ["sweep_nu", "--set", "guidance.law=own.py:Law"],
            ["guidance.law: ", "there is no such file"],
        ),
        (["sweep_nu", "--resume"], ["--resume needs --out"]),
        (["sweep_nu", "--scheduler", "tcp://127.0.0.1:1"], ["add --executor dask"]),
        (["sweep_nu", "--executor", "slurm"], ["--executor", "'slurm'", "'local', 'dask'"]),
    ],
)
def test_bad_input_is_one_line_and_exit_status_2(arguments, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert_refused(run_command("scenarios.run", *arguments), *words)
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_is_resumed_with_other_keys_says_which_with_both_values(tmp_path):
    keys = ("flight.crossings=2", "comparison.variants=[]", "fidelity=kinematic", "sweep.nu=[0.5]")

    def resumed(*changes):
        return run_here("sweep_nu", *keys, *changes, out=tmp_path / "run", more=["--resume"])

    run_here("sweep_nu", *keys, out=tmp_path / "run", more=["--jobs", "1"])
    changed = ["keepout.radius_m=190", "start.aspect_deg=20.0"]
    words = ("another configuration: ", "keepout.radius_m was 200.0, and is 190.0 now")
    assert_refused(
        resumed(*changed), *words, "start.aspect_deg was not set, and is 20.0 now; resume"
    )
    many = resumed(*changed, "seed=7", "guidance.bank_deg=40", "guidance.reserve=0.1")
    assert_refused(many, "; and 2 more; resume it")


def test_flights_that_miss_a_criterion_or_cannot_be_flown_are_exit_status_1(tmp_path):
    keys = ("flight.crossings=2", "comparison.variants=[]", "fidelity=kinematic")
    strict = ("sweep.nu=[0.5, 1.0]", "criteria.tracking_error_rms_m=1e-4")
    result = run_here("sweep_nu", *keys, *strict, out=tmp_path / "run", more=["--jobs", "1"])
    assert result.status == 1
    assert "must be below 1" in result.out
    summary = pd.read_csv(tmp_path / "run" / "summary.csv")
    assert list(summary["outcome"]) == ["completed", "infeasible"]
    counts = read_verdict(tmp_path / "run" / "verdict.json").counts
    assert (counts.outcomes["infeasible"], counts.unknown, counts.passed) == (1, 1, 0)


def run_apart(arguments, errors):
    """Run a command in the process that this is, in a new group, with its errors in a file."""
    os.setsid()
    # Also where pytest itself was started to ignore it, as a script does behind ``&``.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.argv = ["scenarios.run", *map(str, arguments)]
    with (
        errors.open("w", encoding="utf-8") as sys.stderr,
        Path(os.devnull).open("w", encoding="utf-8") as sys.stdout,
    ):
        main()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "end"),
    # What a terminal does at Ctrl-C, and what a scheduler does of jobs.
    [(signal.SIGINT, os.killpg), (signal.SIGTERM, os.kill)],
)
def test_an_interrupted_run_keeps_what_is_done_and_can_be_resumed(tmp_path, number, end):
    # Flights enough that some are left when the interrupt comes: each takes a tenth of a second.
    (tmp_path / "short.toml").write_text(short_trial(flights=90, duration=120.0), "utf-8")
    out, errors = tmp_path / "run", tmp_path / "errors"
    words = [tmp_path / "short.toml", "--jobs", "1", "--no-report", "--out", out]
    context = multiprocessing.get_context("fork")
    process = context.Process(target=run_apart, args=(words, errors))
    process.start()
    # A time history is there just before its flight is done: once there are two, the first flight
    # is.
    while len(list((out / "flights").glob("*.parquet"))) < 2:
        assert process.exitcode is None
        time.sleep(0.01)
    end(process.pid, number)
    process.join(60)
    process.kill()  # where it has not ended
    assert process.exitcode == 130
    said = errors.read_text(encoding="utf-8")
    assert "Traceback" not in said
    assert manifest_of(out)["state"] == "interrupted"
    assert 1 <= (done := len(pd.read_csv(out / "summary.csv"))) < 90
    assert f"{done} of 90 flights are done and kept, {90 - done} " in said
    assert "--resume" in said


NO_HOME = """
import pwd, runpy, sys
def unknown(_):
    raise KeyError("no such user")
pwd.getpwuid = unknown
sys.argv = sys.argv[1:]
runpy.run_module("scenarios.run", run_name="__main__")
"""


@pytest.mark.slow
def test_no_home_and_a_terminal_with_ascii_alone_are_enough(tmp_path):
    (tmp_path / "é.toml").write_text(short_trial(flights=2, duration=5.0), encoding="utf-8")
    homes = ("HOME", "XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR")
    environment = {name: value for name, value in os.environ.items() if name not in homes}
    environment |= {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "ascii"}
    words = ["run", "é.toml", "--no-report", "--out", "run", "--jobs", "1"]
    how = {"cwd": tmp_path, "env": environment, "capture_output": True, "text": True, "timeout": 60}
    ended = subprocess.run([sys.executable, "-c", NO_HOME, *words], check=False, **how)
    assert ended.returncode == 0, ended.stderr
    assert "\\xe9_00000: " in ended.stdout
