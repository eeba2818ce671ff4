"""How signals end a command and its processes."""

import multiprocessing
import os
import signal
import threading

import pytest

from common.interrupt import follow_parent, terminated_like_interrupted


@pytest.fixture(autouse=True)
def unchanged():
    """Leave the handling of SIGTERM as it was."""
    before = signal.getsignal(signal.SIGTERM)
    yield
    signal.signal(signal.SIGTERM, before)


def test_sigterm_interrupts_within_the_context_alone():
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    with pytest.raises(KeyboardInterrupt), terminated_like_interrupted():
        signal.raise_signal(signal.SIGTERM)
    assert signal.getsignal(signal.SIGTERM) is signal.SIG_DFL


def _follow(ready):
    follow_parent()
    ready.set()
    threading.Event().wait()


def test_sigterm_ends_a_process_of_a_command_that_handles_it():
    # A forked process inherits the handler: with it, it would print an interrupt of its own.
    context = multiprocessing.get_context("fork")
    ready = context.Event()
    with terminated_like_interrupted():
        process = context.Process(target=_follow, args=(ready,), daemon=True)
        process.start()
        assert ready.wait(10.0)
        os.kill(process.pid, signal.SIGTERM)
        process.join(10.0)
    assert process.exitcode == -signal.SIGTERM
