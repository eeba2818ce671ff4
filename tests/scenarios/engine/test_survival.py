"""A study that is killed, again and again, and goes on: its result is that of one that was left alone."""

import json
import multiprocessing
import os
import signal
import sqlite3
import time

import numpy as np
import pandas as pd
import pytest

from scenarios.engine.executors import ExecutorFactory
from scenarios.schema.load import load_study
from scenarios.studies.registry import run_study
from tests.scenarios.short_trial import short_trial

FLIGHTS = 120

TRIAL = short_trial(flights=FLIGHTS, duration=12.0, histories=10)


@pytest.fixture(scope="module")
def trial(tmp_path_factory):
    path = tmp_path_factory.mktemp("trial") / "short.toml"
    path.write_text(TRIAL, encoding="utf-8")
    return path


def fly(path, out):
    resume = (out / "manifest.json").is_file()
    run_study(load_study(str(path)), path.stem, out, executor_factory=ExecutorFactory(jobs=2), resume=resume)


@pytest.fixture(scope="module")
def undisturbed(trial, tmp_path_factory):
    out = tmp_path_factory.mktemp("runs") / "whole"
    fly(trial, out)
    return out


def wall_times(out):
    """Return how long each flight in the journal took: a flight that is flown again takes another time."""
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


def test_killed_at_ten_random_moments_it_ends_as_if_nothing_had_happened(trial, undisturbed, tmp_path):
    out, random = tmp_path / "run", np.random.default_rng(20261121)
    done: list[dict] = []
    for _ in range(10):
        process = multiprocessing.get_context("fork").Process(target=fly, args=(trial, out))
        process.start()
        # Some kills come before anything, some in the middle of a flight, a table or a file.
        time.sleep(random.uniform(0.0, 0.5))
        os.kill(process.pid, signal.SIGKILL)
        process.join()
        done.append(wall_times(out))
    fly(trial, out)
    final = wall_times(out)
    # The moments were such that there was something to lose and something to do.
    assert any(0 < len(flights) < FLIGHTS for flights in done)
    for flights in done:
        assert flights.items() <= final.items()
    for table in ("summary.csv", "crossings.csv", "interventions.csv", "draws.csv"):
        whole, pieced = (pd.read_csv(run / table).drop(columns="wall_time_s", errors="ignore") for run in (undisturbed, out))
        pd.testing.assert_frame_equal(whole, pieced, check_exact=True)
    names = sorted(path.name for path in (undisturbed / "flights").iterdir())
    # An even sample of ten; and the closest and the median flight, where they are not among them.
    assert 10 <= len(names) <= 12
    assert sorted(path.name for path in (out / "flights").iterdir()) == names
    for name in names:
        assert (out / "flights" / name).read_bytes() == (undisturbed / "flights" / name).read_bytes()
    # Nor is anything left lying about.
    assert sorted(path.name for path in out.iterdir()) == sorted(path.name for path in undisturbed.iterdir())
