"""The dotted keys that a schema knows, and what is wrong with the value of one."""

import json
import re
import typing
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, RootModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from common.text import at_or_below, did_you_mean, nearest
from scenarios.scenario.sections.wrong_value import must_be

_SPEEDS = {"vessel.speed_mps", "vessel.speed_ratio"}
"""Keys that give the vessel's speed, each in its own way."""

_UNION_MEMBER = re.compile(r"constrained-\w+|literal\[.*\]|function-.*")
"""What pydantic adds to the place of an error in a value of several types."""


def known_keys(kind: type[BaseModel]) -> list[str]:
    """Return every dotted key of a schema, sections included; an entry of a list of sections has
    the index 0.
    """
    keys: list[str] = []
    if issubclass(kind, RootModel):
        return keys
    for name, field in kind.model_fields.items():
        keys.append(name)
        for model, listed in models_in(field.annotation):
            keys += [f"{name}.0.{key}" if listed else f"{name}.{key}" for key in known_keys(model)]
    return keys


def key_parts(kind: type[BaseModel], dotted: str) -> list[str]:
    """Return the parts of a dotted key; a section that has keys of other sections, such as sweep,
    takes the rest whole.
    """
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
    """Return whether what varies a dotted key gives way to given keys: to the key itself, to one
    above it, or, for the vessel's speed and its speed ratio, to the other one of the two.
    """
    return any(at_or_below(key, of) or {key, of} == _SPEEDS for of in given)


def suggestion(kind: type[BaseModel], key: str) -> str:
    """Return the end of the message about an unknown key: the most similar known key, or the known
    keys of its section.
    """
    *parents, last = key.split(".")
    section = ["0" if part.isdecimal() else part for part in parents]
    known = [name.split(".") for name in known_keys(kind)]
    siblings = [name[-1] for name in known if name[:-1] == section]
    # A key without its section, such as speed_mps, is likelier than another key that is spelt
    # similarly.
    found = (
        [".".join(name) for name in known if name[-1] == last and "0" not in name]
        if not parents
        else []
    )
    if not found and (close := nearest(last, siblings)):
        found = [".".join([*parents, close])]
    if found:
        return f"; did you mean {' or '.join(map(repr, found))}?"
    where = f"in {'.'.join(parents)} " if parents else ""
    return f"; known {where}are {', '.join(siblings)}" if siblings else ""


def key_of(entry: ErrorDetails) -> str:
    """Return the dotted key that an entry of a validation error is about, without pydantic's names
    for the types of a union.
    """
    parts = [str(part) for part in entry["loc"]]
    return ".".join(parts[:-1] if _UNION_MEMBER.fullmatch(parts[-1]) else parts) if parts else ""


def explanation(error: ValidationError, kind: type[BaseModel]) -> str:
    """Return what is wrong with a document in one line: the first key, its value, the limit, and
    how many other keys are wrong.
    """
    entries = error.errors()
    key, more = key_of(entries[0]), len({key_of(entry) for entry in entries}) - 1
    # A criterion may be false: that it is not judged.
    switch = any(
        key_of(entry) == key and entry["msg"] == "Input should be False" for entry in entries[1:]
    )
    others = f" (and {more} more key{'s' * (more > 1)})" if more else ""
    return f"{_explained(key, entries[0], kind)}{', or false' if switch else ''}{others}"


def _explained(key: str, entry: ErrorDetails, kind: type[BaseModel]) -> str:
    error_type, value = entry["type"], entry["input"]
    if error_type == "extra_forbidden":
        return f"unknown key '{key}'{suggestion(kind, key)}"
    if error_type == "missing":
        *parents, last = key.split(".")
        if last.isdecimal():
            return f"{'.'.join(parents)} has too few values; give one more, as in [400, 800]"
        return f"key '{key}' is missing; add it to the scenario"
    text = entry["msg"].removeprefix("Value error, ")
    where = f"{key}: " if key else ""
    if error_type == "value_error":
        return _own_words(key, text, value)
    if demanded := must_be(entry, key=key, **_of_field(kind, key)):
        return f"{key} is {_shown(value)}; {demanded}"
    remedy = f"; {text[0].lower()}{text[1:]}"
    if error_type == "tuple_type":
        remedy = f"; give a list in brackets, as in {_list_example(kind, key, value)}"
    elif error_type == "too_short":
        remedy = "; give at least one value"
    elif error_type == "model_type":
        remedy = f"; it is a section with keys of its own: set one of them{_example(kind, key)}"
    elif error_type == "literal_error":
        guess = did_you_mean(str(value), re.findall(r"'([^']+)'", text))
        remedy = f"{guess or ';'} it must be {text.removeprefix('Input should be ')}"
    return f"{where}value is {_shown(value)}{remedy}"


