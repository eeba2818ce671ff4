"""Execute tasks on the workers of a Dask cluster, running or started on this machine.

The work and the aircraft's model are sent to every worker once, as a plugin. Workers need the same
code and packages, and the scenario's files at the same paths, but no shared file system. If a
worker dies, Dask gives its task to another one.
"""

import faulthandler
import logging
import math
import pickle
import shutil
import threading
import time
import uuid
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import distributed

from scenarios.engine.processes import MAX_ATTEMPTS, QUEUE_DEPTH
from scenarios.engine.run_directory import differences, fingerprint
from scenarios.engine.task import Limits, Result, Task, Work
from scenarios.errors import InputError

WORKER_COUNT_INTERVAL = 1.0
"""Shortest time between two counts of the workers [s]: a count takes milliseconds."""

WORKER_MEMORY_MIN = 2**30
"""Least memory limit of a started worker [bytes]: with less, Dask may restart it at once."""

CONNECT_TIMEOUT = 15.0
"""Time limit for the scheduler to answer, and for the first worker to register [s]."""

_FLYING = threading.Lock()
"""Lets a worker with several threads fly one flight at a time.

Threads can share neither JSBSim nor the timer of faulthandler.
"""


class DaskExecutor:
    """Executes tasks on the workers of a Dask cluster.

    Parameters
    ----------
    work : work to be done on each task
    scheduler : address of a running scheduler; None to start a cluster of ``jobs`` workers on this
        machine
    jobs : number of workers to start without a scheduler
    limits : time and memory limits of a task; the memory limit holds for started workers only

    Raises
    ------
    InputError : there is no scheduler or no worker at the address, or a worker has other software
    """

    def __init__(self, work: Work, *, scheduler: str | None, jobs: int, limits: Limits) -> None:
        self._work = work
        self._scheduler = scheduler
        self._jobs = jobs
        self._limits = limits
        self._name = f"plume-flight-study-{uuid.uuid4().hex}"
        self._cluster: Any = None
        self._worker_count, self._counted_at = 1, -math.inf

    def __enter__(self) -> Self:
        """Connect to the cluster and send the work to every worker."""
        if self._scheduler is None:
            memory = self._limits.memory
            if memory is not None and memory < WORKER_MEMORY_MIN:
                raise InputError(
                    f"--memory-limit is {memory / 2**30:.2f} GiB; a Dask worker needs"
                    f" {WORKER_MEMORY_MIN / 2**30:g} GiB:"
                    " raise the limit"
                )
            self._cluster = distributed.LocalCluster(
                n_workers=self._jobs,
                threads_per_worker=1,
                dashboard_address=None,
                memory_limit=self._limits.memory or 0,
                silence_logs=logging.CRITICAL,
            )
        try:
            self._client = distributed.Client(
                self._cluster or self._scheduler, timeout=CONNECT_TIMEOUT
            )
        except (OSError, TimeoutError, ValueError) as error:
            raise InputError(
                f"--scheduler {self._scheduler} does not answer ({type(error).__name__}); check"
                " that it is running there"
            ) from None
        try:
            self._client.wait_for_workers(1, timeout=CONNECT_TIMEOUT)
        except TimeoutError:
            self.__exit__(TimeoutError, None, None)
            raise InputError(
                f"--scheduler {self._scheduler} has no worker; start some with 'dask worker"
                " ADDRESS'"
            ) from None
        self._check_code()
        self._client.register_plugin(
            _WorkPlugin(self._name, self._work, self._limits.time), name=self._name
        )
        return self

    def _check_code(self) -> None:
        """Refuse workers that lack the program or have other versions of software."""
        for worker, theirs in self._client.run(fingerprint, on_error="return").items():
            if isinstance(theirs, BaseException):
                self.__exit__(InputError, None, None)
                raise InputError(
                    f"Dask worker {worker} cannot run this program ({theirs}); install it"
                    " there, in the same version"
                )
            if differing := differences(theirs):
                self.__exit__(InputError, None, None)
                name = differing[0]
                raise InputError(
                    f"Dask worker {worker} has {name} {theirs.get(name)}; here it is"
                    f" {fingerprint()[name]}: results would differ;"
                    " install the same version there"
                )

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Disconnect from the cluster, and end a cluster that was started here."""
        if kind is None:
            self._client.unregister_worker_plugin(self._name)
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task as it arrives; a failed task is tried again."""
        waiting = iter(tasks)
        attempted: set[int] = set()
        running: dict[Any, Task] = {}
        completed: Any = distributed.as_completed(with_results=True, raise_errors=False)

        def submit(task: Task) -> None:
            future = self._client.submit(_fly, self._name, task, pure=False, retries=0)
            running[future] = task
            completed.add(future)

        def dispatch() -> None:
            for _ in range(QUEUE_DEPTH * self._count_workers() - len(running)):
                task = next(waiting, None)
                if task is None:
                    return
                submit(task)

        dispatch()
        for batch in completed.batches():
            results: list[Result] = []
            for future, found in batch:
                task = running.pop(future)
                if future.status == "finished":
                    results.append(found)
                elif task.number in attempted or isinstance(
                    future.exception(), distributed.KilledWorker
                ):
                    results.append(self._work.lost(task, _reason(future.exception())))
                else:
                    attempted.add(task.number)
                    submit(task)
                future.release()
            dispatch()
            yield from results

    def _count_workers(self) -> int:
        """Return the number of workers, counted at most ``WORKER_COUNT_INTERVAL`` ago."""
        now = time.monotonic()
        if now - self._counted_at > WORKER_COUNT_INTERVAL:
            self._counted_at = now
            self._worker_count = max(1, len(self._client.scheduler_info(n_workers=-1)["workers"]))
        return self._worker_count


def _reason(error: BaseException | None) -> str:
    if isinstance(error, distributed.KilledWorker):
        return (
            "several workers died while they flew it: killed, out of memory, or beyond the time"
            " limit"
        )
    return (
        f"{MAX_ATTEMPTS} workers that flew it failed; the last one with {type(error).__name__}:"
        f" {error}"
    )


def _fly(name: str, task: Task) -> Result:
    """Do a task on a worker."""
    plugin: Any = distributed.get_worker().plugins[name]
    result: Result = plugin.run(task)
    return result


class _WorkPlugin(distributed.WorkerPlugin):
    """Holds the work of a run on a worker, with files in a directory of the run's name.

    A worker may have several runs at once.
    """

    def __init__(self, name: str, work: Work, time_limit: float) -> None:
        self.name = name
        self._content = pickle.dumps(work)
        root = work.model
        files = sorted(path for path in root.rglob("*") if path.is_file()) if root else []
        self._files = (
            {str(path.relative_to(root)): path.read_bytes() for path in files} if root else None
        )
        self._time_limit = time_limit

    def setup(self, worker: Any) -> None:
        self._work: Work = pickle.loads(self._content)
        if self._files is not None:
            root = self._directory(worker) / "model"
            for name, content in self._files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_bytes(content)
            self._work = self._work.moved(root)

    def teardown(self, worker: Any) -> None:
        shutil.rmtree(self._directory(worker), ignore_errors=True)

    def _directory(self, worker: Any) -> Path:
        return Path(worker.local_directory) / self.name

    def run(self, task: Task) -> Result:
        with _FLYING:
            # This timer needs no interpreter lock, which a flight that hangs in C++ may hold.
            faulthandler.dump_traceback_later(self._time_limit, exit=True)
            try:
                return self._work.run(task)
            finally:
                faulthandler.cancel_dump_traceback_later()
