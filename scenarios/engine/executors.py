"""Which crew flies a study."""

from dataclasses import dataclass, field
from importlib.util import find_spec

from scenarios.engine.executor import Crew
from scenarios.engine.local_executor import LocalCrew
from scenarios.engine.task import Limits, Work
from scenarios.errors import InputError

LOCAL, DASK = "local", "dask"
"""Processes of this machine, or of a Dask cluster."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Hiring:
    """Makes crews of one kind.

    Attributes
    ----------
    jobs : number of processes, where they are started here
    executor : ``LOCAL`` or ``DASK``
    scheduler : address of a Dask scheduler; without one a cluster is started on this machine
    limits : of a flight

    Raises
    ------
    InputError : a scheduler where none is used, or Dask where it is not installed
    """

    jobs: int = 1
    executor: str = LOCAL
    scheduler: str | None = None
    limits: Limits = field(default_factory=Limits)

    def __post_init__(self) -> None:
        if self.scheduler is not None and self.executor != DASK:
            raise InputError(f"--scheduler is {self.scheduler} with --executor {self.executor}; add --executor dask")
        if self.executor == DASK and find_spec("distributed") is None:
            raise InputError(
                "--executor is dask, which is not installed; install it with: pip install -c constraints.txt -e '.[dask]'"
            )

    def __call__(self, work: Work) -> Crew:
        """Return a crew for some work."""
        if self.executor == LOCAL:
            return LocalCrew(work, jobs=self.jobs, limits=self.limits)
        from scenarios.engine.dask_executor import DaskCrew

        return DaskCrew(work, scheduler=self.scheduler, jobs=self.jobs, limits=self.limits)
