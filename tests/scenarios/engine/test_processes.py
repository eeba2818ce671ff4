"""Processes that are killed, hang, run out of memory: every task ends as a result, and no other is
touched.
"""

import functools
import itertools
import multiprocessing
import os
import signal
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest
from engine_cases import TABLE, Squares, begun, workers

from scenarios.engine.processes import MAX_ATTEMPTS, LocalExecutor
from scenarios.engine.task import Limits, Task

LONG = 60.0
"""What nobody waits for [s]."""


def fly(work, numbers, *, jobs=2, limits=None):
    """Return the results of tasks, in their order, whoever was first."""
    with LocalExecutor(work, jobs=jobs, limits=limits or Limits()) as executor:
        results = list(executor.fly(Task(number=i) for i in numbers))
    return sorted(results, key=lambda result: result.task.number)


def killed():
    os.kill(os.getpid(), signal.SIGKILL)


def once(path, how):
    """Do something at the first try alone."""
    if not path.exists():
        path.touch()
        how()


def assert_lost(result, *words):
    assert result.lost
    (row,) = result.tables[TABLE]
    for word in (f"{MAX_ATTEMPTS} processes that flew it were lost", *words):
        assert word in row["reason"]


def assert_done(results, numbers):
    """Assert that tasks were done, each once, and as if nothing had happened to others."""
    found = {result.task.number: result for result in results}
    for number in numbers:
        assert not found[number].lost
        assert found[number].tables[TABLE][0]["square"] == number**2
    assert len(found) == len(results)


def memory():
    """Return what this process has of what is limited [bytes]."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    return 1024 * int(
        next(line.split()[1] for line in status.splitlines() if line.startswith("VmData"))
    )


def test_every_task_is_done_once_with_the_same_result_for_any_number_of_processes(tmp_path):
    # A few milliseconds each, so that none is through with all before another has begun.
    pause = dict.fromkeys(range(6), functools.partial(time.sleep, 0.005))
    found = []
    for jobs in (1, 7):
        (marks := tmp_path / str(jobs)).mkdir()
        found.append(fly(Squares(marks=marks, does=pause), range(6), jobs=jobs))
        assert [begun(marks, number) for number in range(6)] == [1] * 6
        assert os.getpid() not in workers(marks)
        assert 1 <= len(workers(marks)) <= min(jobs, 6)
        assert not multiprocessing.active_children()
    assert found[0] == found[1]


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_process_that_ends_costs_a_try_and_its_neighbours_nothing(jobs, tmp_path, capfd):
    def fails():
        raise RuntimeError("work is to make a row of this")

    does = {1: functools.partial(once, tmp_path / "killed", killed), 3: killed, 6: fails}
    results = fly(Squares(marks=tmp_path, does=does), range(8), jobs=jobs)
    assert_lost(results[3], "the last one was ended by SIGKILL")
    assert_lost(results[6], "ended with status 1")
    assert_done(results, {*range(8)} - {3, 6})
    assert "work is to make a row of this" in capfd.readouterr().err
    tries = [1, 2, 1, MAX_ATTEMPTS, 1, 1, MAX_ATTEMPTS, 1]
    assert [begun(tmp_path, number) for number in range(8)] == tries


@pytest.mark.slow
@pytest.mark.skipif(
    sys.platform != "linux", reason="other systems do not hold a process to its limit of data"
)
def test_a_task_that_runs_out_of_memory_is_lost_and_says_why(tmp_path):
    limit = memory() + 2**28
    # Four times what is left: refused at once, so that nothing of it is ever there.
    results = fly(
        Squares(marks=tmp_path, does={2: functools.partial(bytearray, 2**30)}),
        range(6),
        limits=Limits(memory=limit),
    )
    assert_lost(results[2], f"ran out of memory; its limit is {limit / 2**20:.0f} MiB")
    assert_done(results, {*range(6)} - {2})
    assert begun(tmp_path, 2) == MAX_ATTEMPTS


def test_an_interrupt_ends_processes_at_once(tmp_path):
    work = Squares(
        marks=tmp_path, does=dict.fromkeys(range(1, 9), functools.partial(time.sleep, LONG))
    )

    def interrupted():
        with LocalExecutor(work, jobs=2, limits=Limits()) as executor:
            for _ in executor.fly(Task(number=i) for i in range(9)):
                raise KeyboardInterrupt

    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert time.monotonic() - began < LONG / 2
    assert not multiprocessing.active_children()


@dataclass(frozen=True, kw_only=True)
class Slow(Squares):
    """Squares that take a moment, and from the fifth on another time [s]."""

    later: float

    def run(self, task):
        time.sleep(0.05)
        result = super().run(task)
        time.sleep(self.later if task.number > 3 else 0.0)
        return result


def command(marks, pause, later, reports):
    """Do tasks without end, tell when the fourth is done, then pause [s]."""
    with LocalExecutor(Slow(marks=marks, later=later), jobs=2, limits=Limits()) as executor:
        for result in executor.fly(Task(number=i) for i in itertools.count()):
            if result.task.number == 3:
                reports.send("flying")
                time.sleep(pause)


@pytest.mark.parametrize(
    ("pause", "later"),
    [(LONG, 0.0), (0.0, 10.0 * LONG)],
    ids=["idle", "in a long flight"],
)
def test_processes_whose_parent_is_killed_end_by_themselves(pause, later, tmp_path):
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)
    parent = context.Process(target=command, args=(tmp_path, pause, later, theirs))
    parent.start()
    theirs.close()
    assert ours.recv() == "flying"
    time.sleep(0.2)  # Those that are to be idle have done what they were given.
    parent.kill()
    parent.join()
    # They have their parent's end of the pipe: it is closed once the last of them has ended.
    if not ours.poll(20.0):
        for pid in workers(tmp_path):
            os.kill(pid, signal.SIGKILL)
        pytest.fail("processes outlived their parent")
    with pytest.raises(EOFError):
        ours.recv()
    assert len(workers(tmp_path)) == 2
