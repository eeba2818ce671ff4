"""Sections that name parts, and take the keys that these parts bring: the fields of their
settings.
"""

import functools
from collections.abc import Mapping
from dataclasses import Field, fields
from typing import Any, ClassVar

from pydantic import ConfigDict, TypeAdapter, ValidationError, model_validator

from common.errors import PluginError
from common.text import did_you_mean
from scenarios.scenario.sections.section import Section, reject_truth_values


class PartSection(Section):
    """A section that allows the keys of the parts that it names.

    A part that has keys of its own has a frozen dataclass ``SETTINGS``: its fields are the keys,
    with types and defaults.
    """

    model_config = ConfigDict(extra="allow")

    NAMED_IN: ClassVar[str]
    """Dotted key that names the parts, with its section."""

    def parts(self) -> dict[str, Any]:
        """Return the parts that the section names, by their names.

        Raises
        ------
        PluginError : there is no such part, or it does not load
        """
        raise NotImplementedError

    @property
    def part_keys(self) -> dict[str, Any]:
        """Return the keys of the parts, and their defaults; raises as ``parts``."""
        return {of.name: of.default for part in self.parts().values() for of in _settings(part)}

    def settings(self, part: Any) -> Any:
        """Return the settings of a part: those that the section gives, and its defaults."""
        made = part.SETTINGS
        names = {of.name for of in fields(made)}
        return _adapter(made).validate_python(
            {key: value for key, value in (self.model_extra or {}).items() if key in names}
        )

    def __getattr__(self, name: str) -> Any:
        """Raise an error that says where the value of a part's key is. The section itself has only
        the keys that are given.
        """
        try:
            return super().__getattr__(name)  # type: ignore[misc]
        except AttributeError:
            if name.startswith("_") or name in type(self).model_fields or not self._takes(name):
                raise
            raise AttributeError(
                f"'{name}' is a key of SETTINGS, which this scenario leaves at its default; take"
                f" it, given or not, from the section's settings(type(self)).{name}"
            ) from None

    def _takes(self, name: str) -> bool:
        try:
            return name in self.part_keys
        except PluginError:
            return False

    @model_validator(mode="after")
    def _known_keys(self) -> "PartSection":
        given = self.model_extra
        if not given:
            return self
        try:
            parts = self.parts()
        except PluginError as error:
            raise ValueError(str(error)) from None
        keys = self.part_keys
        for name in given:
            if name not in keys:
                of_parts = f"; keys of {', '.join(map(repr, parts))} are {', '.join(keys)}"
                known = of_parts if keys else f"; set {self.NAMED_IN} to a part that takes it"
                raise ValueError(
                    f"key '{name}' is not"
                    f" known{did_you_mean(name, [*type(self).model_fields, *keys]) or known}"
                )
        for part in parts.values():
            if hasattr(part, "SETTINGS"):
                self._check(part)
        return self

    def _check(self, part: Any) -> None:
        try:
            made = self.settings(part)
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(map(str, first["loc"]))
            text = first["msg"].removeprefix("Value error, ")
            text = f"{text[0].lower()}{text[1:]}"
            raise ValueError(f"{key} is {first['input']!r}; {text}" if key else text) from None
        reject_truth_values(self.model_extra or {}, made)

    def keys_lost_with(self, changed: Mapping[str, object]) -> list[str]:
        """Return the given keys that no part takes after fields of the section are changed."""
        given = self.model_extra or {}
        if not given:
            return []
        try:
            known = self.model_copy(update=dict(changed)).part_keys
        except PluginError:
            return []
        return [name for name in given if name not in known]


def _settings(part: Any) -> tuple[Field[Any], ...]:
    """Return the fields of a part's settings; none of a part that has no keys."""
    return fields(part.SETTINGS) if hasattr(part, "SETTINGS") else ()


@functools.cache
def _adapter(settings: type[Any]) -> TypeAdapter[Any]:
    return TypeAdapter(settings)
