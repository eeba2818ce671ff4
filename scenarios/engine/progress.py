"""A progress bar on standard error."""

import contextlib
import time
from collections.abc import Iterator

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from scenarios.engine.runner import Progress
from scenarios.errors import InputError

REFRESH_INTERVAL = 0.1
"""Shortest time between two updates of the bar [s]: results may arrive faster than a terminal can
show them.
"""


@contextlib.contextmanager
def progress_bar() -> Iterator[Progress]:
    """Yield a function to call with the current activity, the number of finished items and their
    total.

    The bar appears at the first call. If the input is refused it is removed, so that only the
    message is left.
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

    refreshed = -REFRESH_INTERVAL

    def report(activity: str, done: int, total: int) -> None:
        nonlocal refreshed
        bar.start()
        now = time.monotonic()
        due = now - refreshed >= REFRESH_INTERVAL or done == total
        refreshed = now if due else refreshed
        bar.update(task, description=activity, completed=done, total=total, refresh=due)

    try:
        yield report
    except InputError:
        # This erases the bar from a terminal; to anything else nothing has been written yet.
        bar.live.transient = True
        bar.console.quiet = not bar.console.is_terminal
        raise
    finally:
        if bar.live.is_started:
            bar.stop()
