"""A progress bar on standard error."""

import contextlib
import time
from collections.abc import Iterator

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from scenarios.engine.runner import Progress
from scenarios.errors import InputError

_BETWEEN = 0.1
"""Shortest time between two drawings of the bar [s]: flights can be faster than a terminal."""


@contextlib.contextmanager
def progress_bar() -> Iterator[Progress]:
    """Yield a function to call with what is being done, the number of flights done, and their total.

    The bar appears at the first call, and goes again where input is refused: that leaves nothing but its message.
    """
    bar = Bar(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=Console(stderr=True),
        auto_refresh=False,
    )
    task = bar.add_task("")

    drawn = -_BETWEEN

    def report(doing: str, done: int, total: int) -> None:
        nonlocal drawn
        bar.start()
        now = time.monotonic()
        due = now - drawn >= _BETWEEN or done == total
        drawn = now if due else drawn
        bar.update(task, description=doing, completed=done, total=total, refresh=due)

    try:
        yield report
    except InputError:
        # Erased from a terminal; elsewhere nothing has been written yet.
        bar.live.transient = True
        bar.console.quiet = not bar.console.is_terminal
        raise
    finally:
        if bar.live.is_started:
            bar.stop()
