"""A complete scenario file with every key, its meaning, unit, range and default, made from another
scenario.
"""

import contextlib
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from scenarios.cli.describe import value_text
from scenarios.errors import InputError
from scenarios.scenario.documentation import (
    DIMENSIONLESS,
    DocumentedKey,
    DocumentedSection,
    documented_part_keys,
    documented_sections,
)
from scenarios.scenario.effect import compares, sections_of, unused
from scenarios.scenario.files import OPERATIONAL, OPERATIONAL_STUDIES, load_document, load_study
from scenarios.scenario.overrides import Document, as_toml
from scenarios.scenario.scenario import Scenario

_WIDTH = 118

_HEAD = """\
Made from {name} by plume-flight new. Fly it with: plume-flight run {file}

Every key is here with its meaning, range and default. A key behind a # is not set: it stands \
there with its default, with what {name} says where these flights do not use it, or without a \
value where it has no default. Remove the # to set it, and \
give it a value. A key that no part of the flights uses is refused, with the part that would use it.
The seeds of flights follow from the name of this file, unless nu is swept: called otherwise it \
has other starts.
For an editor that completes and checks keys: plume-flight schema > scenario.schema.json; then \
the first line of this file is #:schema ./scenario.schema.json
"""


def write_template(path: Path, name: str) -> None:
    """Write a complete scenario file with the values of another scenario; an existing file is not
    changed.

    Parameters
    ----------
    path : of the new file
    name : of the scenario, in the catalog or the path of a file

    Raises
    ------
    InputError : there is no such scenario, or the file is there already or cannot be written
    """
    text = template(name, path.name)
    try:
        with path.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(
            f"'{path}' is there already, and is not overwritten; choose another name"
        ) from None
    except OSError as error:
        # Remove a file that a full disk has truncated, so that the user can try again.
        with contextlib.suppress(OSError):
            path.unlink(missing_ok=True)
        raise InputError(
            f"'{path}' cannot be written: {error.strerror}; choose another path"
        ) from None


def template(name: str, file: str) -> str:
    """Return the text of a complete scenario file.

    Parameters
    ----------
    name : name of the scenario from which it is made
    file : name of the new file
    """
    document, config = load_document(name), load_study(name)
    if isinstance(config, Scenario) and compares(config):
        document, config = _at_swept_ratios(document, config)
    sections = {section.name: section for section in documented_sections(type(config))}
    lines = [*_comment(_HEAD.format(name=name, file=file)), ""]
    if document.get("study") in OPERATIONAL_STUDIES:
        lines += [
            *_comment(
                f"No base: without this line it would extend {OPERATIONAL}, as its study does."
            ),
            "extends = false",
            "",
        ]
    for section in sections.values():
        # A list and its entries are written with their section.
        if not section.listed and ".0." not in section.name:
            lines += _section(section, document, config, sections)
    return "\n".join(lines)


def _at_swept_ratios(document: Document, config: Scenario) -> tuple[Document, Scenario]:
    """Return both documents with only those ratios of ``comparison.nu`` that are swept; a file by
    itself must not name others.
    """
    swept = [nu for nu in config.comparison.nu if nu in config.sweep.nu]
    if not swept:
        return document, config
    comparison = config.comparison.model_copy(update={"nu": tuple(swept)})
    document = {**document, "comparison": {**document["comparison"], "nu": swept}}
    return document, config.model_copy(update={"comparison": comparison})


def _section(
    section: DocumentedSection,
    document: Document,
    config: BaseModel,
    sections: Mapping[str, DocumentedSection],
) -> Iterator[str]:
    values: Any = document.get(section.name, {}) if section.name else document
    if section.name and (entries := sections_of(config, section.name))[1:]:
        # In a list of tables each table is written like a single one.
        for number, (name, _) in enumerate(entries):
            yield from _head(f"[[{section.name}]]", section)
            for key in section.keys:
                own = replace(key, key=f"{name}.{key.key.rpartition('.')[2]}")
                yield from _key(own, values[number], config)
        return
    # A list in place of the section, as for instruments, stands for its first key.
    values = (
        values if isinstance(values, Mapping) else {section.keys[0].key.rpartition(".")[2]: values}
    )
    lists = [
        of
        for of in sections.values()
        if of.listed and of.name.rpartition(".0")[0].rpartition(".")[0] == section.name
    ]
    if section.name:
        yield from _head(f"[{section.name}]", section)
    for key in section.keys:
        if key.key != "sweep":
            yield from _key(key, values, config)
    for of in lists:
        yield from _list(of, values, config)
    yield from _of_parts(section, values, config)
    if not section.name and (
        sweep := next((key for key in section.keys if key.key == "sweep"), None)
    ):
        yield from _sweep(sweep, values)


