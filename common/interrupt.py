"""How the processes of a command end."""

import multiprocessing
import os
import signal
import threading


def follow_parent() -> None:
    """Have this process end with its parent, however that ends, and ignore Ctrl-C: its parent
    handles it and keeps the results.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_after, args=(parent,), daemon=True).start()


def _end_after(parent: multiprocessing.process.BaseProcess) -> None:
    # This waits for the end of a pipe of which the parent holds the other end, so that SIGKILL is
    # noticed as well.
    parent.join()
    os._exit(1)
