"""Execute tasks in processes of this machine, or in the caller's process.

Every process has its own pipe and shares no lock with the others, so a process that dies loses its
current task and nothing else. Pools with a shared channel do not survive the death of a process
(github.com/noxdafox/pebble/issues/163), and the pool of the standard library stops.
"""

import multiprocessing
import re
import signal
import sys
import time
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from types import TracebackType
from typing import Protocol, Self

from common.interrupt import follow_parent
from scenarios.engine.task import Limits, Result, Task, Work
from scenarios.errors import InputError

if sys.platform != "win32":
    import resource

MAX_ATTEMPTS = 2
"""Number of attempts at a task whose process is lost."""

QUEUE_DEPTH = 2
"""Largest number of tasks in a process: the current one, and the next to avoid waiting."""

JOIN_TIMEOUT = 5.0
"""Time limit for an idle process to end before it is killed [s]; ending takes milliseconds."""


class Executor(Protocol):
    """Executes tasks; the end of its context ends its processes."""

    def __enter__(self) -> Self:
        """Start the executor."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End every process, after an error at once."""

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task as it arrives, in any order.

        Tasks are taken from the iterable only when a process has room, because there may be many.
        """


class InProcessExecutor:
    """Executes tasks in the caller's process, without limits of time and memory.

    For a single flight, starting a process would take most of the time.

    Parameters
    ----------
    work : to be done on each task
    """

    def __init__(self, work: Work) -> None:
        self._work = work

    def __enter__(self) -> Self:
        """Do nothing, because there is no process to start."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Do nothing, because there is no process to end."""

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Return the results of the tasks in order."""
        return map(self._work.run, tasks)


class LocalExecutor:
    """Executes tasks in processes of this machine.

    Parameters
    ----------
    work : work to be done on each task
    jobs : number of processes
    limits : time and memory limits of a task
    """

    def __init__(self, work: Work, *, jobs: int, limits: Limits) -> None:
        self._work = work
        self._jobs = jobs
        self._limits = limits
        self._workers: list[WorkerProcess] = []
        self._retries: deque[Task] = deque()
        self._attempts: Counter[int] = Counter()

    def __enter__(self) -> Self:
        """Check the memory limit; processes are started later, when there is work.

        Raises
        ------
        InputError : the memory limit is below what a process uses before its first task
        """
        memory, needed = self._limits.memory, data_memory()
        if memory is not None and memory < needed:
            raise InputError(
                f"--memory-limit is {memory / 2**30:.2f} GiB; a process uses"
                f" {needed / 2**30:.2f} GiB before its first flight:"
                " raise the limit"
            )
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End every process; after an error, kill them."""
        for worker in self._workers:
            worker.end(at_once=kind is not None)
        self._workers.clear()

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield every result as it arrives; a task whose process is lost is tried again."""
        waiting = iter(tasks)
        while self._dispatch(waiting):
            ready = wait(
                [worker.connection for worker in self._workers if worker.tasks],
                timeout=self._time_to_deadline(),
            )
            due = [
                w for w in self._workers if w.connection in ready or w.is_overdue(self._limits.time)
            ]
            for worker in due:
                if worker.connection in ready:
                    answer = worker.receive()
                else:
                    worker.kill()
                    answer = f"did not end within {self._limits.time:g} s"
                if isinstance(answer, Result):
                    yield answer
                else:
                    yield from self._handle_lost_worker(worker, answer)

    def _dispatch(self, waiting: Iterator[Task]) -> bool:
        """Send tasks to processes that have room for more; return whether any process is busy."""
        for depth in range(1, QUEUE_DEPTH + 1):
            for index in range(self._jobs):
                if index < len(self._workers) and len(self._workers[index].tasks) >= depth:
                    continue
                task = self._retries.popleft() if self._retries else next(waiting, None)
                if task is None:
                    return any(worker.tasks for worker in self._workers)
                if index == len(self._workers):
                    others = [worker.connection for worker in self._workers]
                    self._workers.append(WorkerProcess(self._work, self._limits, others))
                self._workers[index].send(task)
        return True

    def _time_to_deadline(self) -> float:
        """Return the time until the next running task exceeds the time limit [s]."""
        deadline = min(
            worker.task_started + self._limits.time for worker in self._workers if worker.tasks
        )
        return max(0.0, deadline - time.monotonic())

    def _handle_lost_worker(self, worker: "WorkerProcess", reason: str) -> Iterator[Result]:
        """Queue the tasks of a lost process again.

        After the last attempt at its current task, yield a result instead.
        """
        worker.end(at_once=True)
        current, *queued = worker.tasks
        # The queued tasks had not been started, so they do not count as attempted.
        self._retries.extendleft(reversed(queued))
        self._workers.remove(worker)
        self._attempts[current.number] += 1
        if self._attempts[current.number] < MAX_ATTEMPTS:
            self._retries.append(current)
        else:
            yield self._work.lost(
                current, f"{MAX_ATTEMPTS} processes that flew it were lost; the last one {reason}"
            )


class WorkerProcess:
    """A process and the tasks that were sent to it.

    Attributes
    ----------
    connection : pipe to the process
    tasks : the current task, then the tasks queued in the pipe
    task_started : start time of the current task [s]
    """

    def __init__(self, work: Work, limits: Limits, others: Sequence[Connection]) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        # A forked process inherits the ends of all pipes. If they stayed open, no process would
        # notice the end of this program.
        inherited = [*others, self.connection]
        self._process: BaseProcess = multiprocessing.Process(
            target=_serve, args=(theirs, inherited, work, limits.memory), daemon=True
        )
        self._process.start()
        theirs.close()
        self.tasks: deque[Task] = deque()
        self.task_started = time.monotonic()

    def send(self, task: Task) -> None:
        """Queue a task."""
        if not self.tasks:
            self.task_started = time.monotonic()
        self.tasks.append(task)
        try:
            self.connection.send(task)
        except (BrokenPipeError, ConnectionResetError):
            # The process is dead; receive() reports it.
            return

    def is_overdue(self, limit: float) -> bool:
        """Return whether the current task has taken more than ``limit`` [s]."""
        return bool(self.tasks) and time.monotonic() - self.task_started > limit

    def receive(self) -> Result | str:
        """Return the result of the current task, or the reason why the process was lost."""
        try:
            answer: Result | str = self.connection.recv()
        except (EOFError, OSError):
            self._process.join(JOIN_TIMEOUT)
            return _exit_reason(self._process.exitcode)
        if isinstance(answer, Result):
            self.tasks.popleft()
            self.task_started = time.monotonic()
        return answer

    def kill(self) -> None:
        """Kill the process."""
        self._process.kill()

    def end(self, *, at_once: bool) -> None:
        """End the process by closing its pipe; kill it if ``at_once``, or if it does not end."""
        self.connection.close()
        if at_once:
            self._process.kill()
        self._process.join(JOIN_TIMEOUT)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _exit_reason(code: int | None) -> str:
    if code is None:
        return "closed its connection"
    if code < 0:
        # Only the first and the last real-time signal have a name.
        name = signal.Signals(-code).name if -code in list(signal.Signals) else f"signal {-code}"
        return f"was ended by {name}" + (
            ", possibly for lack of memory" if name == "SIGKILL" else ""
        )
    return f"ended with status {code}"


def _serve(
    connection: Connection, inherited: Sequence[Connection], work: Work, memory: int | None
) -> None:
    """Do tasks in a process until the pipe is closed."""
    follow_parent()
    for other in inherited:
        other.close()
    limit_memory(memory)
    try:
        while True:
            task = connection.recv()
            try:
                connection.send(work.run(task))
            except MemoryError:
                limit = "" if memory is None else f"; its limit is {memory / 2**20:.0f} MiB"
                connection.send(f"ran out of memory{limit}")
                return
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def limit_memory(limit: int | None) -> None:
    """Limit the data memory of this process to ``limit`` [bytes].

    Allocations beyond the limit raise MemoryError. Some systems have no such limit.
    """
    if limit is not None and sys.platform != "win32":
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        resource.setrlimit(
            resource.RLIMIT_DATA,
            (limit if hard == resource.RLIM_INFINITY else min(limit, hard), hard),
        )


def data_memory() -> int:
    """Return the data memory of this process [bytes]; 0 if it is not reported."""
    try:
        status = Path("/proc/self/status").read_text(encoding="ascii")
    except OSError:
        return 0
    found = re.search(r"^VmData:\s+(\d+) kB$", status, re.MULTILINE)
    return 1024 * int(found[1]) if found else 0


def peak_memory() -> float:
    """Return the peak resident memory of this process [bytes]; 0 if it is not reported."""
    if sys.platform == "win32":
        return 0.0
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)
