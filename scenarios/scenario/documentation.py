"""Every key of the scenario files with its meaning, unit, range and default, taken from the
schemas: the only source of the texts about keys."""

import functools
import inspect
import re
import typing
from collections.abc import Iterator
from dataclasses import Field, dataclass, fields, replace
from datetime import datetime
from types import NoneType
from typing import Any, Literal

from pydantic import BaseModel, RootModel
from pydantic.fields import FieldInfo
from pydantic_core import to_jsonable_python

from common.registry import Registry
from common.text import nearest
from gnc.laws import STEERING_LAWS
from scenarios.scenario.added_keys import ADDED, study_files
from scenarios.scenario.consistency import ONE_POINT
from scenarios.scenario.effect import needs_of
from scenarios.scenario.errors import line, models_in, split_unit
from scenarios.scenario.extension_points import PAYLOADS, PLUME_MODELS
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.experiment import DrawConfig, TrialList
from scenarios.scenario.sections.guidance import GuidanceConfig

FLIGHT_STUDIES = (
    *("flights", "paper", "monte_carlo", "falsify", "premises"),
    *(keys.STUDY for keys in ADDED),
)
"""Studies whose scenario files are those of flights."""

DIMENSIONLESS = "-"
"""Unit of a number without one."""

EXTENDS = (
    "The scenario that this one is based on: a name of the catalog, the path of a file, or false"
    " for none. It stands at the top of a scenario file alone, and cannot be set, swept or sampled."
)
"""Meaning of ``extends``, which the file has beside the keys of its schema."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DocumentedKey:
    """Description of a key.

    Attributes
    ----------
    key : with dots; the entries of a list have the index 0
    meaning : a sentence or two
    unit : of a number, or ``DIMENSIONLESS``; empty for a key that is not a number
    range : its possible values, in words
    default : as a plain value; None if the default is None, or if the key has to be given
    required : whether it has to be given
    studies : studies in which it can have an effect
    conditions : conditions under which it has an effect, each with the part that uses it; empty if
        it always has one
    """

    key: str
    meaning: str
    unit: str
    range: str
    default: Any
    required: bool
    studies: tuple[str, ...]
    conditions: tuple[str, ...] = ()


_KINDS: dict[type[BaseModel], tuple[str, ...]] = {
    Scenario: FLIGHT_STUDIES,
    TrialList: ("trials",),
    **{file: (study,) for study, file in study_files().items()},
}
"""Kinds of scenario files, and the studies of each."""


def file_kinds() -> tuple[type[BaseModel], ...]:
    """Return the kinds of scenario files; the first is that of flights."""
    return tuple(_KINDS)


@dataclass(frozen=True, slots=True, kw_only=True)
class DocumentedSection:
    """Description of a section.

    Attributes
    ----------
    name : with dots; empty for the keys outside of any section
    meaning : in a sentence or two
    listed : whether it is a list of tables
    keys : its keys, without those of sections inside it
    """

    name: str
    meaning: str
    listed: bool
    keys: tuple[DocumentedKey, ...]


_REFUSING = {
    "sweep": (*ONE_POINT, "paper"),
    "cases": tuple(ONE_POINT),
    "comparison": tuple(ONE_POINT),
}
"""Studies that refuse a section of several points; ``paper`` has cases, beside which there is no
sweep.
"""


@functools.cache
def documented_sections(kind: type[BaseModel] = Scenario) -> tuple[DocumentedSection, ...]:
    """Return the sections of a kind of scenario file, in their order; the first holds the keys
    outside of any section.
    """
    studies = _KINDS[kind]
    return tuple(_sections(kind, "", kind.__doc__ or "", studies, listed=False))


def documented_keys() -> list[DocumentedKey]:
    """Return every key of every kind of scenario file, followed by the keys that parts add."""
    of_schemas = [
        key for kind in _KINDS for section in documented_sections(kind) for key in section.keys
    ]
    # A part's key needs the part, and may have further conditions.
    of_parts = [
        replace(key, conditions=(*key.conditions, *_conditions(key.key, FLIGHT_STUDIES)))
        for key in documented_part_keys()
    ]
    return [*of_schemas, *of_parts]


def similar_key(name: str) -> str | None:
    """Return the key or section that an unknown name probably means: one with a similar spelling,
    or with a similar last word.
    """
    documented = documented_keys()
    keys = [each.key for each in documented]
    of_flights = [each.key for each in documented if {*each.studies} <= {*FLIGHT_STUDIES, "trials"}]
    for known in ([*(section.name for section in documented_sections()), *of_flights], keys):
        if close := nearest(name, known):
            return close
    by_last_word = {key.rpartition(".")[2]: key for key in reversed(keys)}
    close = nearest(name.rpartition(".")[2], by_last_word)
    return by_last_word[close] if close else None


def _sections(
    kind: type[BaseModel], name: str, meaning: str, studies: tuple[str, ...], *, listed: bool
) -> Iterator[DocumentedSection]:
    own, below = [], []
    for field_name, field in kind.model_fields.items():
        key = f"{name}.{field_name}" if name else field_name
        model, is_listed = next(models_in(field.annotation), (None, False))
        if model is None:
            own.append(_documented(key, field, studies))
        elif issubclass(model, RootModel):
            own.append(_free_table(key, model, studies))
        else:
            below.append(
                _sections(
                    model,
                    f"{key}.0" if is_listed else key,
                    model.__doc__ or "",
                    studies,
                    listed=is_listed,
                )
            )
    yield DocumentedSection(name=name, meaning=line(meaning), listed=listed, keys=tuple(own))
    for sections in below:
        yield from sections


def _documented(key: str, field: FieldInfo, studies: tuple[str, ...]) -> DocumentedKey:
    meaning, unit = split_unit(line(field.description or ""))
    required = field.is_required()
    return DocumentedKey(
        key=key,
        meaning=meaning,
        unit=unit if _is_number(field.annotation) else "",
        range=_range(field.annotation, tuple(field.metadata)),
        default=None
        if required
        else to_jsonable_python(field.get_default(call_default_factory=True)),
        required=required,
        studies=_studies(key, studies),
        conditions=_conditions(key, studies),
    )


def _free_table(key: str, model: type[BaseModel], studies: tuple[str, ...]) -> DocumentedKey:
    return DocumentedKey(
        key=key,
        meaning=line(model.__doc__ or ""),
        unit="",
        range="keys with dots, each with a list of values",
        default={},
        required=False,
        studies=_studies(key, studies),
    )


def _studies(key: str, studies: tuple[str, ...]) -> tuple[str, ...]:
    """Return the studies in which a key can have an effect."""
    if studies != FLIGHT_STUDIES:
        return studies
    if refusing := _REFUSING.get(key.partition(".")[0]):
        return tuple(study for study in studies if study not in refusing)
    plain = {study: _plain_scenarios(study) for study in studies}
    # A need that none of these scenarios meets does not depend on the study.
    needs = [
        need
        for need in needs_of(key)
        if any(need.acts(scenario) for scenarios in plain.values() for scenario in scenarios)
    ]
    return tuple(
        study
        for study in studies
        if any(all(need.acts(scenario) for need in needs) for scenario in plain[study])
    )


@functools.cache
def _plain_scenarios(study: str) -> tuple[Scenario, ...]:
    """Return scenarios of a study with nothing else set, one for each method: a key may need one of
    the methods.
    """
    plain = Scenario(title=study, draws=(DrawConfig(key="wind.speed_mps", uniform=(0.0, 1.0)),))
    return tuple(
        plain.model_copy(update={"study": study, "method": method})
        for method in ("plain", "subset")
    )


def _conditions(key: str, studies: tuple[str, ...]) -> tuple[str, ...]:
    if studies != FLIGHT_STUDIES:
        return ()
    # This part of a message is about one scenario only.
    return tuple(dict.fromkeys(re.sub("; here [^:]*", "", need.user) for need in needs_of(key)))


def _is_number(annotation: Any) -> bool:
    return annotation in (int, float) or any(
        _is_number(part) for part in typing.get_args(annotation)
    )


def _range(annotation: Any, metadata: tuple[Any, ...] = ()) -> str:
    """Return the possible values of a type, in words."""
    origin, parts = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is typing.Annotated:
        return _range(parts[0], (*metadata, *_constraints(parts[1:])))
    if origin is Literal:
        return " or ".join(_word(value) for value in parts)
    if origin is tuple:
        each = list(dict.fromkeys(_range(part) for part in parts if part is not Ellipsis))
        several = "a list" if parts[-1] is Ellipsis else f"{len(parts)} values"
        return f"{several}, {'each ' if len(each) == 1 else ''}{'; '.join(each)}"
    if parts and origin is not dict:
        named = (
            "a table" if typing.get_origin(part) is dict else _range(part, metadata)
            for part in parts
            if part is not NoneType
        )
        return " or ".join(dict.fromkeys(named))
    names = {
        dict: "keys with dots and their values",
        bool: "true or false",
        str: "text",
        datetime: "a time, as 2026-06-01T12:00:00Z",
    }
    return names.get(origin or annotation) or _limits(annotation, metadata)


def _constraints(metadata: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the constraints of an annotated type, which may be wrapped in a field."""
    return tuple(
        inner
        for outer in metadata
        for inner in (outer.metadata if isinstance(outer, FieldInfo) else (outer,))
    )


