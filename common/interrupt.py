"""What Ctrl-C does to the processes of a command."""

import signal


def ignore_interrupt() -> None:
    """Leave Ctrl-C to the parent process, which decides what becomes of work under way and keeps what is done."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
