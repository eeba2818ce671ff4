"""Changes to a scenario document: ``--set key=value`` with dotted keys, and the keys that a
document sets.
"""

import json
import re
import tomllib
from collections.abc import Callable, Iterable, Mapping
from datetime import datetime
from typing import Any

from pydantic import BaseModel, RootModel

from common.text import at_or_below
from scenarios.errors import InputError
from scenarios.scenario.errors import entry_model, models_in, shown
from scenarios.scenario.sections.experiment import SPEED_KEYS, swept_key

Document = dict[str, Any]
"""A scenario as read from TOML, before it is checked."""

_RATIO, _SPEED = "vessel.speed_ratio", "vessel.speed_mps"


def parse_override(override: str) -> tuple[str, object]:
    """Return key and value of ``key=value``, the value in TOML; a bare word is a string.

    Raises
    ------
    InputError : no equals sign, or a list or table that is not valid TOML
    """
    key, equals, text = override.partition("=")
    if not equals or not key.strip():
        raise InputError(
            f"--set '{override}' is not of the form key=value, e.g. --set guidance.preview=false"
        )
    key, start = key.strip(), shown(text.strip())
    if key == "extends":
        raise InputError(f"--set '{override}': extends stands in a scenario file alone")
    try:
        document = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError as error:
        if text.strip().startswith(("[", "{")):
            raise InputError(
                f"--set {key}={start} is not valid TOML: {error}; words in a list are quoted"
            ) from None
        return key, text
    except (RecursionError, ValueError):
        # Python's parser fails at thousands of brackets or digits.
        raise InputError(f"--set {key}={start} has too many brackets or digits") from None
    value = document.pop("value")
    if document:
        raise InputError(
            f"--set {key}={start}: a line break, and {next(iter(document))!r} after it; give each"
            " key a --set of its own"
        )
    return key, value


def displaced(key: str, given: Iterable[str]) -> bool:
    """Return whether a given key replaces the variation of a dotted key: the key itself, its
    section, or, for the vessel's speed and its speed ratio, the other of the two.
    """
    return any(at_or_below(key, of) or {key, of} == SPEED_KEYS for of in given)


def apply_override(document: Document, key: str, value: object, kind: type[BaseModel]) -> None:
    """Set a key for every flight of a document: cases, sweep and random variables no longer set it
    or a key inside it.

    If the vessel's speed is set and the speed ratio is swept, ``effect`` refuses the document
    later.

    Parameters
    ----------
    document : changed in place
    key, value : the dotted key and its new value
    kind : schema of the document

    Raises
    ------
    InputError : as in ``set_value``
    """
    given = document.get("cases")
    cases = [case for case in given if isinstance(case, dict)] if isinstance(given, list) else []
    tables = [
        case[name]
        for case in cases
        for name in ("set", "set_kinematic")
        if isinstance(case.get(name), dict)
    ]
    setting = [values for values in tables if key in values]
    if setting and key.startswith("sweep."):
        # Cases have a speed ratio each, and no sweep beside them.
        for values in setting:
            values[key] = value
        return
    set_value(document, key, value, kind)
    for values in tables:
        for name in [
            name for name in values if displaced(swept_key(name.removeprefix("sweep.")), [key])
        ]:
            del values[name]
    if isinstance(swept := document.get("sweep"), dict):
        document["sweep"] = _without(swept, lambda name: _ends_sweep(key, swept_key(name)))
    if key != "draws":
        _take_out_of_draws(document, _set_or_swept(key, value))


def _take_out_of_draws(document: Document, keys: list[str]) -> None:
    """Remove the draws of keys, and of keys inside them, from a document, in place."""
    draws = document.get("draws")
    if isinstance(draws, list):
        document["draws"] = [
            draw
            for draw in draws
            if not (isinstance(draw, dict) and displaced(str(draw.get("key")), keys))
        ]


def _ends_sweep(key: str, swept: str) -> bool:
    return displaced(swept, [key]) and (key, swept) != (_SPEED, _RATIO)


def _set_or_swept(key: str, value: object) -> list[str]:
    """Return the keys of flights that an override sets or sweeps."""
    section, _, rest = key.partition(".")
    if section != "sweep":
        return [key]
    tables = {rest.strip('"'): value} if rest else value
    return [swept_key(name) for name in given_keys(tables)] if isinstance(tables, dict) else []


