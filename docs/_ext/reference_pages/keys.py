"""Every key of a scenario file, from the schema."""

from collections.abc import Iterator

from pydantic import BaseModel

from reference_pages.markdown import literal, plain, table
from scenarios.cli.describe import value_text
from scenarios.scenario.documentation import (
    DIMENSIONLESS,
    FLIGHT_STUDIES,
    DocumentedKey,
    DocumentedSection,
    documented_part_keys,
    documented_sections,
    file_kinds,
)
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import TrialList

_HEAD = ("key", "default", "value", "meaning")

_INTRODUCTION = """\
# Every key of a scenario

Made from the schema that reads the files. `plume-flight describe KEY` says the same on the console, and
`plume-flight new FILE.toml` writes a scenario with all of them. How sections and studies go together:
[the scenario file](/reference/scenarios.md).

A key is a number in the unit that stands beside its default. *Acts with* names what a key needs to have an effect;
where it has none it is refused.
"""

_TITLES = {Scenario: "Studies of flights", TrialList: "Lists of trials"}


def keys_page() -> str:
    """Return the page."""
    lines = [_INTRODUCTION]
    for kind in file_kinds():
        lines += [f"## {_TITLES.get(kind) or _title(kind)}", ""]
        for section in documented_sections(kind):
            lines += _section(section)
        if kind is Scenario:
            lines += _of_parts()
    return "\n".join(lines)


def _title(kind: type[BaseModel]) -> str:
    """Return the title of a kind of files that a study brings."""
    return f"Studies of {documented_sections(kind)[0].keys[0].studies[0]}"


def _section(section: DocumentedSection) -> Iterator[str]:
    if not section.keys:
        return
    name = section.name.replace(".0", "")
    brackets = f"[[{name}]]" if section.listed else f"[{name}]"
    yield from (f"### {literal(brackets) if name else 'Outside of any section'}", "")
    yield from (plain(section.meaning) if name else "", "")
    yield from table(_HEAD, (_row(key) for key in section.keys))


def _of_parts() -> Iterator[str]:
    yield from ("### Keys of parts", "")
    yield (
        "What a steering law, a plume or an instrument brings to the section that names it. A"
        " part of your own brings its own."
    )
    yield ""
    yield from table(_HEAD, (_row(key) for key in documented_part_keys()))


def _row(key: DocumentedKey) -> tuple[str, ...]:
    unit = f" {plain(key.unit)}" if key.unit not in ("", DIMENSIONLESS) else ""
    default = (
        "required"
        if key.required
        else "not set"
        if key.default is None
        else f"{literal(value_text(key.default))}{unit}"
    )
    range_unit = f" [{plain(key.unit)}]" if unit else ""
    about = [plain(key.meaning)]
    if key.studies and key.studies != FLIGHT_STUDIES and set(key.studies) < set(FLIGHT_STUDIES):
        about.append(f"*Studies:* {', '.join(map(plain, key.studies))}.")
    if key.conditions:
        about.append(f"*Acts with:* {plain('; '.join(key.conditions))}.")
    return (
        literal(key.key.replace(".0", "")),
        default,
        f"{plain(key.range)}{range_unit}",
        " ".join(about),
    )
