"""The end of a command and of its processes."""

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

    Schedulers and containers end a program by SIGTERM. A program that ignores it goes on doing so.
    Only the main thread may handle signals: in any other one nothing changes.
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
    """End this process together with its parent, and ignore Ctrl-C, which the parent handles.

    SIGTERM ends it, and not the parent, whose handling of it a forked process has inherited.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: multiprocessing.process.BaseProcess) -> None:
    # join() waits until the parent's end of a pipe is closed, so that SIGKILL is noticed as well.
    parent.join()
    os._exit(1)