def _head(brackets: str, section: DocumentedSection) -> Iterator[str]:
    yield from ("", brackets, *_comment(section.meaning), "")


def _sweep(key: DocumentedKey, values: Mapping[str, Any]) -> Iterator[str]:
    yield from ("", "[sweep]", *_comment(key.meaning), '# "wind.speed_mps" = [0.0, 5.0]')
    yield from (
        f"{as_toml(str(name))} = {as_toml(value)}"
        for name, value in values.get("sweep", {}).items()
    )


def _key(key: DocumentedKey, values: Mapping[str, Any], config: BaseModel) -> Iterator[str]:
    name = key.key.rpartition(".")[2]
    default = "has to be given" if key.required else f"default {value_text(key.default)}"
    unit = f" [{key.unit}]" if key.unit not in ("", DIMENSIONLESS) else ""
    yield from _comment(f"{key.meaning} ({key.range}{unit}; {default})")
    if name not in values:
        yield from (
            f"# {name} = {'' if key.default is None else as_toml(key.default)}".rstrip(),
            "",
        )
    elif isinstance(config, Scenario) and unused(config, key.key):
        # It comes from a scenario that this one extends, which may have keys without effect here.
        yield from (f"# {name} = {as_toml(values[name])}", "")
    else:
        yield from (f"{name} = {as_toml(values[name])}", "")


def _list(
    section: DocumentedSection, values: Mapping[str, Any], config: BaseModel
) -> Iterator[str]:
    """Yield a list of tables, an entry on each line."""
    whole = section.name.removesuffix(".0")
    name = whole.rpartition(".")[2]
    yield from _comment(f"{section.meaning} A list, each entry with the keys:")
    for key in section.keys:
        default = "has to be given" if key.required else f"default {value_text(key.default)}"
        unit = f" [{key.unit}]" if key.unit not in ("", DIMENSIONLESS) else ""
        yield from _comment(
            f"{key.key.rpartition('.')[2]}: {key.meaning} ({key.range}{unit}; {default})", "#   "
        )
    entries = values.get(name, ())
    if not entries:
        yield from (f"# {name} = []", "")
        return
    flown = not isinstance(config, Scenario) or not (
        unused(config, whole) or (whole == "comparison.variants" and not compares(config))
    )
    before = "" if flown else "# "
    yield from (
        f"{before}{name} = [",
        *(f"{before}  {as_toml(entry)}," for entry in entries),
        f"{before}]",
        "",
    )


def _of_parts(
    section: DocumentedSection, values: Mapping[str, Any], config: BaseModel
) -> Iterator[str]:
    """Yield the keys of the parts that a section names, beside those of the schema."""
    known = {key.key.rpartition(".")[2] for key in section.keys}
    part = getattr(config, section.name, None) if section.name else None
    own = getattr(part, "law_keys", None) or getattr(part, "part_keys", {})
    documented = {
        key.key: key for key in documented_part_keys() if key.key.rpartition(".")[0] == section.name
    }
    defaults = {key.key.rpartition(".")[2]: key.default for key in documented.values()} | dict(own)
    for name, default in defaults.items():
        if name in known:
            continue
        if key := documented.get(f"{section.name}.{name}"):
            unit = f" [{key.unit}]" if key.unit else ""
            yield from _comment(
                f"{key.meaning} ({key.range}{unit}; of {' or '.join(key.conditions)})"
            )
        value = values.get(name, default)
        shown = f"{name} = {'' if value is None else as_toml(value)}".rstrip()
        yield from (shown if name in values else f"# {shown}", "")


def _comment(text: str, before: str = "# ") -> Iterator[str]:
    for paragraph in text.rstrip().split("\n"):
        yield from textwrap.wrap(
            paragraph, _WIDTH - len(before), initial_indent=before, subsequent_indent=before
        ) or ["#"]
