"""The interface of a study, and its execution with an executor, a journal and a run directory."""

import errno
import sqlite3
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from common.files import write_whole
from scenarios.engine.executor import Executor
from scenarios.engine.executors import ExecutorFactory
from scenarios.engine.journal import Journal, is_damaged, is_full
from scenarios.engine.memory import peak_memory
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.task import Task, Work
from scenarios.errors import InputError

Progress = Callable[[str, int, int], None]
"""Called with the current activity, the number of items that are done and the total number of items."""

Fly = Callable[[Iterable[Task]], None]
"""Executes tasks and returns when their results are in the journal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StudySummary:
    """The result of a study so far.

    Attributes
    ----------
    done : number of items that are done
    met : whether all planned items are done and met their criteria
    lines : the result in lines of text, for the console
    manifest : entries for the manifest of the run
    """

    done: int
    met: bool
    lines: list[str]
    manifest: dict[str, Any]


class Study(Protocol):
    """A set of tasks, the work to be done on each, and the evaluation of their results.

    Attributes
    ----------
    what : name of the items that the study counts, in the plural, such as "flights"
    config_hash : hash of the configuration that results depend on
    """

    what: str
    config_hash: str

    @property
    def planned(self) -> int:
        """Return the largest possible number of items."""

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest as written before the first task."""

    def work(self, run: RunDirectory) -> Work:
        """Return the work, after writing the files that it needs into the run directory."""

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Execute tasks, in one or several calls of ``fly``: their results are in the journal when it returns.

        Tasks whose results are in the journal are skipped, unless they are ``recorded``: those are repeated for their
        files.
        """

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write the files of the run beside its tables, when every task is done."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables of the results so far."""

    def summary(self, journal: Journal) -> StudySummary:
        """Return the result so far."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """The outcome of a run.

    Attributes
    ----------
    directory : the run directory
    what, planned : name and planned number of the items that the study counts
    summary : the result of the study
    interrupted : whether the run was interrupted before every task was done
    """

    directory: Path
    what: str
    planned: int
    summary: StudySummary
    interrupted: bool

    @property
    def all_met(self) -> bool:
        """Whether every planned item is done and met its criteria."""
        return self.summary.met and not self.interrupted


def fly_study(study: Study, directory: Path, *, executor_factory: ExecutorFactory, resume: bool, progress: Progress) -> RunResult:
    """Fly a study, or the unfinished part of it, into a run directory.

    Parameters
    ----------
    study : the study
    directory : the run directory
    executor_factory : makes the executor
    resume : continue the unfinished run in ``directory``
    progress : called as the study advances

    Raises
    ------
    InputError : the directory cannot be used, or the disk is full; finished results are kept
    """
    run = RunDirectory(directory)
    run.open(study.config_hash, resume=resume)
    try:
        journal = Journal(run.journal)
        run.sweep()
        try:
            return _fly(study, run, journal, executor_factory, progress)
        finally:
            journal.close()
    except (OSError, sqlite3.DatabaseError) as error:
        raise _explained(error, run) from None


def _fly(study: Study, run: RunDirectory, journal: Journal, executor_factory: ExecutorFactory, progress: Progress) -> RunResult:
    manifest = study.initial_manifest()
    run.write_json(run.manifest, manifest | {"state": "running"})
    began = time.perf_counter()
    interrupted = False
    try:
        work = study.work(run)
        with executor_factory(work) as executor:
            study.run(_executing(study, run, journal, executor, progress), run, journal)
        study.postprocess(run, journal, progress)
    except KeyboardInterrupt:
        interrupted = True
    study.export(run, journal)
    summary = study.summary(journal)
    closing = {
        "state": "interrupted" if interrupted else "complete",
        "wall_time_s": time.perf_counter() - began,
        "peak_memory_mib": round(peak_memory() / 2**20, 1),
    }
    run.write_json(run.manifest, manifest | closing | summary.manifest)
    return RunResult(directory=run.path, what=study.what, planned=study.planned, summary=summary, interrupted=interrupted)


def _executing(study: Study, run: RunDirectory, journal: Journal, executor: Executor, progress: Progress) -> Fly:
    before, done = journal.done(), journal.items()
    progress("flying", done, study.planned)

    def fly(tasks: Iterable[Task]) -> None:
        nonlocal done
        for result in executor.fly(task for task in tasks if task.recorded or task.number not in before):
            # Files first: a result counts as done when it is in the journal.
            for name, content in result.files.items():
                run.write_bytes(name, content)
            if not result.task.recorded:
                journal.add(result)
                done += result.items
                progress("flying", done, study.planned)

    return fly


def write_tables(run: RunDirectory, journal: Journal, tables: Mapping[str, tuple[str, ...]]) -> None:
    """Write tables from the journal into the run directory; ``tables`` gives the columns of each file."""
    for name, columns in tables.items():

        def write(path: Path, name: str = name, columns: tuple[str, ...] = columns) -> None:
            with path.open("w", encoding="utf-8", newline="") as file:
                journal.export(name, columns, file)

        write_whole(run.path / name, write)


def _explained(error: OSError | sqlite3.DatabaseError, run: RunDirectory) -> Exception:
    """Return the error to raise for an error of the disk or of the journal."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT) if isinstance(error, OSError) else is_full(error)
    if full:
        return InputError(
            f"the disk of '{run.path}' is full; finished results are kept: free some space and continue with --resume"
        )
    if isinstance(error, sqlite3.DatabaseError) and is_damaged(error):
        return InputError(f"'{run.journal}' is damaged; start a new run in another --out")
    return error