def _shown(value: object) -> str:
    """Return a value as a scenario writes it, where that is not as Python does."""
    return str(value).lower() if isinstance(value, bool) else repr(value)


def _own_words(key: str, text: str, section: object) -> str:
    """Return what the project's own checks say of a section, after its key; that of a key in it if
    the text begins with one.
    """
    if not key or text.startswith("unknown key"):
        return text
    word, found, _ = text.partition(" is ")
    within = bool(found) and isinstance(section, Mapping) and word in section
    return f"{key}.{text}" if within else f"{key}: {text}"


def _of_field(kind: type[BaseModel], key: str) -> dict[str, Any]:
    """Return unit and default of a dotted key, as far as the schema has it."""
    field = _field(kind, key.split("."))
    return (
        {"unit": split_unit(line(field.description or ""))[1], "default": field.default}
        if field
        else {}
    )


def _field(kind: type[BaseModel], parts: Sequence[str]) -> FieldInfo | None:
    """Return the field of the parts of a key, if the schema has it."""
    model: type[BaseModel] | None = kind
    field: FieldInfo | None = None
    for part in parts:
        if not part.isdecimal():
            field = model.model_fields.get(part) if model else None
            model = next(models_in(field.annotation), (None, False))[0] if field else None
    return field


def _list_example(kind: type[BaseModel], key: str, value: object) -> str:
    """Return how a list is written: one of sections by what they need, one of two values, of words,
    or of numbers.

    Parameters
    ----------
    value : what was given in its place, of which the example consists if it can
    """
    parts = key.split(".")
    if entry := entry_model(kind, parts):
        needed = {
            name: example_value(field)
            for name, field in entry.model_fields.items()
            if field.is_required()
        }
        return f"[{{ {', '.join(f'{name} = {json.dumps(of)}' for name, of in needed.items())} }}]"
    field = _field(kind, parts)
    lists = (
        [of for of in _with_members(field.annotation) if typing.get_origin(of) is tuple]
        if field
        else []
    )
    members = typing.get_args(lists[0]) if lists else ()
    if any(
        of is str or typing.get_origin(of) is typing.Literal
        for member in members
        for of in _with_members(member)
    ):
        return json.dumps([value if isinstance(value, str) and value else "name"])
    number = isinstance(value, int | float) and not isinstance(value, bool)
    if members and Ellipsis not in members:
        return str([value] * len(members)) if number else "[400, 800]"
    return f"[{value}]" if number else "[0.5] or [400, 800]"


def _with_members(annotation: Any) -> list[Any]:
    """Return a type, and those that it is a union of."""
    return [annotation, *typing.get_args(annotation)]


def split_unit(description: str) -> tuple[str, str]:
    """Split "Meaning [unit]; more." into the meaning and the unit; empty without one."""
    found = re.search(r"\s*\[([^\]]+)\]", description)
    return (
        (description, "")
        if found is None
        else (description[: found.start()] + description[found.end() :], found[1])
    )


def line(text: str) -> str:
    """Return a text of several lines as one, without the marks of a docstring."""
    return " ".join(text.replace("``", "").split())


def _example(kind: type[BaseModel], section: str) -> str:
    """Return the first key of a section as an example, of a section that is not in a list."""
    first = next((key for key in known_keys(kind) if key.startswith(f"{section}.")), "")
    return f", as in {first}=..." if first else ""


def entry_model(kind: type[BaseModel], parts: Sequence[str]) -> type[BaseModel] | None:
    """Return the schema of the entries of the list that a key names; None if it is not a list of
    sections.
    """
    field = _field(kind, parts)
    model, listed = next(models_in(field.annotation), (None, False)) if field else (None, False)
    return model if listed else None


def example_value(field: FieldInfo) -> object:
    """Return a value that a required key of an entry may have: only to show how it is written."""
    if field.examples:
        return field.examples[0]
    return (
        {}
        if typing.get_origin(field.annotation) is dict
        else "name"
        if field.annotation is str
        else 100
    )


def models_in(annotation: Any) -> Iterator[tuple[type[BaseModel], bool]]:
    """Yield the schemas in a type, each with whether they are the entries of a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, False
    listed = typing.get_origin(annotation) in (tuple, list)
    for part in typing.get_args(annotation):
        for model, inside in models_in(part):
            yield model, listed or inside
