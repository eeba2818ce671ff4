"""An executor that loses the process of some flights, as one that is killed."""

from collections.abc import Callable, Iterable, Iterator

from scenarios.engine.processes import InProcessExecutor
from scenarios.engine.task import Result, Task, Work


class LosingExecutor(InProcessExecutor):
    """Flies in the process of the caller, but for the flights of the numbers that it loses."""

    def __init__(self, work: Work, numbers: Iterable[int]) -> None:
        super().__init__(work)
        self._numbers = frozenset(numbers)

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task, in their order."""
        return (
            self._work.lost(task, "was killed")
            if task.number in self._numbers
            else self._work.run(task)
            for task in tasks
        )


def losing(*numbers: int) -> Callable[[Work], LosingExecutor]:
    """Return a factory of executors that lose the flights of these numbers."""
    return lambda work: LosingExecutor(work, numbers)
