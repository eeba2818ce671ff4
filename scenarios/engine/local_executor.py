"""Processes of this machine.

Each has a pipe of its own, and shares no lock with the others: one that dies at any moment takes nothing with it but its task.
(Pools that share a channel do not survive that: github.com/noxdafox/pebble/issues/163, and the standard library's gives up.)
"""

import multiprocessing
import signal
import time
from collections import Counter, deque
from collections.abc import Iterable, Iterator, Sequence
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from types import TracebackType
from typing import Self

from common.interrupt import ignore_interrupt
from scenarios.engine.executor import TRIES
from scenarios.engine.memory import data_memory, limit_memory
from scenarios.engine.task import Limits, Result, Task, Work
from scenarios.errors import InputError

_AHEAD = 2
"""Tasks that a process has at most: the one at hand, and the next, so that it does not wait for it."""

_NOT_MUCH = 5.0
"""Time for a process that is done to end by itself [s]."""


class LocalCrew:
    """Processes of this machine.

    Parameters
    ----------
    work : what they do
    jobs : how many
    limits : of a task
    """

    def __init__(self, work: Work, *, jobs: int, limits: Limits) -> None:
        self._work, self._jobs, self._limits = work, jobs, limits
        self._hands: list[_Hand] = []
        self._again: deque[Task] = deque()
        self._tried: Counter[int] = Counter()

    def __enter__(self) -> Self:
        """Begin; processes start as there is work for them.

        Raises
        ------
        InputError : the limit of memory is below what they begin with
        """
        memory, needed = self._limits.memory, data_memory()
        if memory is not None and memory < needed:
            raise InputError(
                f"--memory-limit is {memory / 2**30:.2f} GiB; a process has {needed / 2**30:.2f} GiB before its first flight: give"
                " more"
            )
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        """End every process, at once after an error."""
        for hand in self._hands:
            hand.end(at_once=kind is not None)
        self._hands.clear()

    def fly(self, tasks: Iterable[Task]) -> Iterator[Result]:
        """Yield the result of every task as it comes; one whose process is lost is tried once more."""
        waiting = iter(tasks)
        while self._hand_out(waiting):
            ready = wait([hand.connection for hand in self._hands if hand.tasks], timeout=self._patience())
            for hand in [hand for hand in self._hands if hand.connection in ready or hand.overdue(self._limits.time)]:
                if hand.connection in ready:
                    answer = hand.answer()
                else:
                    hand.kill()
                    answer = f"did not end within {self._limits.time:g} s"
                if isinstance(answer, Result):
                    yield answer
                else:
                    yield from self._mourn(hand, answer)

    def _hand_out(self, waiting: Iterator[Task]) -> bool:
        """Give tasks to who is free; return whether any is at work."""
        for depth in range(1, _AHEAD + 1):
            for place in range(self._jobs):
                if place < len(self._hands) and len(self._hands[place].tasks) >= depth:
                    continue
                task = self._again.popleft() if self._again else next(waiting, None)
                if task is None:
                    return any(hand.tasks for hand in self._hands)
                if place == len(self._hands):
                    self._hands.append(_Hand(self._work, self._limits, [hand.connection for hand in self._hands]))
                self._hands[place].give(task)
        return True

    def _patience(self) -> float:
        """Return the time until the next task is overdue [s]."""
        due = min(hand.since + self._limits.time for hand in self._hands if hand.tasks)
        return max(0.0, due - time.monotonic())

    def _mourn(self, hand: "_Hand", reason: str) -> Iterator[Result]:
        """Replace a process that was lost; yield the result of its task if it has been tried often enough."""
        hand.end(at_once=True)
        at_hand, *others = hand.tasks
        # The others had not been begun: they are as they were.
        self._again.extendleft(reversed(others))
        self._hands.remove(hand)
        self._tried[at_hand.number] += 1
        if self._tried[at_hand.number] < TRIES:
            self._again.append(at_hand)
        else:
            yield self._work.lost(at_hand, f"{TRIES} processes that flew it were lost; the last one {reason}")


class _Hand:
    """One process, and what it has been given.

    Attributes
    ----------
    connection : to it
    tasks : the one at hand, and those to come
    since : when it began the one at hand [s]
    """

    def __init__(self, work: Work, limits: Limits, others: Sequence[Connection]) -> None:
        self.connection, theirs = multiprocessing.Pipe()
        # A forked process has the ends of all pipes; were it to keep them, none would ever see this program gone.
        inherited = [*others, self.connection]
        self._process: BaseProcess = multiprocessing.Process(
            target=_serve, args=(theirs, inherited, work, limits.memory), daemon=True
        )
        self._process.start()
        theirs.close()
        self.tasks: deque[Task] = deque()
        self.since = time.monotonic()

    def give(self, task: Task) -> None:
        """Give it a task, to be done after those that it has."""
        if not self.tasks:
            self.since = time.monotonic()
        self.tasks.append(task)
        try:
            self.connection.send(task)
        except (BrokenPipeError, ConnectionResetError):
            # It is dead: that shows when its answer is asked for.
            return

    def overdue(self, limit: float) -> bool:
        """Return whether it has had more than ``limit`` [s] for the task at hand."""
        return bool(self.tasks) and time.monotonic() - self.since > limit

    def answer(self) -> Result | str:
        """Return its answer, or what became of it."""
        try:
            answer: Result | str = self.connection.recv()
        except (EOFError, OSError):
            self._process.join(_NOT_MUCH)
            return _how_it_ended(self._process.exitcode)
        if isinstance(answer, Result):
            self.tasks.popleft()
            self.since = time.monotonic()
        return answer

    def kill(self) -> None:
        """End it, whatever it does."""
        self._process.kill()

    def end(self, *, at_once: bool) -> None:
        """Let it end by itself when it has nothing to do, or at once."""
        self.connection.close()
        if at_once:
            self._process.kill()
        self._process.join(_NOT_MUCH)
        if self._process.is_alive():
            self._process.kill()
            self._process.join()


def _how_it_ended(code: int | None) -> str:
    if code is None:
        return "closed its connection"
    if code < 0:
        name = signal.Signals(-code).name
        return f"was ended by {name}" + (", as for lack of memory" if -code == signal.SIGKILL else "")
    return f"ended with status {code}"


def _serve(connection: Connection, inherited: Sequence[Connection], work: Work, memory: int | None) -> None:
    """Do tasks until there are none, or until whoever gives them is gone."""
    ignore_interrupt()
    for other in inherited:
        other.close()
    limit_memory(memory)
    try:
        while True:
            task = connection.recv()
            try:
                connection.send(work.fly(task))
            except MemoryError:
                connection.send(f"ran out of memory{'' if memory is None else f', of which it had {memory / 2**20:.0f} MiB'}")
                return
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
