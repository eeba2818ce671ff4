"""Simulation at the pace of the clock, for those who watch."""

import time
from collections.abc import Callable


def paced(run: Callable[[], object], time_step: float) -> Callable[[], object]:
    """Return what advances a simulation by a time step [s], and then waits for the clock where that
    is behind.

    A simulation that falls behind catches up as fast as it can.
    """
    began, steps = time.monotonic(), 0

    def waiting() -> object:
        nonlocal steps
        result = run()
        steps += 1
        if (ahead := steps * time_step - (time.monotonic() - began)) > 0.0:
            time.sleep(ahead)
        return result

    return waiting
