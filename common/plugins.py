"""Call users' parts, and report their errors in one line that names the part.

A part is a user's steering law, shape, track, plume, instrument, search method, exporter or study.
If a part fails in flight, the flight's row in the summary has this line.
"""

import math
import sysconfig
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from common.errors import PluginError, RefusedError
from common.text import one_line

Result = TypeVar("Result")

_PROJECT = Path(__file__).parents[1]

_LIBRARY = sysconfig.get_path("stdlib")
"""Folder of Python's own modules."""

ROOMS = ("aircraft", "common", "gnc", "innerloop", "measurement", "reports", "scenarios")
"""The project's packages; a class or a failing line outside of them belongs to a user."""

PASSED_ON = (RefusedError, MemoryError)
"""Errors that are passed on: they explain themselves, or are not the part's fault."""

_SHOWN = 80
"""Largest number of characters of a result in a message."""


def passed(found: Any) -> Any:
    """Return a result unchanged."""
    return found


def call_plugin(
    part: str,
    method: Callable[..., Any],
    *given: Any,
    result: Callable[[Any], Result] = passed,
    **named: Any,
) -> Result:
    """Call a method of a part; return its converted result.

    Parameters
    ----------
    part : kind or key of the part and its name, as in ``vessel.track 'mytrack.py:Weaving'``
    method : method of the part, or its class; called with ``given`` and ``named``
    result : function that converts and returns the method's result; for a wrong result it raises a
        ``ValueError`` or ``TypeError`` that says what the result has to be

    Raises
    ------
    PluginError : the method failed or returned a wrong result
    RefusedError : the part itself refuses its input
    """
    try:
        found = method(*given, **named)
    except PASSED_ON:
        raise
    # A part that raises SystemExit must not end the command without a message.
    except (Exception, SystemExit) as error:
        raise explained(part, method, error, *given) from error
    return check_result(f"{part}: {_called(method, given)} returned", found, result)


def check_result(what: str, found: Any, result: Callable[[Any], Result]) -> Result:
    """Return a result or declaration of a part, converted by ``result`` as in ``call_plugin``.

    Parameters
    ----------
    what : beginning of the message, with a verb, as in ``payload 'mymeter.py:Meter': COLUMNS is``
    found : the result or declaration
    result : same as in ``call_plugin``

    Raises
    ------
    PluginError : the result is wrong
    """
    try:
        return result(found)
    except (TypeError, ValueError) as error:
        raise rejected_result(what, found, str(error)) from None


def explained(
    part: str, method: Callable[..., Any], error: BaseException, *given: Any
) -> PluginError:
    """Return a one-line error that says what a method of a part has raised, and where."""
    # The first frame is the call itself.
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)[1:]
        if not frame.filename.startswith(("<", _LIBRARY)) or "site-packages" in frame.filename
    ]
    # The first file outside of the project belongs to the part; later ones may be other packages.
    own = [frame for frame in frames if not _is_of_project(frame.filename)]
    lines = [frame for frame in own if frame.filename == own[0].filename] or frames
    where = f" ({Path(lines[-1].filename).name}:{lines[-1].lineno})" if lines else ""
    what = f"{type(error).__name__}: {error}"
    return PluginError(one_line(f"{part}: {_called(method, given)} failed: {what}{where}"))


def rejected_result(what: str, found: object, must: str) -> PluginError:
    """Return the error for a wrong result; ``must`` says in words what the result has to be."""
    shown = one_line(repr(found))
    shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."
    return PluginError(f"{what} {shown}; it has to be {must}")


def is_users(part: object) -> bool:
    """Return whether an object's class belongs to a user, not to the project."""
    return type(part).__module__.partition(".")[0] not in ROOMS


def number(what: str) -> Callable[[Any], float]:
    """Return a converter of a result to a finite float; ``what`` names it, with its unit."""
    words = f"a finite number, {what}"

    def converted(found: Any) -> float:
        try:
            (value,) = numbers(1, what)((found,))
        except ValueError:
            raise ValueError(words) from None
        return value

    return converted


def numbers(count: int, what: str, *, finite: bool = True) -> Callable[[Any], tuple[float, ...]]:
    """Return a converter of a result to ``count`` numbers; ``what`` names them, with units."""
    words = f"{count} {'finite ' * finite}number{'s' * (count != 1)}, {what}"

    def converted(found: Any) -> tuple[float, ...]:
        try:
            # Text is iterable as well, and its characters may be digits.
            values = [float(value) for value in found if not isinstance(value, str)]
        except (TypeError, ValueError):
            values = []
        if len(values) != count or (finite and not all(map(math.isfinite, values))):
            raise ValueError(words)
        return tuple(values)

    return converted


def _called(method: Callable[..., Any], given: tuple[Any, ...]) -> str:
    """Return a call as text: the method's name with its numerical arguments."""
    name = getattr(method, "__name__", type(method).__name__)
    times = () if isinstance(method, type) else given
    shown = ", ".join(f"{of:.6g}" for of in times if type(of) in (int, float))
    return f"{name}({shown})"


def _is_of_project(file: str) -> bool:
    path = Path(file)
    return path.is_relative_to(_PROJECT) and path.relative_to(_PROJECT).parts[0] in ROOMS
