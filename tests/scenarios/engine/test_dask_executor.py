"""A real Dask scheduler and two worker processes on loopback."""

import contextlib
import importlib
import multiprocessing
import os
import signal
import socket
import sys
import warnings

import pandas as pd
import pytest

from scenarios.engine.runner import ExecutorFactory
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study

pytestmark = pytest.mark.slow

SETTINGS = [
    "flights=6",
    "histories=4",
    "flight.duration_max_s=5.0",
    "criteria.settles=false",
    "criteria.required=keep_out",
]
"""The X8 in JSBSim, so that its model has to reach the workers too."""


def free_port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        return listener.getsockname()[1]


def serve(main, words, cwd):
    """Run a command of Dask's in a new group, without output."""
    os.setsid()
    os.chdir(cwd)
    warnings.simplefilter("ignore")
    silence = os.open(os.devnull, os.O_WRONLY)
    for stream in (sys.stdout, sys.stderr):
        stream.flush()
    os.dup2(silence, 1)
    os.dup2(silence, 2)
    main(words)


@contextlib.contextmanager
def dask(command, *words, cwd):
    """Run a command of Dask's in a process that has imported all, and end its group."""
    main = importlib.import_module(f"distributed.cli.{command}").main
    process = multiprocessing.get_context("fork").Process(target=serve, args=(main, words, cwd))
    process.start()
    try:
        yield process
    finally:
        process.kill()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.join()


def fly(out, *, progress=lambda *_: None, **executors):
    return run_study(
        load_study("sea_wind", SETTINGS),
        "sea_wind",
        out,
        executor_factory=ExecutorFactory(**executors),
        progress=progress,
    )


def test_a_study_that_loses_a_worker_in_the_middle_has_the_rows_of_a_local_one(tmp_path):
    assert fly(tmp_path / "local", jobs=1).all_met
    host, port = "127.0.0.1", str(free_port())
    address = f"tcp://{host}:{port}"
    worker = ("dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny")
    with (
        dask("dask_scheduler", "--host", host, "--port", port, "--no-dashboard", cwd=tmp_path),
        dask(*worker, cwd=tmp_path) as first,
        dask(*worker, cwd=tmp_path),
    ):
        killed = []

        def kill_in_the_middle(doing, done, _):
            if done == 2 and not killed:
                killed.append(done)
                os.killpg(first.pid, signal.SIGKILL)

        result = fly(
            tmp_path / "dask", executor="dask", scheduler=address, progress=kill_in_the_middle
        )
    assert killed == [2]
    assert result.all_met
    for table in ("summary.csv", "crossings.csv", "draws.csv"):
        local, remote = (
            pd.read_csv(tmp_path / run / table).drop(columns="wall_time_s", errors="ignore")
            for run in ("local", "dask")
        )
        pd.testing.assert_frame_equal(local, remote, check_exact=True)
    for path in sorted((tmp_path / "local" / "flights").iterdir()):
        assert (tmp_path / "dask" / "flights" / path.name).read_bytes() == path.read_bytes()
