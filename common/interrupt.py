"""Ctrl-C in the processes of a command."""

import signal


def ignore_interrupt() -> None:
    """Ignore Ctrl-C in this process: its parent handles it, and keeps the finished results."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
