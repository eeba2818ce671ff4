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

FLIGHTS = 40


def fly(path, out, reports=None):
    """Fly or resume the trial, in a new process group; report every flight."""
    if reports is not None:
        os.setpgrp()

    def progress(doing, *_):
        if doing == "flying" and reports is not None:
            reports.send(None)

    resume = (out / "manifest.json").is_file()
    how = {"executor_factory": ExecutorFactory(jobs=2), "resume": resume, "progress": progress}
    run_study(load_study(str(path)), path.stem, out, **how)


def await_reports(reports, count):
    """Wait until so many flights are reported, or the run has ended."""
    with contextlib.suppress(EOFError):
        for _ in range(count):
            if reports.poll(60.0):
                reports.recv()


def wall_times(out):
    """Return how long each flight in the journal took: it changes where a flight is repeated."""
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


def kill_parent(pid):
    os.kill(pid, signal.SIGKILL)


def kill_all(pid):
    try:
        os.killpg(pid, signal.SIGKILL)
    except ProcessLookupError:
        os.kill(pid, signal.SIGKILL)  # It has no process group yet.


def alive_in(group):
    """Return the processes of a group that have not ended."""
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


def test_killed_at_six_random_moments_it_ends_as_if_nothing_had_happened(tmp_path):
    trial, undisturbed, out = (tmp_path / name for name in ("short.toml", "whole", "run"))
    text = short_trial(flights=FLIGHTS, duration=5.0, histories=10, rate=5.0)
    trial.write_text(text, encoding="utf-8")
    fly(trial, undisturbed)
    random = np.random.default_rng(20261121)
    context = multiprocessing.get_context("fork")
    done: list[dict] = []
    for number in range(6):
        kill = (kill_parent, kill_all)[number % 2]
        ours, theirs = context.Pipe(duplex=False)
        process = context.Process(target=fly, args=(trial, out, theirs))
        process.start()
        theirs.close()
        # A third of the kills come in the first 50 ms, before anything or just as the run begins;
        # the others in the middle of flights, tables and files, however long it takes to get there.
        if number >= 2:
            await_reports(ours, int(random.integers(1, 10)))
        time.sleep(random.uniform(0.0, 0.05 if number < 2 else 0.02))
        kill(process.pid)
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
    for table in ("summary.csv", "crossings.csv", "draws.csv"):
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
        first, second = (run / "flights" / name for run in (undisturbed, out))
        assert first.read_bytes() == second.read_bytes()
    assert {path.name for path in out.iterdir()} == {path.name for path in undisturbed.iterdir()}
