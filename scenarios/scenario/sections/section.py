"""What sections of a scenario file are made of."""

import functools
import typing
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, model_validator


class Section(BaseModel):
    """Frozen; unknown keys, numbers that are not finite, and truth values in the place of numbers
    are refused.
    """

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )

    @model_validator(mode="before")
    @classmethod
    def _numbers_are_numbers(cls, given: Any) -> Any:
        if isinstance(given, dict):
            refuse_truth_values(cls, given)
        return given


def refuse_truth_values(kind: Any, given: Mapping[str, Any]) -> None:
    """Raise a ValueError where a key that takes a number, of a section or of a part's settings, has
    ``true`` or ``false``.
    """
    numbers = _number_keys(kind)
    for key, value in given.items():
        if (
            isinstance(value, bool | list | tuple)
            and (words := numbers.get(key)) is not None
            and _has_other_truth(value, words)
        ):
            or_false = ", or false" if words else ""
            raise ValueError(
                f"{key} is {str(value).lower()}; a truth value is no number: give a number{or_false}"
            )


def _has_other_truth(value: object, words: tuple[bool, ...]) -> bool:
    """Return whether a value is, or a list holds, a truth value that is not one of the words that
    the key takes.
    """
    if isinstance(value, list | tuple):
        return any(_has_other_truth(item, words) for item in value)
    return isinstance(value, bool) and value not in words


@functools.cache
def _number_keys(kind: Any) -> dict[str, tuple[bool, ...]]:
    """Return the keys that take numbers, each with the truth values that it takes as words beside
    them.
    """
    fields = (
        {name: field.annotation for name, field in kind.model_fields.items()}
        if issubclass(kind, BaseModel)
        else None
    )
    leaves = {
        name: list(_leaves(annotation))
        for name, annotation in (fields or typing.get_type_hints(kind)).items()
    }
    return {
        name: tuple(word for word in of if isinstance(word, bool))
        for name, of in leaves.items()
        if (int in of or float in of) and not (bool in of or Any in of or object in of)
    }


def _leaves(annotation: Any) -> Iterator[Any]:
    """Yield the types and the words that an annotation is made of."""
    origin, parts = typing.get_origin(annotation), typing.get_args(annotation)
    if origin is Annotated:
        parts = parts[:1]
    elif origin is Literal or not parts:
        yield from parts or (annotation,)
        return
    for part in parts:
        yield from _leaves(part)


def _no_zero(given: Any) -> Any:
    """Refuse 0, which would count as ``false``."""
    if isinstance(given, int | float) and not isinstance(given, bool) and given == 0:
        raise ValueError(
            f"value is {given!r}; give a limit above 0, or false where the quantity is not judged"
        )
    return given


def _with_a_word(title: str) -> str:
    if not title.strip():
        raise ValueError(f"value is {title!r}; give one word at least")
    return title


Title = Annotated[str, AfterValidator(_with_a_word)]
"""What reports and lists call something."""
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Angle = Annotated[float, Field(ge=-360.0, le=360.0)]
Range = tuple[float, float]
Limit = Annotated[Positive | Literal[False], BeforeValidator(_no_zero)]
"""A limit, or ``false`` where the quantity is not judged."""
Seed = Annotated[int, Field(ge=0, le=2**63 - 1)]


def check_divides(name: str, rate: float, whole: float) -> None:
    """Raise a ValueError unless ``rate`` [Hz], called ``name``, divides ``whole`` [Hz]."""
    ratio = whole / rate
    if abs(ratio - round(ratio)) > 1e-9:
        dividing = [n for n in range(1, int(whole) + 1) if whole % n == 0.0]
        nearest = min(dividing, key=lambda n: abs(n - rate))
        raise ValueError(f"{name} is {rate:g} Hz; it must divide {whole:g} Hz, e.g. {nearest}")


def check_ordered(name: str, values: Range | None) -> None:
    """Raise a ValueError if the first of ``values``, called ``name``, exceeds the second; None
    passes.
    """
    if values is not None and values[0] > values[1]:
        raise ValueError(f"{name} is {list(values)}; its first value must not exceed its second")