def _limits(annotation: Any, metadata: tuple[Any, ...]) -> str:
    """Return the limits of a number in words."""
    limits = {
        name: getattr(of, name)
        for of in metadata
        for name in ("ge", "gt", "le", "lt")
        if getattr(of, name, None) is not None
    }
    kind = {int: "a whole number", float: "a number"}.get(annotation, "any value")
    words = {"ge": "from", "gt": "above", "le": "to", "lt": "below"}
    return " ".join(
        (
            kind,
            *(
                f"{words[name]} {limits[name]:{',' if annotation is int else ',g'}}"
                for name in words
                if name in limits
            ),
        )
    )


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


_REGISTRIES: dict[str, Registry[Any]] = {
    "guidance.law": STEERING_LAWS,
    "plume.model": PLUME_MODELS,
    "payload.instruments": PAYLOADS,
}
"""Keys that name parts which bring keys, and where the parts are found."""

PART_SECTIONS = tuple(key.partition(".")[0] for key in _REGISTRIES)
"""Sections that take keys which parts bring."""


@functools.cache
def documented_part_keys() -> tuple[DocumentedKey, ...]:
    """Return the keys that the project's own parts add to those of the schema."""
    found: dict[tuple[str, str], tuple[DocumentedKey, list[str]]] = {}
    for key_of_part, registry in _REGISTRIES.items():
        section = key_of_part.partition(".")[0]
        for name in registry.installed_names():
            part = registry.get(name)
            made = part if section == "guidance" else getattr(part, "SETTINGS", None)
            for key in _part_keys(section, made) if made else ():
                _, users = found.setdefault((key.key, repr(key.default)), (key, []))
                users.append(f"{key_of_part} '{name}'")
    return tuple(replace(key, conditions=(" or ".join(users),)) for key, users in found.values())


