"""A study that is killed, again and again, and goes on: its result is that of one that was left
alone.
"""

import contextlib
import json
import multiprocessing
import os
import signal
import sqlite3
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.runner import ExecutorFactory
from scenarios.scenario.files import load_study
from scenarios.studies.base import run_study
from tests.scenarios.short_trial import short_trial

pytestmark = pytest.mark.slow

FLIGHTS = 60

TRIAL = short_trial(flights=FLIGHTS, duration=5.0, histories=10, rate=5.0)


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    path = tmp_path_factory.mktemp("trial") / "short.toml"
    path.write_text(TRIAL, encoding="utf-8")
    return path


def fly(path, out, reports=None):
    """Fly the trial, or go on with it; in a process group of its own, which can be killed as one.
    Report every flight.
    """
    if reports is not None:
        os.setpgrp()

    def progress(doing, *_):
        if doing == "flying" and reports is not None:
            reports.send(None)

    resume = (out / "manifest.json").is_file()
    executor_factory = ExecutorFactory(jobs=2)
    run_study(
        load_study(str(path)),
        path.stem,
        out,
        executor_factory=executor_factory,
        resume=resume,
        progress=progress,
    )


def await_reports(reports, count):
    """Wait until so many flights are reported, or the run has ended."""
    with contextlib.suppress(EOFError):
        for _ in range(count):
            if reports.poll(60.0):
                reports.recv()


@pytest.fixture(scope="module")
def undisturbed(trial, tmp_path_factory):
    out = tmp_path_factory.mktemp("runs") / "whole"
    fly(trial, out)
    return out


def wall_times(out):
    """Return how long each flight in the journal took: a flight that is flown again takes another
    time.
    """
    if not (out / "journal.sqlite").is_file():
        return {}
    database = sqlite3.connect(out / "journal.sqlite")
    try:
        found = database.execute("SELECT number, tables FROM results").fetchall()
    except sqlite3.OperationalError:
        return {}  # killed before there was a table
    finally:
        database.close()
    return {number: json.loads(tables)["summary.csv"][0]["wall_time_s"] for number, tables in found}


def children(pid):
    """Return the processes that a process has started."""
    try:
        return [
            int(child)
            for child in Path(f"/proc/{pid}/task/{pid}/children")
            .read_text(encoding="ascii")
            .split()
        ]
    except OSError:
        return []


def kill_parent(pid, _random):
    os.kill(pid, signal.SIGKILL)


def kill_a_worker(pid, random):
    """Kill a worker if there is one, and its parent a moment later, in the middle of having noticed
    it or not.
    """
    for worker in children(pid)[:1]:
        with contextlib.suppress(ProcessLookupError):
            os.kill(worker, signal.SIGKILL)
        time.sleep(random.uniform(0.0, 0.1))
    os.kill(pid, signal.SIGKILL)


def kill_all(pid, _random):
    try:
        os.killpg(pid, signal.SIGKILL)
    except ProcessLookupError:
        os.kill(pid, signal.SIGKILL)  # It has no group of its own yet.


def alive_in(group):
    """Return the processes of a group that live; those that have ended and are not collected yet do
    not.
    """
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            _, _, rest = path.read_text(encoding="utf-8", errors="replace").rpartition(")")
            state, _, its_group, *_ = rest.split()
            if int(its_group) == group and state not in "ZX":
                found.append(int(path.parent.name))
    return found


def assert_nobody_is_left(group):
    """Assert that no process of a group outlives the one that was killed."""
    for _ in range(500):
        if not alive_in(group):
            return
        time.sleep(0.01)
    os.killpg(group, signal.SIGKILL)
    pytest.fail("processes outlived their parent")


def test_killed_at_nine_random_moments_it_ends_as_if_nothing_had_happened(
    trial, undisturbed, tmp_path
):
    out, random = tmp_path / "run", np.random.default_rng(20261121)
    context = multiprocessing.get_context("fork")
    done: list[dict] = []
    for number in range(9):
        kill = (kill_parent, kill_a_worker, kill_all)[number % 3]
        ours, theirs = context.Pipe(duplex=False)
        process = context.Process(target=fly, args=(trial, out, theirs))
        process.start()
        theirs.close()
        # A third of the kills come in the first 50 ms, before anything or just as the run begins;
        # the others in the middle of flights, tables and files, however long it takes to get there.
        if number >= 3:
            await_reports(ours, int(random.integers(1, 10)))
        time.sleep(random.uniform(0.0, 0.05 if number < 3 else 0.02))
        kill(process.pid, random)
        process.join()
        # It was killed, or it had ended as it should.
        assert process.exitcode in (-signal.SIGKILL, 0)
        assert_nobody_is_left(process.pid)
        done.append(wall_times(out))
    fly(trial, out)
    final = wall_times(out)
    # The moments were such that there was something to lose and something to do.
    assert any(0 < len(flights) < FLIGHTS for flights in done)
    for flights in done:
        assert flights.items() <= final.items()
    for table in ("summary.csv", "crossings.csv", "interventions.csv", "draws.csv"):
        whole, pieced = (
            pd.read_csv(run / table).drop(columns="wall_time_s", errors="ignore")
            for run in (undisturbed, out)
        )
        pd.testing.assert_frame_equal(whole, pieced, check_exact=True)
    names = sorted(path.name for path in (undisturbed / "flights").iterdir())
    # An even sample of ten; and the closest and the median flight, where they are not among them.
    assert 10 <= len(names) <= 13
    assert sorted(path.name for path in (out / "flights").iterdir()) == names
    for name in names:
        assert (out / "flights" / name).read_bytes() == (
            undisturbed / "flights" / name
        ).read_bytes()
    # Nor is anything left lying about.
    assert sorted(path.name for path in out.iterdir()) == sorted(
        path.name for path in undisturbed.iterdir()
    )
