"""Work and a study of a few milliseconds, whose tasks do what a test wants of them."""

import os
import uuid
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from common.verdict import RunVerdict
from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.run_directory import fingerprint
from scenarios.engine.runner import ExecutorFactory, StudySummary, fly_study, write_tables
from scenarios.engine.task import Result, Task

TABLE = "rows.csv"
COLUMNS = ("number", "square", "reason")


@dataclass(frozen=True, kw_only=True)
class Squares:
    """Squares the numbers of its tasks; each task that is begun leaves a file in ``marks``, and may
    first do something.
    """

    marks: Path
    does: Mapping[int, Callable[[], object]] = field(default_factory=dict)
    model: Path | None = None

    def moved(self, _):
        return self

    def run(self, task):
        (self.marks / f"{task.number}-{os.getpid()}-{uuid.uuid4().hex}").touch()
        if task.number in self.does:
            self.does[task.number]()
        row = {"number": task.number, "square": float(task.number**2)}
        files = {f"files/{task.number}.txt": b"flown"}
        return Result(task=task, tables={TABLE: [row]}, files=files)

    def lost(self, task, reason):
        return Result(
            task=task, tables={TABLE: [{"number": task.number, "reason": reason}]}, lost=True
        )


def begun(marks, number):
    """Return how often a task was begun."""
    return len(list(marks.glob(f"{number}-*")))


def workers(marks):
    """Return the processes in which tasks were begun."""
    return {int(mark.name.split("-")[1]) for mark in marks.iterdir()}


class SquareStudy:
    """Squares eight numbers."""

    what = "squares"
    planned, comparisons = 8, 0

    def __init__(self, work, config_hash="a"):
        self._work, self.config_hash = work, config_hash

    def initial_manifest(self):
        return {"config_hash": self.config_hash, "fingerprint": fingerprint()}

    def work(self, _run):
        return self._work

    def run(self, fly, _run, _journal):
        fly(Task(number=i) for i in range(self.planned))

    def postprocess(self, _run, _journal, progress):
        progress("finishing", self.planned, self.planned)

    def export(self, run, journal):
        write_tables(run, journal, {TABLE: COLUMNS})

    def summary(self, journal):
        done = journal.items()
        verdict = RunVerdict.of_items(self.what, planned=self.planned, done=done, met=done)
        return StudySummary(verdict=verdict, lines=[], manifest={"squares_done": done})


def fly(study, out, *, resume=False, jobs=0, progress=lambda *_: None):
    """Fly a study in as many processes, or in this one."""
    factory = ExecutorFactory(jobs=jobs) if jobs else InProcessExecutor
    return fly_study(study, out, executor_factory=factory, resume=resume, progress=progress)


def interrupt_at(count):
    def progress(doing, done, total):
        if doing == "flying" and done == count:
            raise KeyboardInterrupt

    return progress
