"""The end of a command's processes."""

import multiprocessing
import os
import signal
import threading


def follow_parent() -> None:
    """End this process together with its parent, and ignore Ctrl-C, which the parent handles."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: multiprocessing.process.BaseProcess) -> None:
    # join() waits until the parent's end of a pipe is closed, so that SIGKILL is noticed as well.
    parent.join()
    os._exit(1)
