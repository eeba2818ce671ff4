"""End a command and its processes in an orderly way."""

import contextlib
import multiprocessing
import os
import signal
import threading
from collections.abc import Iterator
from types import FrameType


@contextlib.contextmanager
def terminated_like_interrupted() -> Iterator[None]:
    """Raise a KeyboardInterrupt at SIGTERM, as at Ctrl-C, within the context.

    Schedulers and containers end a program by SIGTERM. If the program ignores SIGTERM, or runs in
    another thread than the main one, nothing changes.
    """
    before = signal.getsignal(signal.SIGTERM)
    alone = threading.current_thread() is threading.main_thread()
    if before is signal.SIG_IGN or not alone:
        yield
        return
    signal.signal(signal.SIGTERM, _interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _interrupt(_signal: int, _frame: FrameType | None) -> None:
    raise KeyboardInterrupt


def follow_parent() -> None:
    """Make this process end with its parent, and ignore Ctrl-C, which the parent handles.

    SIGTERM ends this process at once; a forked process would otherwise have inherited the parent's
    handler.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: multiprocessing.process.BaseProcess) -> None:
    # join() waits until the parent closes its end of a pipe, which also happens at SIGKILL.
    parent.join()
    os._exit(1)
