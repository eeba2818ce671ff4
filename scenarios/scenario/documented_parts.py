"""What is known of a key; and the keys that parts bring: fields of steering laws, settings of
plumes and instruments.
"""

import functools
import inspect
import re
from dataclasses import Field, dataclass, fields, replace
from typing import Any

from common.registry import Registry
from gnc.laws import STEERING_LAWS
from scenarios.scenario.added_keys import ADDED
from scenarios.scenario.extension_points import PAYLOADS, PLUME_MODELS
from scenarios.scenario.keys import line, split_unit
from scenarios.scenario.sections.guidance import GuidanceConfig

FLIGHT_STUDIES = (
    *("flights", "paper", "monte_carlo", "falsify", "premises"),
    *(keys.STUDY for keys in ADDED),
)
"""Studies whose scenario files are those of flights."""

DIMENSIONLESS = "-"
"""Unit of a number without one."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DocumentedKey:
    """What is known of a key.

    Attributes
    ----------
    key : with dots; the entries of a list have the index 0
    meaning : a sentence or two
    unit : of a number, ``DIMENSIONLESS`` where it has none; empty of what is no number
    range : what it may be, in words
    default : in plain values; None where nothing is the default, or where it has to be given
    required : whether it has to be given
    studies : that take it
    conditions : what it needs to have an effect, each by the part that uses it; empty if it always
        has one
    """

    key: str
    meaning: str
    unit: str
    range: str
    default: Any
    required: bool
    studies: tuple[str, ...]
    conditions: tuple[str, ...] = ()


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
    """Return the keys that the parts of the project and of installed packages bring, as far as they
    are not those of the schema.
    """
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
    """Return meaning and unit of each field of a dataclass, by its docstring; the unit of a number
    without one is empty.
    """
    told = {name: split_unit(described) for name, described in _described(made).items()}
    return {
        name: (_sentence(meaning), "" if unit == DIMENSIONLESS else unit)
        for name, (meaning, unit) in told.items()
    }


def _sentence(text: str) -> str:
    """Return what a docstring says of a field as a sentence, as the schema says it of its keys."""
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _described(made: type[Any]) -> dict[str, str]:
    """Return what the docstrings of a dataclass and its bases say of its fields, as one line each."""
    found: dict[str, str] = {}
    for base in reversed(made.__mro__):
        text = inspect.cleandoc(base.__dict__.get("__doc__") or "")
        _, _, attributes = text.partition("Attributes\n----------\n")
        attributes = attributes.partition("\n\n")[0]
        for entry in re.split(r"\n(?=\S)", attributes):
            names, colon, described = entry.partition(" : ")
            found |= dict.fromkeys(names.split(", "), line(described)) if colon else {}
    return found
