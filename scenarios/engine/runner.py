"""What the engine needs to know of a study, and flying one into a run directory."""

import errno
import sqlite3
import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from common.files import write_whole
from scenarios.engine.executor import Crew
from scenarios.engine.journal import Journal, is_damaged, is_full
from scenarios.engine.memory import peak_memory
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.task import Task, Work
from scenarios.errors import InputError

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how many of what the study counts are done and how many there are."""

Hire = Callable[[Work], Crew]
"""Makes the crew for some work."""

Fly = Callable[[Iterable[Task]], None]
"""Has tasks flown."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """What a study has come to.

    Attributes
    ----------
    done : of what it counts
    met : whether everything planned is done and met what was asked
    lines : what happened, in lines of text
    manifest : what the run says of it
    """

    done: int
    met: bool
    lines: list[str]
    manifest: dict[str, Any]


class Study(Protocol):
    """Tasks, what is done with each, and what it comes to.

    Attributes
    ----------
    what : it counts, in the plural
    config_hash : of everything that results depend on
    """

    what: str
    config_hash: str

    @property
    def planned(self) -> int:
        """Return how many there are to be, at most."""

    def opening(self) -> dict[str, Any]:
        """Return what the manifest says before anything has been flown."""

    def work(self, run: RunDirectory) -> Work:
        """Return what is done with each task, with what it needs written into the run directory."""

    def conduct(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Have tasks flown, in one batch or in several: what ``fly`` was given is in the journal when it returns.

        What is in the journal already is not flown again. Tasks that are to be ``recorded`` are, for their files alone.
        """

    def finish(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write what the run holds beside its tables, once every task is done."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables of what is done so far."""

    def summary(self, journal: Journal) -> Summary:
        """Return what the study has come to so far."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """How a run ended.

    Attributes
    ----------
    directory : the run directory
    what, planned : what the study counts, and how many there were to be
    summary : what it came to
    interrupted : whether it was stopped before all was done
    """

    directory: Path
    what: str
    planned: int
    summary: Summary
    interrupted: bool

    @property
    def all_met(self) -> bool:
        """Whether everything was done, and met what was asked."""
        return self.summary.met and not self.interrupted


def fly_study(study: Study, directory: Path, *, hire: Hire, resume: bool, progress: Progress) -> RunResult:
    """Fly a study into a run directory, or what is left of it.

    Parameters
    ----------
    study : what to fly
    directory : the run directory
    hire : makes the crew
    resume : go on with the unfinished run in ``directory``
    progress : told what happens

    Raises
    ------
    InputError : a directory that cannot be used, or that has no room left: what is done is kept
    """
    run = RunDirectory(directory)
    run.open(study.config_hash, resume=resume)
    try:
        journal = Journal(run.journal)
        run.sweep()
        try:
            return _fly(study, run, journal, hire, progress)
        finally:
            journal.close()
    except (OSError, sqlite3.DatabaseError) as error:
        raise _explained(error, run) from None


def _fly(study: Study, run: RunDirectory, journal: Journal, hire: Hire, progress: Progress) -> RunResult:
    manifest = study.opening()
    run.write_json(run.manifest, manifest | {"state": "running"})
    began = time.perf_counter()
    interrupted = False
    try:
        work = study.work(run)
        with hire(work) as crew:
            study.conduct(_flying(study, run, journal, crew, progress), run, journal)
        study.finish(run, journal, progress)
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


def _flying(study: Study, run: RunDirectory, journal: Journal, crew: Crew, progress: Progress) -> Fly:
    before, done = journal.done(), journal.items()
    progress("flying", done, study.planned)

    def fly(tasks: Iterable[Task]) -> None:
        nonlocal done
        for result in crew.fly(task for task in tasks if task.recorded or task.number not in before):
            # A result counts as done once it is in the journal; its files are there by then.
            for name, content in result.files.items():
                run.write_bytes(name, content)
            if not result.task.recorded:
                journal.add(result)
                done += result.items
                progress("flying", done, study.planned)

    return fly


def write_tables(run: RunDirectory, journal: Journal, tables: Mapping[str, tuple[str, ...]]) -> None:
    """Write tables from the journal into the run directory: their columns by their file names."""
    for name, columns in tables.items():

        def write(path: Path, name: str = name, columns: tuple[str, ...] = columns) -> None:
            with path.open("w", encoding="utf-8", newline="") as file:
                journal.export(name, columns, file)

        write_whole(run.path / name, write)


def _explained(error: OSError | sqlite3.DatabaseError, run: RunDirectory) -> Exception:
    """Return what to tell of an error of the disk."""
    full = error.errno in (errno.ENOSPC, errno.EDQUOT) if isinstance(error, OSError) else is_full(error)
    if full:
        return InputError(f"there is no room left for '{run.path}'; everything done is kept: make room, and go on with --resume")
    if isinstance(error, sqlite3.DatabaseError) and is_damaged(error):
        return InputError(f"'{run.journal}' is damaged; start a new run in another --out")
    return error
