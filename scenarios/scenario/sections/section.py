"""The base class of the sections of a scenario file, and the types of their keys."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    model_validator,
)

from scenarios.scenario.sections.needs import Need


class Section(BaseModel):
    """Frozen; unknown keys, numbers that are not finite, and truth values in the place of numbers
    are refused.

    A field is a key. Its type has the limits of the key and its needs (``needs``); its docstring
    has the meaning and the unit, ``"Meaning [unit]."``.
    """

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True
    )

    NEEDS: ClassVar[tuple[Need, ...]] = ()
    """What each of its keys needs."""

    PART_NEEDS: ClassVar[Mapping[str, tuple[Need, ...]]] = {}
    """What keys need that its parts bring."""

    @model_validator(mode="wrap")
    @classmethod
    def _numbers_are_numbers(cls, given: Any, validate: ModelWrapValidatorHandler[Self]) -> Self:
        made = validate(given)
        if isinstance(given, Mapping):
            reject_truth_values(given, made)
        return made


def reject_truth_values(given: Mapping[str, Any], made: object) -> None:
    """Raise a ValueError where a key has ``true`` or ``false`` and became a number.

    Parameters
    ----------
    given : as written
    made : a section or a part's settings, with the values of the same names
    """
    for key, value in given.items():
        if isinstance(value, bool | list | tuple) and _became_number(
            value, getattr(made, key, None)
        ):
            raise ValueError(f"{key} is {str(value).lower()}; it must be a number")


def _became_number(given: object, made: object) -> bool:
    if isinstance(given, list | tuple) and isinstance(made, list | tuple):
        return any(map(_became_number, given, made))
    return isinstance(given, bool) and isinstance(made, int | float) and not isinstance(made, bool)


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
