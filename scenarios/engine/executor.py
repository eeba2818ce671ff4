"""The interface that local processes and Dask workers share."""

from collections.abc import Iterable, Iterator
from types import TracebackType
from typing import Protocol, Self

from scenarios.engine.task import Result, Task

MAX_ATTEMPTS = 2
"""How often a task is tried if its process is lost."""

QUEUE_DEPTH = 2
"""Tasks that a process holds at most: the current one and the next, so that it need not wait for
it.
"""


class Executor(Protocol):
    """Executes tasks in processes that have their work; leaving its context ends them."""

    def __enter__(self) -> Self:
        """Start."""

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """End every process; after an error at once."""

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task as it arrives, in any order.

        Tasks are taken from the iterable only when a process has room for one: it may be long.
        """
