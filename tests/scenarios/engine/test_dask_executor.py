"""A real Dask scheduler and two worker processes on loopback."""

import contextlib
import importlib
import multiprocessing
import os
import signal
import socket
import sys
import warnings
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest

from scenarios.engine.dask_executor import _WorkPlugin
from scenarios.engine.runner import ExecutorFactory
from scenarios.errors import InputError
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
    """Be a command of Dask's, in a group of its own, which has nothing to say."""
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
    for table in ("summary.csv", "crossings.csv", "interventions.csv", "draws.csv"):
        local, remote = (
            pd.read_csv(tmp_path / run / table).drop(columns="wall_time_s", errors="ignore")
            for run in ("local", "dask")
        )
        pd.testing.assert_frame_equal(local, remote, check_exact=True)
    for path in sorted((tmp_path / "local" / "flights").iterdir()):
        assert (tmp_path / "dask" / "flights" / path.name).read_bytes() == path.read_bytes()


@dataclass
class Reading:
    """Work that returns what the file of its model says."""

    model: Path

    def moved(self, model):
        return Reading(model)

    def run(self, _task):
        return (self.model / "autopilot.xml").read_text(encoding="utf-8")


def test_runs_that_share_a_worker_keep_models_of_their_own_until_they_end(tmp_path):
    worker, plugins = SimpleNamespace(local_directory=str(tmp_path / "worker")), []
    for run in ("one", "two"):
        (tmp_path / run).mkdir()
        (tmp_path / run / "autopilot.xml").write_text(run, encoding="utf-8")
        plugins.append(_WorkPlugin(run, Reading(tmp_path / run), 100.0))
        plugins[-1].setup(worker)
    assert [plugin.run(None) for plugin in plugins] == ["one", "two"]
    plugins[0].teardown(worker)
    assert plugins[1].run(None) == "two"
    assert [path.name for path in (tmp_path / "worker").iterdir()] == ["two"]


def test_a_worker_without_the_program_is_named_in_one_line(monkeypatch):
    # As distributed hands back what a worker raised that cannot import the module of the function
    # that it is to run.
    raised = Exception("ModuleNotFoundError(\"No module named 'scenarios'\")")
    closed = []
    client = SimpleNamespace(
        wait_for_workers=lambda *_, **__: None,
        run=lambda _, *, on_error: {"tcp://127.0.0.1:1": raised} if on_error == "return" else {},
        close=lambda: closed.append(True),
    )
    monkeypatch.setattr(
        "scenarios.engine.dask_executor.distributed.Client", lambda *_, **__: client
    )
    executor = ExecutorFactory(executor="dask", scheduler="tcp://127.0.0.1:2")(Reading(Path()))
    words = r"Dask worker tcp://127\.0\.0\.1:1 cannot run this program \(ModuleNotFoundError.*\); install it there"
    with pytest.raises(InputError, match=words), executor:
        pass
    assert closed
