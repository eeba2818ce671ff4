"""The dotted keys that a schema knows."""

import typing
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from pydantic import BaseModel, RootModel
from pydantic.fields import FieldInfo

from common.dotted_keys import at_or_below
from common.spelling import nearest

_SPEEDS = {"vessel.speed_mps", "vessel.speed_ratio"}
"""Keys that give the vessel's speed, each in its own way."""


def known_keys(kind: type[BaseModel]) -> list[str]:
    """Return every dotted key of a schema, sections included; an entry of a list of sections has the index 0."""
    keys: list[str] = []
    if issubclass(kind, RootModel):
        return keys
    for name, field in kind.model_fields.items():
        keys.append(name)
        for model, listed in models_in(field.annotation):
            keys += [f"{name}.0.{key}" if listed else f"{name}.{key}" for key in known_keys(model)]
    return keys


def key_parts(kind: type[BaseModel], dotted: str) -> list[str]:
    """Return the parts of a dotted key; a section that has keys of other sections, such as sweep, takes the rest whole."""
    parts = dotted.split(".")
    model: type[BaseModel] = kind
    for depth, part in enumerate(parts[:-1], start=1):
        field = None if part.isdecimal() else model.model_fields.get(part)
        found = next(models_in(field.annotation), None) if field else None
        if found is None:
            break
        model = found[0]
        if issubclass(model, RootModel):
            return [*parts[:depth], ".".join(parts[depth:]).strip('"')]
    return parts


def displaced(key: str, given: Iterable[str]) -> bool:
    """Return whether what varies a dotted key gives way to given keys: to the key itself, to one above it, or, for the vessel's
    speed and its speed ratio, to the other one of the two.
    """
    return any(at_or_below(key, of) or {key, of} == _SPEEDS for of in given)


def suggestion(kind: type[BaseModel], key: str) -> str:
    """Return the end of the message about an unknown key: the most similar known key, or the known keys of its section."""
    *parents, last = key.split(".")
    section = ["0" if part.isdecimal() else part for part in parents]
    known = [name.split(".") for name in known_keys(kind)]
    siblings = [name[-1] for name in known if name[:-1] == section]
    # A key without its section, such as speed_mps, is likelier than another key that is spelt similarly.
    found = [".".join(name) for name in known if name[-1] == last and "0" not in name] if not parents else []
    if not found and (close := nearest(last, siblings)):
        found = [".".join([*parents, close])]
    if found:
        return f"; did you mean {' or '.join(map(repr, found))}?"
    where = f"in {'.'.join(parents)} " if parents else ""
    return f"; known {where}are {', '.join(siblings)}" if siblings else ""


def entry_model(kind: type[BaseModel], parts: Sequence[str]) -> type[BaseModel] | None:
    """Return the schema of the entries of the list that a key names; None if it is not a list of sections."""
    found: tuple[type[BaseModel], bool] | None = kind, False
    for part in parts:
        if found and not part.isdecimal():
            field = found[0].model_fields.get(part)
            found = next(models_in(field.annotation), None) if field else None
    return found[0] if found and found[1] else None


def example_value(field: FieldInfo) -> object:
    """Return a value that a required key of an entry may have: only to show how it is written."""
    return field.examples[0] if field.examples else "name" if field.annotation is str else 100


def models_in(annotation: Any) -> Iterator[tuple[type[BaseModel], bool]]:
    """Yield the schemas in a type, each with whether they are the entries of a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, False
    listed = typing.get_origin(annotation) in (tuple, list)
    for part in typing.get_args(annotation):
        for model, inside in models_in(part):
            yield model, listed or inside
