"""The dotted keys of a schema, and the error of a document in one line."""

import re
import typing
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel, RootModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from common.text import did_you_mean, nearest

_UNION_MEMBER = re.compile(r"constrained-\w+|literal\[.*\]|function-.*")
"""What pydantic adds to the place of an error in a value of several types."""

_LENGTH_MAX = 80
"""Most letters of a value that a message shows."""


_SHORT = {"nu": "'sweep.nu' or 'vessel.speed_ratio'"}
"""Short words that are no keys, and the keys that are meant."""


def known_keys(kind: type[BaseModel]) -> list[str]:
    """Return every dotted key of a schema, sections included; an entry of a list of sections has
    the index 0.
    """
    keys: list[str] = []
    if issubclass(kind, RootModel):
        return keys
    for name, field in kind.model_fields.items():
        keys.append(name)
        # The keys of a section that may be a list are those of its entries.
        several = may_stand_several_times(field)
        for model, listed in models_in(field.annotation):
            if not (several and listed):
                above = f"{name}.0" if listed else name
                keys += [f"{above}.{key}" for key in known_keys(model)]
    return keys


def may_stand_several_times(field: FieldInfo) -> bool:
    """Return whether a section may be given as a table or as a list of tables."""
    return {False, True} <= {listed for _, listed in models_in(field.annotation)}


def without_indices(key: str) -> str:
    """Return a dotted key without the numbers of entries."""
    return ".".join(part for part in key.split(".") if not part.isdecimal())


def models_in(annotation: Any) -> Iterator[tuple[type[BaseModel], bool]]:
    """Yield the schemas in a type, each with whether they are the entries of a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation, False
    listed = typing.get_origin(annotation) in (tuple, list)
    for part in typing.get_args(annotation):
        for model, inside in models_in(part):
            yield model, listed or inside


def fields_along(kind: type[BaseModel], parts: Sequence[str]) -> Iterator[FieldInfo | None]:
    """Yield the field of each part of a key, without the indices of lists; None for a part that the
    schema does not have.
    """
    model: type[BaseModel] | None = kind
    for part in parts:
        if not part.isdecimal():
            field = model.model_fields.get(part) if model else None
            yield field
            model = next(models_in(field.annotation), (None, False))[0] if field else None


def entry_model(kind: type[BaseModel], parts: Sequence[str]) -> type[BaseModel] | None:
    """Return the schema of the entries in the list with this key; None if the key is not a list of
    sections.
    """
    *_, field = fields_along(kind, parts)
    found = models_in(field.annotation) if field else ()
    return next((model for model, listed in found if listed), None)


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


def suggestion(kind: type[BaseModel], key: str) -> str:
    """Return the end of the message about an unknown key: the most similar known key, or the known
    keys of its section.
    """
    if key in _SHORT:
        return f"; did you mean {_SHORT[key]}?"
    *parents, last = key.split(".")
    section = ["0" if part.isdecimal() else part for part in parents]
    known = [name.split(".") for name in known_keys(kind)]
    # Keys of a section that may be a list are known without a number, too.
    alone = [part for part in section if part != "0"]
    siblings = [name[-1] for name in known if name[:-1] == section] or [
        name[-1] for name in known if name[:-1] == alone
    ]
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


def explanation(error: ValidationError, kind: type[BaseModel]) -> str:
    """Return the error of a document in one line: the first wrong key, its value, the limit in
    pydantic's words with the key's unit, and the number of further wrong keys.
    """
    entries = error.errors()
    key, others = key_of(entries[0]), {key_of(entry) for entry in entries[1:]}
    # A value of several types is wrong for each of them.
    texts = [_text(entry) for entry in entries if key_of(entry) == key]
    more = len(others - {key})
    also = f" (and {more} more key{'s' * (more > 1)})" if more else ""
    return f"{_explained(key, entries[0], ', or '.join(texts), kind)}{also}"


def key_of(entry: ErrorDetails) -> str:
    """Return the dotted key that an entry of a validation error is about, without pydantic's names
    for the types of a union.
    """
    parts = [str(part) for part in entry["loc"]]
    return ".".join(parts[:-1] if _UNION_MEMBER.fullmatch(parts[-1]) else parts) if parts else ""


def _explained(key: str, entry: ErrorDetails, text: str, kind: type[BaseModel]) -> str:
    """Return the error of a key, from pydantic's message ``text``."""
    value = entry["input"]
    match entry["type"]:
        case "extra_forbidden":
            return f"unknown key '{key}'{suggestion(kind, key)}"
        case "missing":
            return f"key '{key}' is missing"
        case "value_error":
            return _of_section(key, text, value)
        case "literal_error":
            meant = did_you_mean(str(value), re.findall(r"'([^']+)'", text))
            return f"{key} is {shown(value)}{meant or ';'} {text}"
    *_, field = fields_along(kind, key.split("."))
    unit = split_unit(line(field.description or ""))[1] if field else ""
    return f"{key} is {shown(value)}; {text}{f' [{unit}]' if unit not in ('', '-') else ''}"


def _text(entry: ErrorDetails) -> str:
    text = entry["msg"].removeprefix("Value error, ")
    return text if entry["type"] == "value_error" else f"{text[:1].lower()}{text[1:]}"


def shown(value: object) -> str:
    """Return a value for a message, on one line of limited length; a truth value is written as in a
    scenario.
    """
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return text if len(text) <= _LENGTH_MAX else f"{text[:_LENGTH_MAX]}..."


def _of_section(key: str, text: str, section: object) -> str:
    """Return the message of a section's own check after the section's key, or after a key in it if
    the text begins with one.
    """
    if not key or text.startswith("unknown key"):
        return text
    name, found, _ = text.partition(" is ")
    within = bool(found) and isinstance(section, Mapping) and name in section
    return f"{key}.{text}" if within else f"{key}: {text}"
