"""Designs as JSON text: every number comes back to the last bit, and nothing in such a text is
executed.

A dataclass is written as an object of its fields, and read back by the declared types of those
fields; anything else than what they declare is refused.
"""

import dataclasses
import functools
import json
import types
import typing
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from typing import Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

Kind = TypeVar("Kind")

_AS_THEY_ARE = (float, str, bool, int)


def as_text(value: object) -> str:
    """Return a dataclass as JSON text; "not a number" and infinity are written as Python's JSON
    does.
    """
    return json.dumps(value, default=_plain, separators=(",", ":"))


def from_text(text: str, kind: type[Kind]) -> Kind:
    """Return the dataclass ``kind`` that ``as_text`` wrote.

    Raises
    ------
    ValueError : the text is not that of such an object
    """
    try:
        found: Kind = _restored(json.loads(text), kind)
    except (LookupError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(f"not a {kind.__name__}: {error}") from None
    return found


def _plain(value: Any) -> Any:
    """Return what JSON has no notation for as what it has one for."""
    if dataclasses.is_dataclass(value):
        return {field.name: getattr(value, field.name) for field in dataclasses.fields(value)}
    if isinstance(value, np.ndarray):
        # Products of matrices are rounded by the order in which their numbers lie in memory.
        order: Literal["C", "F"] = (
            "F" if value.flags.f_contiguous and not value.flags.c_contiguous else "C"
        )
        return {"shape": value.shape, "order": order, "values": value.ravel(order).tolist()}
    if isinstance(value, Mapping):
        return dict(value)
    return (
        value.value
        if isinstance(value, Enum)
        else value.item()
        if isinstance(value, np.generic)
        else str(value)
    )


@functools.cache
def _hints(kind: type) -> dict[str, Any]:
    return typing.get_type_hints(kind)


def _restored(found: Any, kind: Any) -> Any:
    """Return a value of a type from what JSON has for it."""
    if (
        kind is Any
        or (type(found) is kind and kind in _AS_THEY_ARE)
        or (kind is float and type(found) is int)
    ):
        return found
    arguments = typing.get_args(kind)
    if arguments:
        return _of_parts(found, typing.get_origin(kind), arguments)
    if isinstance(kind, type) and dataclasses.is_dataclass(kind):
        hints = _hints(kind)
        return kind(**{key: _restored(item, hints[key]) for key, item in found.items()})
    if kind is Path or issubclass(kind, Enum):
        return kind(found)
    raise TypeError(f"{found!r} where {kind} is declared")


def _of_parts(found: Any, origin: Any, arguments: tuple[Any, ...]) -> Any:
    """Return a value of a type that is made of others: a tuple, a mapping, an array, or something
    that may be absent.
    """
    if origin is np.ndarray:
        return _array(found)
    if origin in (typing.Union, types.UnionType):
        (kind,) = (argument for argument in arguments if argument is not types.NoneType)
        return None if found is None else _restored(found, kind)
    if origin is tuple:
        kinds = [arguments[0]] * len(found) if arguments[1:] == (...,) else arguments
        return tuple(_restored(item, kind) for item, kind in zip(found, kinds, strict=True))
    return {key: _restored(item, arguments[1]) for key, item in found.items()}


def _array(found: Any) -> npt.NDArray[np.float64]:
    values = np.array(found["values"], dtype=np.float64)
    return values.reshape(found["shape"], order=found["order"])
