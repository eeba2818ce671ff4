"""Executes tasks in the process of the caller, one after the other."""

from collections.abc import Iterable, Iterator
from types import TracebackType
from typing import Self

from scenarios.engine.task import Result, Task, Work


class InProcessExecutor:
    """For one flight, where a process of its own would be the greater part of the time; without
    limits of time and memory.

    Parameters
    ----------
    work : to be done on each task
    """

    def __init__(self, work: Work) -> None:
        self._work = work

    def __enter__(self) -> Self:
        """Do nothing: there is no process to start."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Do nothing: there is no process to end."""

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task, in their order."""
        return map(self._work.fly, tasks)
