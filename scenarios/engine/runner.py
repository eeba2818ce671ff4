"""The Protocol of a study, its execution, and the progress bar.

A study is executed with an executor, a journal and a run directory.
"""

import contextlib
import errno
import sqlite3
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Protocol

from common.columns import Table, to_json
from common.files import remove_reports, write_whole
from common.run_layout import COLUMNS, FILES, VERDICT
from common.text import install_words
from common.verdict import MET, RunVerdict
from scenarios.engine.journal import CONTINUE, Journal, is_full, unusable
from scenarios.engine.processes import Executor, LocalExecutor, peak_memory
from scenarios.engine.run_directory import RunDirectory
from scenarios.engine.task import Limits, Task, Work
from scenarios.errors import InputError

Progress = Callable[[str, int, int], None]
"""Function called with the current activity, the number of done items and their total number."""

LOCAL, DASK = "local", "dask"
"""Names of the executors."""

REFRESH_INTERVAL = 0.1
"""Shortest time between updates of the progress bar [s]: a terminal can be slower than results."""

_COMPLETE, _INTERRUPTED = "complete", "interrupted"

Fly = Callable[[Iterable[Task]], None]
"""Function that executes tasks and returns when their results are in the journal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StudySummary:
    """The result of a study so far.

    Attributes
    ----------
    verdict : verdict on the run, for ``verdict.json``
    lines : the verdict in lines of text, for the console
    manifest : entries for the run's manifest
    """

    verdict: RunVerdict
    lines: list[str]
    manifest: dict[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Launch:
    """Amount of work when a study is started or resumed.

    Attributes
    ----------
    what : name of the study's items, in the plural
    planned, done : largest possible number of items, and number of done items
    comparisons_left : number of comparisons that are still to be flown
    resumed : whether the run had begun before
    """

    what: str
    planned: int
    done: int
    comparisons_left: int
    resumed: bool


class Study(Protocol):
    """A set of tasks, the work to be done on each, and the evaluation of the results.

    Attributes
    ----------
    what : name of the study's items, in the plural, such as "flights"
    config_hash : hash of the configuration that results depend on
    """

    what: str
    config_hash: str

    @property
    def planned(self) -> int:
        """Return the largest possible number of items."""

    @property
    def comparisons(self) -> int:
        """Return the number of comparisons, which are not items but count for the progress."""

    def initial_manifest(self) -> dict[str, Any]:
        """Return the manifest that is written before the first task."""

    def work(self, run: RunDirectory) -> Work:
        """Write the files that the work needs into the run directory; return the work."""

    def run(self, fly: Fly, run: RunDirectory, journal: Journal) -> None:
        """Execute tasks, in one or several calls of ``fly``.

        When ``fly`` returns, the results are in the journal. Tasks with a result in the journal are
        skipped, except ``recorded`` ones, which are repeated for their files.
        """

    def postprocess(self, run: RunDirectory, journal: Journal, progress: Progress) -> None:
        """Write the run's files other than tables, after the last task."""

    def export(self, run: RunDirectory, journal: Journal) -> None:
        """Write the tables from the results so far."""

    def summary(self, journal: Journal) -> StudySummary:
        """Return the study's result so far."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunResult:
    """The outcome of a run.

    Attributes
    ----------
    directory : the run directory
    verdict : verdict on the run
    lines : the verdict in lines of text
    changed : whether anything was written; a complete run that is resumed may stay unchanged
    """

    directory: Path
    verdict: RunVerdict
    lines: list[str]
    changed: bool = True

    @property
    def all_met(self) -> bool:
        """Whether everything planned is done and met its requirement."""
        return self.verdict.exit_status == MET


def fly_study(
    study: Study,
    directory: Path,
    *,
    executor_factory: Callable[[Work], Executor],
    resume: bool,
    progress: Progress,
    command: str = "",
    launched: Callable[[Launch], None] = lambda _: None,
) -> RunResult:
    """Fly a study, or its unfinished part, into a run directory.

    Parameters
    ----------
    study : the study
    directory : the run directory
    executor_factory : function that creates the executor
    resume : whether to continue the unfinished run in ``directory``
    progress : called as the study advances
    command : the command line, for the manifest; empty if a program flies the study
    launched : called once before the first task

    Raises
    ------
    InputError : the directory or its journal cannot be used, or the disk is full; finished results
        are kept
    """
    run = RunDirectory(directory)
    before = run.open(study.config_hash, resume=resume, manifest=study.initial_manifest)
    try:
        journal = Journal(run.journal)
        try:
            if not before and not journal.is_empty():
                raise InputError(
                    f"'{run.path}' has results without a {run.manifest.name}; choose another --out"
                )
            run.remove_partial_files()
            execution = _Execution(study, run, journal, before, progress, command)
            return execution.fly(executor_factory, launched)
        finally:
            journal.close()
    except (OSError, sqlite3.DatabaseError) as error:
        raise _explained(error, run) from None
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        if not before or isinstance(error, InputError):
            raise
        what = f"{type(error).__name__}: {error}".splitlines()[0]
        raise InputError(
            f"'{run.path}' has results that do not fit its study ({what}); start a new run in"
            " another --out"
        ) from error


class _Execution:
    """One execution of a study, or of its unfinished part.

    Parameters
    ----------
    study, run, journal : the study, and its run directory and journal
    before : manifest of a resumed run, empty for a new run
    progress : called as the study advances
    command : the command line
    """

    def __init__(
        self,
        study: Study,
        run: RunDirectory,
        journal: Journal,
        before: Mapping[str, Any],
        progress: Progress,
        command: str,
    ) -> None:
        self._study = study
        self._run = run
        self._journal = journal
        self._before = before
        self._progress = progress
        # A resumed run began with its first session, and its time is the sum of all sessions.
        began = before.get("begun_utc") or f"{datetime.now(UTC):%Y-%m-%dT%H:%M:%SZ}"
        first = {"command": before.get("command") or command, "begun_utc": began}
        self._wall_time = float(before.get("wall_time_s", 0.0))
        self._manifest = study.initial_manifest() | first
        self._begun = False

    def fly(
        self, executor_factory: Callable[[Work], Executor], launched: Callable[[Launch], None]
    ) -> RunResult:
        study, run, journal = self._study, self._run, self._journal
        began = time.perf_counter()
        interrupted = False
        if not self._before:
            self._begin()
        try:
            work = study.work(run)
            with executor_factory(work) as executor:
                launched(self._launch())
                study.run(self._executing(executor), run, journal)
            if not self._is_as_before():
                study.postprocess(run, journal, self._progress)
        except KeyboardInterrupt:
            interrupted = True
        except Exception:
            # After an error, the results so far stay readable.
            if not journal.is_empty():
                study.export(run, journal)
                self._write(study.summary(journal).verdict, interrupted=True)
            raise
        changed = not self._is_as_before()
        # Tables are always written, because others may have changed them; equal files stay
        # untouched.
        study.export(run, journal)
        summary = study.summary(journal)
        verdict = self._write(summary.verdict, interrupted=interrupted)
        if changed:
            closing = {
                "state": _INTERRUPTED if interrupted else _COMPLETE,
                "wall_time_s": self._wall_time + time.perf_counter() - began,
                "peak_memory_mib": round(peak_memory() / 2**20, 1),
                # A deleted file that is not written again is still missing.
                FILES: sorted({*run.files(), *run.missing_files}),
            }
            run.write_json(run.manifest, self._manifest | closing | summary.manifest)
        elif self._before.get("report") != self._manifest.get("report"):
            # Nothing was flown, but the settings of the reports have changed.
            changed = True
            report = {
                "report": self._manifest.get("report"),
                FILES: sorted({*run.files(), *run.missing_files}),
            }
            run.write_json(run.manifest, {**self._before, **report})
        return RunResult(directory=run.path, verdict=verdict, lines=summary.lines, changed=changed)

    def _write(self, verdict: RunVerdict, *, interrupted: bool) -> RunVerdict:
        """Write the verdict on the results so far; return it."""
        verdict = verdict.once_interrupted(interrupted=interrupted)
        self._run.write_json(self._run.path / VERDICT, verdict.to_json())
        return verdict

    def _launch(self) -> Launch:
        study = self._study
        before = study.summary(self._journal).verdict if self._before else None
        return Launch(
            what=study.what,
            planned=study.planned,
            done=before.counts.done if before else 0,
            comparisons_left=before.comparisons_left if before else study.comparisons,
            resumed=before is not None,
        )

    def _begin(self) -> None:
        """Mark the run as running in its manifest, and remove reports that will be outdated.

        This happens once, before the first result is added.
        """
        if not self._begun:
            self._begun = True
            remove_reports(self._run.path)
            (self._run.path / VERDICT).unlink(missing_ok=True)
            # The time of a killed session is unknown; the time of earlier sessions is kept.
            took = {"wall_time_s": self._wall_time} if self._wall_time else {}
            running = {"state": "running", **took, FILES: self._before.get(FILES, [])}
            self._run.write_json(self._run.manifest, self._manifest | running)

    def _is_as_before(self) -> bool:
        """Return whether the run was complete, without new results and missing files."""
        return (
            not self._begun
            and self._before.get("state") == _COMPLETE
            and not self._run.missing_files
        )

    def _executing(self, executor: Executor) -> Fly:
        before, done, beside = (
            self._journal.done(),
            self._journal.items(),
            self._journal.without_items(),
        )

        def report() -> None:
            # Results that tune a law before the flights are neither items nor comparisons.
            possible = self._study.comparisons
            self._progress("flying", done + min(beside, possible), self._study.planned + possible)

        report()

        def waiting(tasks: Iterable[Task]) -> Iterator[Task]:
            for task in tasks:
                if task.recorded or task.number not in before:
                    self._begin()
                    yield task

        def fly(tasks: Iterable[Task]) -> None:
            nonlocal done, beside
            for result in executor.fly(waiting(tasks)):
                # Files are written first, because a result in the journal counts as done.
                for name, content in result.files.items():
                    self._run.write_bytes(name, content)
                if not result.task.recorded:
                    self._journal.add(result)
                    done, beside = done + result.items, beside + (result.items == 0)
                    report()

        return fly


@dataclass(frozen=True, slots=True, kw_only=True)
class ExecutorFactory:
    """Creates executors of one kind.

    Attributes
    ----------
    jobs : number of processes to start; unused with a scheduler, whose workers are running
    executor : ``LOCAL`` or ``DASK``
    scheduler : address of a Dask scheduler; None to start a cluster on this machine
    limits : time and memory limits of a task

    Raises
    ------
    InputError : a scheduler is given without Dask, or Dask is not installed
    """

    jobs: int = 1
    executor: str = LOCAL
    scheduler: str | None = None
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self) -> None:
        if self.scheduler is not None and self.executor != DASK:
            raise InputError(
                f"--scheduler is {self.scheduler} with --executor {self.executor}; add"
                " --executor dask"
            )
        if self.executor == DASK and find_spec("distributed") is None:
            raise InputError(
                "--executor is dask, which is not installed; install the extra:"
                f" {install_words('dask')}"
            )

    def __call__(self, work: Work) -> Executor:
        """Return an executor for the work."""
        if self.executor == LOCAL:
            return LocalExecutor(work, jobs=self.jobs, limits=self.limits)
        from scenarios.engine.dask_executor import DaskExecutor

        return DaskExecutor(work, scheduler=self.scheduler, jobs=self.jobs, limits=self.limits)


def write_tables(run: RunDirectory, journal: Journal, tables: Mapping[str, Table]) -> None:
    """Write tables from the journal into the run directory; ``tables`` has columns by file."""
    for name, columns in tables.items():

        def write(path: Path, name: str = name, columns: Table = columns) -> None:
            with path.open("w", encoding="utf-8", newline="") as file:
                journal.export(name, tuple(columns), file)

        write_whole(run.path / name, write)


def write_columns(run: RunDirectory, tables: Mapping[str, Table]) -> None:
    """Write ``columns.json``, the description of the tables' columns."""
    run.write_json(run.path / COLUMNS, to_json(tables))