def _part_keys(section: str, made: type[Any]) -> list[DocumentedKey]:
    """Return the keys that are the fields of a dataclass."""
    described = _described(made)
    return [
        _part_key(f"{section}.{of.name}", of, described.get(of.name, ""))
        for of in fields(made)
        if of.init and not (section == "guidance" and of.name in GuidanceConfig.model_fields)
    ]


def _part_key(key: str, of: "Field[Any]", described: str) -> DocumentedKey:
    meaning, unit = split_unit(described)
    number = type(of.default) in (int, float)
    ranges: dict[type[Any], str] = {bool: "true or false", str: "text"}
    choices = of.metadata["choices"]() if "choices" in of.metadata else ()
    limits = (
        "a number from {:g} to {:g}".format(*of.metadata["limits"])
        if "limits" in of.metadata
        else "a number"
    )
    return DocumentedKey(
        key=key,
        meaning=_sentence(meaning),
        unit=unit if number else "",
        range=" or ".join(choices) or ranges.get(type(of.default), limits),
        default=of.default,
        required=False,
        studies=FLIGHT_STUDIES,
    )


def described_fields(made: type[Any]) -> dict[str, tuple[str, str]]:
    """Return meaning and unit of each field of a dataclass, by its docstring; a number whose
    docstring has no unit gets an empty one.
    """
    documented = {name: split_unit(described) for name, described in _described(made).items()}
    return {
        name: (_sentence(meaning), "" if unit == DIMENSIONLESS else unit)
        for name, (meaning, unit) in documented.items()
    }


def _sentence(text: str) -> str:
    """Return a field's description in a docstring as a sentence, in the form that the schema has
    for its keys.
    """
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _described(made: type[Any]) -> dict[str, str]:
    """Return the descriptions of a dataclass's fields, in a line each, from its docstring and those
    of its bases.
    """
    found: dict[str, str] = {}
    for base in reversed(made.__mro__):
        text = inspect.cleandoc(base.__dict__.get("__doc__") or "")
        _, _, attributes = text.partition("Attributes\n----------\n")
        attributes = attributes.partition("\n\n")[0]
        for entry in re.split(r"\n(?=\S)", attributes):
            names, colon, described = entry.partition(" : ")
            found |= dict.fromkeys(names.split(", "), line(described)) if colon else {}
    return found
