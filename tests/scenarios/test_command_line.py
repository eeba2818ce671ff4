"""The commands as a user types them: in a process of their own where that is tested, else in this
one, which has imported all.
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
from tests.run_tables import manifest_of

ROOT = Path(__file__).parents[2]
SHORT = ["--set", "flight.crossings=2", "--set", "comparison.variants=[]", "--no-report"]


@pytest.fixture
def run_here(monkeypatch, capsys):
    """Return a function that runs a command without a process: parsing, messages and exit status
    are the same.
    """

    def run_here(*arguments):
        monkeypatch.setattr(sys, "argv", ["scenarios.run", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        out, err = capsys.readouterr()
        return subprocess.CompletedProcess(arguments, ended.value.code, out, err)

    return run_here


def run_apart(arguments, errors):
    """Run a command in the process that this is, in a group of its own; what it says of errors goes
    into a file.
    """
    os.setsid()
    # Also where pytest itself was started to ignore it, as a script does behind ``&``.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.argv = ["scenarios.run", *map(str, arguments)]
    with (
        errors.open("w", encoding="utf-8") as sys.stderr,
        Path(os.devnull).open("w", encoding="utf-8") as sys.stdout,
    ):
        main()


def assert_refused(result, *words):
    assert result.returncode == 2
    assert result.stderr.startswith("error: ")
    assert result.stderr.count("\n") == 1
    for word in words:
        assert word in result.stderr


HEAVY = {"scipy", "pandas", "control", "matplotlib", "typst"}
DESIGNING = {"control", "slycot", "matplotlib", "scipy.signal", "plotly", "jinja2", "typst"}
"""What designs an autopilot, evaluates readings and writes reports."""
FLIGHTS = """
from scenarios import fly
for fidelity in ("kinematic", "six_dof"):
    fly("sweep_nu", nu=0.5, fidelity=fidelity, **{"flight.duration_max_s": 5.0})
