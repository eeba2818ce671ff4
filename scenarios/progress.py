"""A progress bar on standard error."""

import contextlib
from collections.abc import Iterator

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from scenarios.errors import InputError
from scenarios.pool import Progress


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

    def report(doing: str, done: int, total: int) -> None:
        bar.start()
        bar.update(task, description=doing, completed=done, total=total, refresh=True)

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
