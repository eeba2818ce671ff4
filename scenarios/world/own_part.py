"""Parts of a user's own: what they raise, and answers that are of no use, are told with the part,
its method and the remedy.
"""

import math
import sys
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from aircraft.spec import AircraftError
from common.registry import PluginError
from common.text import one_line
from gnc.errors import InfeasibleError, LawError
from gnc.reference import builtin_floats
from measurement.errors import MeasurementError
from scenarios.errors import InputError

Answer = TypeVar("Answer")

_TOLD = (
    AircraftError,
    InfeasibleError,
    InputError,
    LawError,
    MeasurementError,
    MemoryError,
    PluginError,
)
"""Errors that say themselves what is wrong, or do not come from the part."""

_OTHERS = ("<", builtin_floats.__file__)
"""Files of frames that are not of a part: text of dataclasses, and what passes calls on to a shape.
"""

_SHOWN = 80
"""Letters of an answer that a message shows at most."""


def is_own(part: object) -> bool:
    """Return whether an object is a part of a user's own: of a class from outside the project."""
    return not type(part).__module__.startswith(("scenarios.", "gnc."))


def asked(
    part: str,
    doing: str,
    called_with: str,
    method: Callable[..., Answer],
    *given: Any,
    **named: Any,
) -> Answer:
    """Return what a part answers.

    Parameters
    ----------
    part : its key and name, as in ``vessel.track 'mytrack.py:Weaving'``
    doing : what it does, as in ``cannot be made`` or ``failed in motion(0)``
    called_with : what ``method`` is called with, in words
    method : of the part, called with ``given`` and ``named``

    Raises
    ------
    PluginError : the part raised what does not say by itself what is wrong
    """
    try:
        return method(*given, **named)
    except _TOLD:
        raise
    except Exception as error:
        # The first frame is this function's: without another one the call itself has failed.
        frames = [
            frame
            for frame in traceback.extract_tb(error.__traceback__)[1:]
            if not frame.filename.startswith(_OTHERS)
        ]
        own = [frame for frame in frames if frame.filename == _file_of(method)] or frames
        where = (
            f" ({Path(own[-1].filename).name}:{own[-1].lineno})"
            if frames
            else f"; it is called with {called_with}"
        )
        raise PluginError(
            one_line(f"{part} {doing}: {type(error).__name__}: {error}{where}")
        ) from error


def _file_of(method: Callable[..., object]) -> str | None:
    """Return the file of a method, or of a class, whose line says more than one in what it calls."""
    file: str | None = getattr(sys.modules.get(getattr(method, "__module__", "")), "__file__", None)
    return file


def refuse_answer(part: str, method: str, answer: object, must: str) -> None:
    """Refuse what a part answered; ``must`` says in words what its method has to return.

    Raises
    ------
    PluginError : always
    """
    shown = one_line(repr(answer))
    shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."
    raise PluginError(f"{part}: {method} returned {shown}; it has to return {must}")


def is_number(answer: Any, *, finite: bool = True) -> bool:
    """Return whether an answer is a number, of any kind that Python takes for one, and finite
    unless it may be not.
    """
    try:
        return math.isfinite(answer) or not finite
    except (TypeError, ValueError, OverflowError):
        return False


def are_numbers(answer: Any, count: int, *, finite: bool = True) -> bool:
    """Return whether an answer is a row of so many numbers."""
    try:
        return len(answer) == count and all(is_number(value, finite=finite) for value in answer)
    except TypeError:
        return False
