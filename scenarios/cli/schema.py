"""The output of ``plume-flight schema``: a JSON Schema (draft 4) of scenario files, with which an
editor completes and checks them.

It is made from the schema that reads the files. Taplo knows draft 4 alone; it checks TOML in Visual
Studio Code (Even Better TOML) and other editors.
"""

import functools
from typing import Any

from pydantic.json_schema import GenerateJsonSchema
from pydantic_core import core_schema

from common.registry import announced
from scenarios.scenario.documentation import EXTENDS, documented_part_keys, file_kinds
from scenarios.scenario.errors import line
from scenarios.scenario.files import KINDS

Schema = dict[str, Any]
"""A JSON schema: of a file, a table or a value."""

_SAME_IN_DRAFT_4 = (
    *("type", "enum", "pattern", "default"),
    *("minimum", "maximum", "minItems", "maxItems", "minLength", "maxLength"),
)
"""Keywords that draft 4 has with the same meaning, and whose values hold no schema."""

_OF_SCHEMAS = ("anyOf", "oneOf", "allOf", "not", "additionalProperties")
"""Keywords that draft 4 has with the same meaning, and whose values are schemas."""


def file_schema() -> Schema:
    """Return the schema of scenario files of every kind, with what installed packages add.

    It accepts the files that the program accepts, with one difference: the program also takes "5"
    for 5, 2.0 for a whole number, and 1 for true. It does not know what the program checks beyond
    types, limits and names of keys.
    """
    schema = functools.reduce(
        _either,
        (
            _draft_4(whole, whole.get("$defs", {}))
            for whole in (kind.model_json_schema(schema_generator=_OfToml) for kind in file_kinds())
        ),
    )
    keys = schema["properties"]
    for key in documented_part_keys():
        section, _, name = key.key.partition(".")
        # A user's part may have a key of this name and of another type.
        keys[section]["properties"].setdefault(name, {"description": key.meaning})
    studies = sorted({*KINDS, *announced("study")})
    keys["study"]["anyOf"] = [{"enum": studies}, {"type": "string"}]
    base = {"description": EXTENDS, "anyOf": [{"type": "string"}, {"enum": [False]}]}
    return {
        "$schema": "http://json-schema.org/draft-04/schema#",
        "title": "Scenario file of plume-flight",
        **schema,
        "properties": {"extends": base, **keys},
    }


class _OfToml(GenerateJsonSchema):
    """Pydantic's schema, without null, which TOML does not have, and with numbers allowed where the
    program takes them as text.
    """

    def nullable_schema(self, schema: core_schema.NullableSchema) -> Schema:
        return self.generate_inner(schema["schema"])

    def str_schema(self, schema: core_schema.StringSchema) -> Schema:
        made = super().str_schema(schema)
        return (
            made | {"type": ["string", "number"]} if schema.get("coerce_numbers_to_str") else made
        )


def _draft_4(given: Schema, definitions: Schema, *, whole: bool = False) -> Schema:
    """Return a schema of draft 2020-12 as one of draft 4, with definitions in place of references;
    keywords unknown to draft 4 are left out.

    Parameters
    ----------
    given : the schema, as pydantic makes it
    definitions : definitions to which it refers
    whole : whether required keys have to be in this file. In an entry of a list they have to; those
        of other tables may be in the file that this one extends
    """
    if "$ref" in given:
        referred = definitions[given["$ref"].rpartition("/")[2]]
        # The default of a whole table is the same as those of its keys.
        given = {**referred, **given, "default": None}
        del given["$ref"]
    made: Schema = {
        keyword: given[keyword] for keyword in _SAME_IN_DRAFT_4 if given.get(keyword) is not None
    }

    def within(of: Any, *, whole: bool = whole) -> Any:
        if isinstance(of, list):
            return [within(each, whole=whole) for each in of]
        return of if isinstance(of, bool) else _draft_4(of, definitions, whole=whole)

    made |= {keyword: within(given[keyword]) for keyword in _OF_SCHEMAS if keyword in given}
    if "properties" in given:
        made["properties"] = {name: within(of) for name, of in given["properties"].items()}
    if "prefixItems" in given:
        made |= {"items": within(given["prefixItems"], whole=True), "additionalItems": False}
    elif "items" in given:
        made["items"] = within(given["items"], whole=True)
    if whole and "required" in given:
        made["required"] = given["required"]
    if "description" in given:
        made["description"] = line(given["description"])
    if "const" in given:
        made["enum"] = [given["const"]]
    for exclusive, limit in (("exclusiveMinimum", "minimum"), ("exclusiveMaximum", "maximum")):
        if exclusive in given:
            made |= {limit: given[exclusive], exclusive: True}
    return made


def _either(one: Schema, other: Schema) -> Schema:
    """Return a schema that accepts everything that one of two schemas accepts, and a little more:
    two tables become one with the keys of both, so that an editor can mark the wrong key.
    """
    if _without_words(one) == _without_words(other):
        return one
    if "enum" in one and "enum" in other:
        return {**one, "enum": [*dict.fromkeys((*one["enum"], *other["enum"]))]}
    if not ("properties" in one and "properties" in other):
        return {"description": one.get("description", ""), "anyOf": [one, other]}
    keys: Schema = {}
    for name in {**one["properties"], **other["properties"]}:
        having, lacking = one, other
        if name not in having["properties"]:
            having, lacking = other, one
        key = having["properties"][name]
        if name in lacking["properties"]:
            keys[name] = _either(key, lacking["properties"][name])
        elif _is_closed(lacking):
            keys[name] = key
        else:
            # A part may add a key of this name and of another type.
            keys[name] = {"description": key.get("description", "")}
    return {
        **one,
        "properties": keys,
        "additionalProperties": not (_is_closed(one) and _is_closed(other)),
    }


def _without_words(schema: Schema) -> Schema:
    return {name: of for name, of in schema.items() if name not in ("description", "default")}


def _is_closed(table: Schema) -> bool:
    return table.get("additionalProperties") is False
