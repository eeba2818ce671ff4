"""The text of ``plume-flight describe`` on keys and sections."""

import re
import textwrap
from collections.abc import Iterator
from itertools import groupby

from scenarios.errors import InputError
from scenarios.scenario.documentation import (
    EXTENDS,
    PART_SECTIONS,
    DocumentedKey,
    DocumentedSection,
    documented_keys,
    documented_part_keys,
    documented_sections,
    file_kinds,
    similar_key,
)
from scenarios.scenario.overrides import as_toml
from scenarios.scenario.sections.experiment import TrialList

_WIDTH = 100
_INDENT = 10
_TOP = "(top)"
"""What the section of the keys outside of any section is called."""


def described(name: str | None = None) -> list[str]:
    """Return the description of a key or a section; without a name, the list of sections.

    Parameters
    ----------
    name : a dotted key, as wind.speed_mps, or a section, as wind, or (top); the index of an entry
        of a list may be left out

    Raises
    ------
    InputError : there is no such key or section
    """
    if name is None:
        return list(_all_sections())
    if name == "extends":
        return [name, *_wrapped("  ", EXTENDS)]
    if name in (_TOP, _TOP.strip("()")):
        return list(_section(documented_sections()[0]))
    plain = re.sub(r"\.\d+(?=\.|$)", "", name)
    # Swept keys have their own descriptions, and only sweep has the key nu.
    plain = plain.removeprefix("sweep.")
    tables = (key.key for key in documented_keys() if key.range.endswith(" a table"))
    if table := next((table for table in tables if plain.startswith(f"{table}.")), None):
        note = (
            f"{name} is a key of the table that {table} may be; docs/howto/measuring.md lists its"
            " keys, with their units."
        )
        return [*_wrapped("", note), *described(table)]
    keys = [
        key
        for key in documented_keys()
        if key.key.replace(".0", "") == plain or (plain == "nu" and key.key == "sweep")
    ]
    kinds = (documented_sections(kind) for kind in file_kinds() if kind is not TrialList)
    sections = next(
        filter(
            None,
            (
                [of for of in each if of.name and of.name.replace(".0", "") == plain]
                for each in kinds
            ),
        ),
        [],
    )
    if not keys and not sections:
        guess = similar_key(plain)
        remedy = f"did you mean '{guess}'?" if guess else "plume-flight describe lists the sections"
        if plain.partition(".")[0] in PART_SECTIONS and "." in plain:
            remedy += " A key of a part of your own (FILE.py:NAME) is described in its file."
        raise InputError(f"unknown key '{name}'; {remedy}")
    lines = [line for section in sections for line in (*_section(section), *_of_parts(section))]
    return [*lines, *(line for key in keys for line in _key(key))]


def value_text(value: object) -> str:
    """Return a value as a scenario file has it; "not set" for none."""
    return "not set" if value is None else as_toml(value)


def _all_sections() -> Iterator[str]:
    yield from _wrapped(
        "",
        "Sections of a scenario file, and how many keys each has; plume-flight describe SECTION"
        " lists them:",
    )
    for section in documented_sections():
        yield from _wrapped(
            f"{section.name.replace('.0', '') or _TOP:<21} {len(section.keys):>3}  ",
            _meaning(section),
        )


def _meaning(section: DocumentedSection) -> str:
    return (
        section.meaning if section.name else "Keys outside of any section, at the top of the file."
    )


def _section(section: DocumentedSection) -> Iterator[str]:
    entries = "A list, each entry with these keys. " if section.listed else ""
    name = f"[{section.name.replace('.0', '')}]" if section.name else _TOP
    yield from _wrapped("", f"{name} {entries}{_meaning(section)}")
    yield from (line for key in section.keys for line in _entry(key))


def _entry(key: DocumentedKey) -> list[str]:
    default = "required" if key.required else value_text(key.default)
    # A criterion that is off has no number, and so no unit.
    unit = (
        f" {key.unit}"
        if key.unit not in ("", "-") and not (key.default is None or key.default is False)
        else ""
    )
    return _wrapped(f"  {key.key.rpartition('.')[2]:<28} {default}{unit}  ", key.meaning)


def _of_parts(section: DocumentedSection) -> Iterator[str]:
    """Yield the keys of the parts that a section names."""
    for part, keys in groupby(documented_part_keys(), key=lambda key: key.conditions):
        listed = [key for key in keys if key.key.partition(".")[0] == section.name]
        if listed:
            yield from _wrapped("", f"With {' or '.join(part)} also:")
            yield from (line for key in listed for line in _entry(key))


def _key(key: DocumentedKey) -> Iterator[str]:
    yield key.key
    about = {
        "": key.meaning,
        "value": key.range,
        "unit": key.unit,
        "default": "none: it has to be given" if key.required else value_text(key.default),
        "studies": ", ".join(key.studies),
    }
    for name, text in about.items():
        if text:
            yield from _wrapped(f"  {name:<{_INDENT}}" if name else "  ", text)
    for condition in key.conditions:
        yield from _wrapped(f"  {'acts with':<{_INDENT}}", condition)


def _wrapped(before: str, text: str) -> list[str]:
    return textwrap.wrap(
        f"{before}{text}",
        _WIDTH,
        subsequent_indent=" " * min(len(before), 32),
        drop_whitespace=True,
    ) or [before]