def _without(values: Document, left_out: Callable[[str], bool], before: str = "") -> Document:
    """Return a sweep without some dotted keys, which may be written as nested tables."""
    rest: Document = {}
    for name, value in values.items():
        if isinstance(value, dict):
            if below := _without(value, left_out, f"{before}{name}."):
                rest[name] = below
        elif not left_out(f"{before}{name}"):
            rest[name] = value
    return rest


def tabled(document: Document) -> Document:
    """Replace the short form of the payload, a list of instruments, by a table, in place, so that
    other keys can be added.
    """
    if isinstance(names := document.get("payload"), list | tuple):
        document["payload"] = {"instruments": names}
    return document


def set_value(document: Document, dotted: str, value: object, kind: type[BaseModel]) -> None:
    """Set a dotted key of a document in place; numbers in it are indices of lists.

    Raises
    ------
    InputError : the key goes through a value that is not a table, or to an entry that a list does
        not have
    """
    parts = _parts(kind, dotted)
    section: Any = tabled(document)
    for depth, name in enumerate(parts[:-1]):
        key: Any = _index(section, parts, depth, kind) if isinstance(section, list) else name
        if isinstance(section, dict):
            is_list = parts[depth + 1].isdecimal() and entry_model(kind, parts[: depth + 1])
            if is_list and not section.get(name):
                section[name] = []
            section.setdefault(name, {})
        if isinstance(section[key], tuple):
            section[key] = list(section[key])
        section = section[key]
        if not isinstance(section, dict | list):
            raise InputError(f"unknown key '{dotted}'; '{name}' is a value, not a section")
    last = len(parts) - 1
    section[_index(section, parts, last, kind) if isinstance(section, list) else parts[last]] = (
        value
    )


def _parts(kind: type[BaseModel], dotted: str) -> list[str]:
    """Return the parts of a dotted key. After a section such as sweep, which contains keys of other
    sections, the rest is one part.
    """
    section, _, rest = dotted.partition(".")
    field = kind.model_fields.get(section)
    of_others = field and any(issubclass(of, RootModel) for of, _ in models_in(field.annotation))
    return [section, rest.strip('"')] if rest and of_others else dotted.split(".")


def _index(entries: list[Any], parts: list[str], depth: int, kind: type[BaseModel]) -> int:
    """Return the index that a part of a dotted key names.

    Raises
    ------
    InputError : the list has no such entry
    """
    name, above = parts[depth], ".".join(parts[:depth])
    if name.isdecimal() and int(name) < len(entries):
        return int(name)
    message = (
        f"unknown key '{'.'.join(parts)}'; {above} has {len(entries)} entries, numbered from 0"
    )
    if not entries and (model := entry_model(kind, parts[:depth])):
        needed = [key for key, field in model.model_fields.items() if field.is_required()]
        message += (
            f": add one, as in --set '{above}=[{{{', '.join(f'{of}=...' for of in needed)}}}]'"
        )
    raise InputError(message)


def as_toml(value: object) -> str:
    """Return a value in the form that ``key=value`` needs: on one line.

    Raises
    ------
    InputError : TOML cannot express the value
    """
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, datetime):
        return value.isoformat()
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(as_toml, value))}]"
    if isinstance(value, Mapping):
        entries = (f"{_toml_key(str(key))}={as_toml(item)}" for key, item in value.items())
        return f"{{{', '.join(entries)}}}"
    raise InputError(
        f"value is {shown(value)}; a scenario has numbers, words, truth values, times, lists and"
        " tables alone"
    )


def _toml_key(key: str) -> str:
    """Return a key as TOML writes it in a table: a key with a dot has quotation marks."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key, ensure_ascii=False)


def extended(base: Document, own: Document) -> Document:
    """Return a document that extends another one, as ``merged``.

    A key that ``own`` sweeps is no longer one that ``base`` samples.
    """
    result = merged(base, own)
    if "draws" not in own and "sweep" in own:
        _take_out_of_draws(result, _set_or_swept("sweep", own["sweep"]))
    return result


def merged(base: Mapping[str, Any], own: Mapping[str, Any]) -> Document:
    """Return ``base`` extended by ``own``: tables are merged key by key, other values of ``own``
    replace those of ``base``.
    """
    result = dict(base)
    for key, value in own.items():
        below = result.get(key)
        result[key] = (
            merged(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
        )
    return result


def given_keys(document: Mapping[str, Any]) -> set[str]:
    """Return the dotted keys that a document itself sets; a list, and an empty table, count as one
    key.
    """
    keys: set[str] = set()
    for key, value in document.items():
        below = given_keys(value) if isinstance(value, Mapping) else set()
        keys |= {f"{key}.{name}" for name in below} or {key}
    return keys