def _explained(error: OSError | sqlite3.DatabaseError, run: RunDirectory) -> InputError:
    """Return the error to raise for an error of the disk or of the journal."""
    full = (
        error.errno in (errno.ENOSPC, errno.EDQUOT)
        if isinstance(error, OSError)
        else is_full(error)
    )
    if full:
        return InputError(
            f"the disk of '{run.path}' is full; finished results are kept: free some space and"
            f" {CONTINUE}"
        )
    if isinstance(error, OSError):
        where = error.filename or run.path
        return InputError(
            f"'{where}' cannot be used: {error.strerror or error}; fix that, then {CONTINUE}"
        )
    return unusable(run.journal, error)


@contextlib.contextmanager
def progress_bar() -> Iterator[Progress]:
    """Show a progress bar in this context; yield the function that updates it.

    The bar appears at the first call. If the input is refused, the bar is removed, so that only the
    error message is visible.
    """
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    bar = Bar(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        auto_refresh=False,
    )
    task = bar.add_task("")

    refreshed = -REFRESH_INTERVAL

    def report(activity: str, done: int, total: int) -> None:
        nonlocal refreshed
        bar.start()
        now = time.monotonic()
        due = now - refreshed >= REFRESH_INTERVAL or done == total
        refreshed = now if due else refreshed
        bar.update(task, description=activity, completed=done, total=total, refresh=due)

    try:
        yield report
    except InputError:
        # This erases the bar from a terminal; any other output has not been written yet.
        bar.live.transient = True
        bar.console.quiet = not bar.console.is_terminal
        raise
    finally:
        if bar.live.is_started:
            bar.stop()
