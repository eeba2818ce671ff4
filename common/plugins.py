"""What a user's part does wrong, in one line that names it: ``call_plugin()`` calls it.

A part is a user's steering law, shape, track, plume, instrument, search method, exporter, study, or
the file that it stands in. Where it fails in flight, the flight is a row with this line.
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
"""Packages whose classes are no user's, and whose lines are not where a part has failed."""

PASSED_ON = (RefusedError, MemoryError)
"""Errors that say by themselves what is wrong, or do not come from the part."""

_SHOWN = 80
"""Letters of a result that a message shows at most."""


def passed(found: Any) -> Any:
    """Return what it is given."""
    return found


def call_plugin(
    part: str,
    method: Callable[..., Any],
    *given: Any,
    result: Callable[[Any], Result] = passed,
    **named: Any,
) -> Result:
    """Return what a method of a part returns.

    Parameters
    ----------
    part : its kind or key, and its name, as in ``vessel.track 'mytrack.py:Weaving'``
    method : of the part, or its class; called with ``given`` and ``named``
    result : returns what the method has returned, converted if need be; raises a ``ValueError`` or
        ``TypeError`` that says in words what it has to be

    Raises
    ------
    PluginError : the method failed, or returned something else
    RefusedError : the part refuses its input by itself
    """
    try:
        found = method(*given, **named)
    except PASSED_ON:
        raise
    # A part that ends the process must not end the command without a word.
    except (Exception, SystemExit) as error:
        raise explained(part, method, error, *given) from error
    return check_result(f"{part}: {_called(method, given)} returned", found, result)


def check_result(what: str, found: Any, result: Callable[[Any], Result]) -> Result:
    """Return what a part returned or declares, converted by ``result`` as in ``call_plugin``.

    Parameters
    ----------
    what : it is, with a verb, as in ``payload 'mymeter.py:Meter': COLUMNS is``
    found, result : same as ``call_plugin``

    Raises
    ------
    PluginError : it is something else
    """
    try:
        return result(found)
    except (TypeError, ValueError) as error:
        raise rejected_result(what, found, str(error)) from None


def explained(
    part: str, method: Callable[..., Any], error: BaseException, *given: Any
) -> PluginError:
    """Return the error that says in one line what a method of a part has raised, and where."""
    # The first frame is that of the call.
    frames = [
        frame
        for frame in traceback.extract_tb(error.__traceback__)[1:]
        if not frame.filename.startswith(("<", _LIBRARY)) or "site-packages" in frame.filename
    ]
    # The first file outside of the project is the part's; it may call other packages.
    own = [frame for frame in frames if not _is_of_project(frame.filename)]
    lines = [frame for frame in own if frame.filename == own[0].filename] or frames
    where = f" ({Path(lines[-1].filename).name}:{lines[-1].lineno})" if lines else ""
    what = f"{type(error).__name__}: {error}"
    return PluginError(one_line(f"{part}: {_called(method, given)} failed: {what}{where}"))


def rejected_result(what: str, found: object, must: str) -> PluginError:
    """Return the error of a result that is of no use; ``must`` says in words what it has to be."""
    shown = one_line(repr(found))
    shown = shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."
    return PluginError(f"{what} {shown}; it has to be {must}")


def is_users(part: object) -> bool:
    """Return whether an object is of a class from outside the project's rooms."""
    return type(part).__module__.partition(".")[0] not in ROOMS


def number(what: str) -> Callable[[Any], float]:
    """Return what makes a finite float of a part's result; ``what`` it is, with its unit."""
    words = f"a finite number, {what}"

    def made(found: Any) -> float:
        try:
            (value,) = numbers(1, what)((found,))
        except ValueError:
            raise ValueError(words) from None
        return value

    return made


def numbers(count: int, what: str, *, finite: bool = True) -> Callable[[Any], tuple[float, ...]]:
    """Return what makes a tuple of so many numbers of a part's result, finite if need be; ``what``
    they are, in words, with their units.
    """
    words = f"{count} {'finite ' * finite}number{'s' * (count != 1)}, {what}"

    def made(found: Any) -> tuple[float, ...]:
        try:
            # Text is a row of letters, and a letter may be a digit.
            values = [float(value) for value in found if not isinstance(value, str)]
        except (TypeError, ValueError):
            values = []
        if len(values) != count or (finite and not all(map(math.isfinite, values))):
            raise ValueError(words)
        return tuple(values)

    return made


def _called(method: Callable[..., Any], given: tuple[Any, ...]) -> str:
    """Return a call in words: the name of the method, with numbers that it is given."""
    name = getattr(method, "__name__", type(method).__name__)
    times = () if isinstance(method, type) else given
    shown = ", ".join(f"{of:.6g}" for of in times if type(of) in (int, float))
    return f"{name}({shown})"


def _is_of_project(file: str) -> bool:
    path = Path(file)
    return path.is_relative_to(_PROJECT) and path.relative_to(_PROJECT).parts[0] in ROOMS