"""
"""Flights of both vehicles, the autopilot of one of them in the cache."""


STEPS = {
    "import scenarios.run, innerloop.design, reports.build": HEAVY
    | {"numpy", "jsbsim", "plotly", "pydantic"},
    "from scenarios.cli.describe import described; described('payload.sensor')": HEAVY,
    FLIGHTS: DESIGNING,
}
"""What help needs, what is said of a key, and flights: one after the other, with what none of them
needs so far.
"""


@pytest.mark.slow
@pytest.mark.usefixtures("x8_design")
def test_what_is_not_needed_is_not_imported():
    unneeded = "if found := sorted({!r} & set(sys.modules)): sys.exit({!r} + ' imports ' + ', '.join(found))"
    code = [
        "import sys",
        *(line for step, heavy in STEPS.items() for line in (step, unneeded.format(heavy, step))),
    ]
    found = subprocess.run(
        [sys.executable, "-c", "\n".join(code)],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.stderr == ""
    assert found.returncode == 0


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
            ["sweep_nu", "--set", "start.distance_m=[100, 150]"],
            ["begins at 100 m", "must exceed keepout.radius_m, 200 m"],
        ),
        (
            ["sweep_nu", "--set", "guidance.law=own.py:Law"],
            [
                "guidance.law: ",
                "own.py: there is no such file",
                "relative to the current directory",
            ],
        ),
        (["sweep_nu", "--resume"], ["--resume needs --out"]),
        (
            ["sweep_nu", "--scheduler", "tcp://127.0.0.1:1"],
            ["--scheduler is tcp://127.0.0.1:1", "add --executor dask"],
        ),
        (["sweep_nu", "--executor", "slurm"], ["--executor", "'slurm'", "'local', 'dask'"]),
    ],
)
def test_bad_input_is_one_line_and_exit_status_2(arguments, words, tmp_path, run_here, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert_refused(run_here(*arguments), *words)
    assert list(tmp_path.iterdir()) == []


def test_a_run_that_is_resumed_with_other_keys_says_which_with_both_values(tmp_path, run_here):
    sweep = ["sweep_nu", "--out", tmp_path / "run", "--jobs", "1", *SHORT]
    sweep += ["--set", "fidelity=kinematic", "--set", "sweep.nu=[0.5]"]

    def resumed(*changes):
        return run_here(
            *sweep, "--resume", *(word for change in changes for word in ("--set", change))
        )

    run_here(*sweep)
    assert_refused(
        resumed("seed=7"),
        "another configuration: seed was ",
        ", and is 7 now; resume it with the same scenario",
    )
    both = resumed("keepout.radius_m=190", "start.aspect_deg=20.0")
    assert_refused(
        both,
        "keepout.radius_m was 200.0, and is 190.0 now",
        "start.aspect_deg was not set, and is 20.0 now; resume",
    )
    many = resumed(
        "seed=7",
        "keepout.radius_m=190",
        "start.aspect_deg=20.0",
        "guidance.bank_deg=40",
        "guidance.reserve=0.1",
    )
    assert_refused(many, "; and 2 more; resume it")


def test_flights_that_miss_a_criterion_or_cannot_be_flown_are_exit_status_1(tmp_path, run_here):
    out = tmp_path / "run"
    result = run_here(
        "sweep_nu",
        "--out",
        out,
        *SHORT,
        "--set",
        "sweep.nu=[0.5, 1.0]",
        "--set",
        "criteria.tracking_error_rms_m=0.001",
    )
    assert result.returncode == 1
    assert "must be below 1" in result.stdout
    summary = pd.read_csv(out / "summary.csv")
    assert list(summary["outcome"]) == ["completed", "infeasible"]
    counts = read_verdict(out / "verdict.json").counts
    assert (counts.outcomes["infeasible"], counts.unknown, counts.passed) == (1, 1, 0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "end"),
    # What a terminal does at Ctrl-C, and what a scheduler does of jobs.
    [(signal.SIGINT, os.killpg), (signal.SIGTERM, os.kill)],
)
def test_an_interrupted_run_keeps_what_is_done_and_resumes_to_the_same_result(
    tmp_path, run_here, number, end
):
    # Two crossings are too few for means over them.
    settings = ["sweep_nu", *SHORT, "--jobs", "1", "--set", "criteria.crossing_interval_error=0.1"]
    settings += ["--set", "criteria.tracking_error_rms_m=5.0"]
    # Flights enough that some are left when the interrupt comes: each takes a tenth of a second.
    nus = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
    settings += [
        "--set",
        "fidelity=kinematic",
        "--set",
        "guidance.rate_hz=10",
        "--set",
        f"sweep.nu={nus}",
    ]
    whole, broken = tmp_path / "whole", tmp_path / "broken"
    ended = run_here(*settings, "--out", whole)
    assert ended.returncode == 0
    assert ended.stdout.startswith(f"flights to fly: {len(nus)}\n")
    arguments = [*settings, "--out", broken]
    process = multiprocessing.get_context("fork").Process(
        target=run_apart, args=(arguments, tmp_path / "errors")
    )
    process.start()
    # A time history is there just before its flight is done: once there are two, the first flight
    # is.
    while len(list((broken / "flights").glob("*.parquet"))) < 2:
        assert process.exitcode is None
        time.sleep(0.01)
    end(process.pid, number)
    process.join(60)
    process.kill()  # where it has not ended
    assert process.exitcode == 130
    errors = (tmp_path / "errors").read_text(encoding="utf-8")
    assert "Traceback" not in errors
    assert "--resume" in errors
    assert manifest_of(broken)["state"] == "interrupted"
    kept = pd.read_csv(broken / "summary.csv")
    assert 1 <= (done := len(kept)) < len(nus)
    assert f"{done} of {len(nus)} flights are done and kept, {len(nus) - done} " in errors
    resumed = run_here(*settings, "--out", broken, "--resume")
    assert resumed.returncode == 0, resumed.stderr
    assert f"flights left to fly: {len(nus) - done} of {len(nus)}; {done} " in resumed.stdout
    columns = [name for name in kept.columns if name != "wall_time_s"]
    pd.testing.assert_frame_equal(
        pd.read_csv(broken / "summary.csv")[columns],
        pd.read_csv(whole / "summary.csv")[columns],
        check_exact=True,
    )
    assert (broken / "crossings.csv").read_bytes() == (whole / "crossings.csv").read_bytes()
