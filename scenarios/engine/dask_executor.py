"""Processes of a Dask cluster: of one that is there already, or of one that is started on this machine.

The work goes to every worker once, as a plugin, with the files that it needs: workers need the same code and packages, and no file
system in common. Dask itself gives the task of a worker that dies to another.
"""

import faulthandler
import logging
import math
import pickle
import threading
import time
import uuid
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import distributed

from scenarios.engine.executor import TRIES
from scenarios.engine.fingerprint import differences, fingerprint
from scenarios.engine.task import Limits, Result, Task, Work
from scenarios.errors import InputError

_AHEAD = 2
"""Tasks per worker that are handed in: the one at hand, and the next, so that it does not wait for it."""

_COUNT_INTERVAL = 1.0
"""Shortest time between two counts of the workers [s]."""

_MEMORY_MIN = 2**30
"""Least memory of a worker that is started here [bytes]: with less, Dask may end it again and again before its first flight."""

_CONNECT_TIME = 15.0
"""Time for the scheduler to answer, and for a worker to be there [s]."""


class DaskCrew:
    """Workers of a Dask cluster.

    Parameters
    ----------
    work : what they do
    scheduler : its address; without one a cluster of ``jobs`` workers is started on this machine
    jobs : workers, where they are started here
    limits : of a task; a worker's memory is limited where it is started here, elsewhere by who started it

    Raises
    ------
    InputError : there is no scheduler or no worker at the address, or one that runs other code
    """

    def __init__(self, work: Work, *, scheduler: str | None, jobs: int, limits: Limits) -> None:
        self._work, self._scheduler, self._jobs, self._limits = work, scheduler, jobs, limits
        self._name = f"plume-flight-study-{uuid.uuid4().hex}"
        self._cluster: Any = None
        self._count, self._counted_at = 1, -math.inf

    def __enter__(self) -> Self:
        """Connect, and send the work to every worker."""
        if self._scheduler is None:
            memory = self._limits.memory
            if memory is not None and memory < _MEMORY_MIN:
                raise InputError(
                    f"--memory-limit is {memory / 2**30:.2f} GiB; a worker of Dask's needs {_MEMORY_MIN / 2**30:g} GiB: give more"
                )
            self._cluster = distributed.LocalCluster(
                n_workers=self._jobs,
                threads_per_worker=1,
                dashboard_address=None,
                memory_limit=self._limits.memory or 0,
                silence_logs=logging.CRITICAL,
            )
        try:
            self._client = distributed.Client(self._cluster or self._scheduler, timeout=_CONNECT_TIME)
        except (OSError, TimeoutError, ValueError) as error:
            raise InputError(
                f"--scheduler {self._scheduler} does not answer ({type(error).__name__}); check the address, and that it runs"
            ) from None
        try:
            self._client.wait_for_workers(1, timeout=_CONNECT_TIME)
        except TimeoutError:
            self.__exit__(TimeoutError, None, None)
            raise InputError(f"--scheduler {self._scheduler} has no worker; start some with 'dask worker ADDRESS'") from None
        self._check_code()
        self._client.register_plugin(_WorkPlugin(self._work, self._limits.time), name=self._name)
        return self

    def _check_code(self) -> None:
        """Refuse workers that would fly something else."""
        for worker, theirs in self._client.run(fingerprint).items():
            if differing := differences(theirs):
                self.__exit__(InputError, None, None)
                name = differing[0]
                raise InputError(
                    f"Dask worker {worker} has {name} {theirs.get(name)}; here it is {fingerprint()[name]}: results would differ,"
                    " so install the same there"
                )

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """Leave the cluster, and end it if it was started here."""
        if kind is None:
            self._client.unregister_worker_plugin(self._name)
        self._client.close()
        if self._cluster is not None:
            self._cluster.close()

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task as it comes."""
        waiting = iter(tasks)
        tried: set[int] = set()
        flying: dict[Any, Task] = {}
        coming: Any = distributed.as_completed(with_results=True, raise_errors=False)

        def submit(task: Task) -> None:
            future = self._client.submit(_fly, self._name, task, pure=False, retries=0)
            flying[future] = task
            coming.add(future)

        def hand_out() -> None:
            for _ in range(_AHEAD * self._workers() - len(flying)):
                task = next(waiting, None)
                if task is None:
                    return
                submit(task)

        hand_out()
        for batch in coming.batches():
            results: list[Result] = []
            for future, found in batch:
                task = flying.pop(future)
                if future.status == "finished":
                    results.append(found)
                elif task.number in tried or isinstance(future.exception(), distributed.KilledWorker):
                    results.append(self._work.lost(task, _reason(future.exception())))
                else:
                    tried.add(task.number)
                    submit(task)
                future.release()
            hand_out()
            yield from results

    def _workers(self) -> int:
        """Return how many workers there are, or were a moment ago: they come and go, and asking takes milliseconds."""
        now = time.monotonic()
        if now - self._counted_at > _COUNT_INTERVAL:
            self._counted_at = now
            self._count = max(1, len(self._client.scheduler_info(n_workers=-1)["workers"]))
        return self._count


def _reason(error: BaseException | None) -> str:
    if isinstance(error, distributed.KilledWorker):
        return "workers that flew it died again and again: killed, out of memory, or beyond the time limit"
    return f"{TRIES} workers that flew it failed; the last one with {type(error).__name__}: {error}"


def _fly(name: str, task: Task) -> Result:
    """Do a task on a worker."""
    plugin: Any = distributed.get_worker().plugins[name]
    result: Result = plugin.fly(task)
    return result


class _WorkPlugin(distributed.WorkerPlugin):
    """The work, on a worker."""

    def __init__(self, work: Work, time_limit: float) -> None:
        self._content = pickle.dumps(work)
        root = work.model
        files = sorted(path for path in root.rglob("*") if path.is_file()) if root else []
        self._files = {str(path.relative_to(root)): path.read_bytes() for path in files} if root else None
        self._time_limit = time_limit

    def setup(self, worker: Any) -> None:
        self._work: Work = pickle.loads(self._content)
        # JSBSim keeps a thread to itself, and so does the watch: a worker with several flies one at a time.
        self._alone = threading.Lock()
        if self._files is not None:
            root = Path(worker.local_directory) / "model"
            for name, content in self._files.items():
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                (root / name).write_bytes(content)
            self._work = self._work.moved(root)

    def fly(self, task: Task) -> Result:
        with self._alone:
            # Ends the worker from a thread that needs no lock of Python's: a flight that hangs in C++ holds them all.
            faulthandler.dump_traceback_later(self._time_limit, exit=True)
            try:
                return self._work.fly(task)
            finally:
                faulthandler.cancel_dump_traceback_later()
