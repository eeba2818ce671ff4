"""Whether the fields of a dataclass from a file of the user are of the types that it declares:
Python itself does not look.
"""

import dataclasses
import functools
import numbers
import types
import typing
from collections.abc import Mapping
from reprlib import repr as shortened
from typing import Any


def type_fault(value: Any, prefix: str = "") -> str:
    """Return what is wrong with the first field of another type than declared, and the remedy;
    empty if there is none.

    A list will do for a tuple of any length, and any real number for a float.

    Parameters
    ----------
    value : a dataclass of text, numbers, paths, other dataclasses, tuples of these, and what may be
        None
    prefix : of the names of its fields, such as ``envelope.``
    """
    kind: Any = type(value)
    hints = _hints(kind)
    faults = (
        _fault(getattr(value, f.name), hints[f.name], f"{prefix}{f.name}")
        for f in dataclasses.fields(value)
    )
    return next(filter(None, faults), "")


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _fault(value: Any, kind: Any, name: str) -> str:
    arguments = typing.get_args(kind)
    if typing.get_origin(kind) in (typing.Union, types.UnionType):
        (other,) = (argument for argument in arguments if argument is not types.NoneType)
        return "" if value is None else _fault(value, other, name)
    if arguments:
        return _tuple_fault(value, kind, arguments, name)
    if kind is float:
        return (
            ""
            if isinstance(value, numbers.Real) and not isinstance(value, bool)
            else _told(value, "a number", name)
        )
    if not isinstance(value, kind):
        return _told(value, {str: "text"}.get(kind, f"of type {kind.__name__}"), name)
    return type_fault(value, f"{name}.") if dataclasses.is_dataclass(kind) else ""


def _tuple_fault(value: Any, kind: Any, arguments: tuple[Any, ...], name: str) -> str:
    of_any_length = arguments[1:] == (...,)
    if not isinstance(value, (tuple, list) if of_any_length else tuple) or not (
        of_any_length or len(value) == len(arguments)
    ):
        return _told(value, f"of type {kind}".replace("aircraft.spec.", ""), name)
    kinds = [arguments[0]] * len(value) if of_any_length else arguments
    return next(
        filter(None, (_fault(item, kinds[i], f"{name}[{i}]") for i, item in enumerate(value))), ""
    )


def _told(value: Any, demanded: str, name: str) -> str:
    remedy = ""
    if isinstance(value, Mapping):
        remedy = f", as {shortened(tuple(value.items()))}"
    elif isinstance(value, str) and "tuple" in demanded:
        remedy = f", which of one item has a comma: ({shortened(value)},)"
    return f"{name} is {' '.join(shortened(value).split())}, of type {type(value).__name__}; it must be {demanded}{remedy}"
