"""The one interface to whatever does the work: processes of this machine, or of a cluster."""

from collections.abc import Iterable, Iterator
from types import TracebackType
from typing import Protocol, Self

from scenarios.engine.task import Result, Task

TRIES = 2
"""How often a task is tried whose process is lost."""


class Crew(Protocol):
    """Processes that have been given their work; leaving its context ends them."""

    def __enter__(self) -> Self:
        """Begin."""

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """End every process, at once after an error."""

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task as it comes, in any order.

        Tasks are taken from the iterable as processes get free: it may be long.
        """
