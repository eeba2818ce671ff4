"""Choice of the executor of a study: processes of this machine, or a Dask cluster."""

from dataclasses import dataclass, field
from importlib.util import find_spec

from common.text import install_words
from scenarios.engine.executor import Executor
from scenarios.engine.local_executor import LocalExecutor
from scenarios.engine.task import Limits, Work
from scenarios.errors import InputError

LOCAL, DASK = "local", "dask"
"""Names of the executors."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ExecutorFactory:
    """Makes executors of one kind.

    Attributes
    ----------
    jobs : number of processes to start; unused with a scheduler, whose workers are running already
    executor : ``LOCAL`` or ``DASK``
    scheduler : address of a Dask scheduler; without one a cluster is started on this machine
    limits : time and memory limits of a task

    Raises
    ------
    InputError : a scheduler without Dask, or Dask is not installed
    """

    jobs: int = 1
    executor: str = LOCAL
    scheduler: str | None = None
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self) -> None:
        if self.scheduler is not None and self.executor != DASK:
            raise InputError(
                f"--scheduler is {self.scheduler} with --executor {self.executor}; add --executor dask"
            )
        if self.executor == DASK and find_spec("distributed") is None:
            raise InputError(
                f"--executor is dask, which is not installed; install the extra: {install_words('dask')}"
            )

    def __call__(self, work: Work) -> Executor:
        """Return an executor for some work."""
        if self.executor == LOCAL:
            return LocalExecutor(work, jobs=self.jobs, limits=self.limits)
        from scenarios.engine.dask_executor import DaskExecutor

        return DaskExecutor(work, scheduler=self.scheduler, jobs=self.jobs, limits=self.limits)
