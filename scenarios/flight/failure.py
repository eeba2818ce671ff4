"""From what stopped a flight to its row."""

import traceback
from pathlib import Path

from common.errors import RefusedError
from common.text import one_line
from gnc.errors import InfeasibleError
from measurement.errors import MeasurementError
from scenarios.engine.task import Row
from scenarios.flight.outcome import Outcome


def failure(error: Exception | SystemExit) -> Row:
    """Return the outcome and the message of a flight that an error ended.

    Raises
    ------
    MemoryError : if that is the error: the same flight may do in a process of its own
    """
    if isinstance(error, MemoryError):
        raise error
    if isinstance(error, InfeasibleError | MeasurementError):
        return unflown(Outcome.INFEASIBLE, str(error))
    message = str(error)
    if not isinstance(error, RefusedError):
        frames = traceback.extract_tb(error.__traceback__)
        # Methods of dataclasses are made from text, and have no file: what called them has.
        where = next(
            (frame for frame in reversed(frames) if not frame.filename.startswith("<")), frames[-1]
        )
        message = f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"
    return unflown(Outcome.FAILED, message)


def unflown(outcome: Outcome, message: str) -> Row:
    """Return the outcome and the message, in one line, of a flight that was not flown or not to its
    end.
    """
    return {"outcome": outcome.value, "message": one_line(message), "criteria_met": False}
