"""What sections of a scenario file are made of."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field


class Section(BaseModel):
    """Frozen; unknown keys and numbers that are not finite are refused."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, use_attribute_docstrings=True)


Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Angle = Annotated[float, Field(ge=-360.0, le=360.0)]
Range = tuple[float, float]
Limit = Positive | Literal[False]
"""A limit, or ``false`` where the quantity is not judged."""
Seed = Annotated[int, Field(ge=0, le=2**63 - 1)]


def check_divides(name: str, rate: float, whole: float) -> None:
    """Raise a ValueError unless ``rate`` [Hz], called ``name``, divides ``whole`` [Hz]."""
    ratio = whole / rate
    if abs(ratio - round(ratio)) > 1e-9:
        dividing = [n for n in range(1, int(whole) + 1) if whole % n == 0.0]
        nearest = min(dividing, key=lambda n: abs(n - rate))
        raise ValueError(f"{name} is {rate:g} Hz; it must divide {whole:g} Hz, e.g. {nearest}")


def check_ordered(name: str, values: Range) -> None:
    """Raise a ValueError unless the first of ``values``, called ``name``, is at most the second."""
    if values[0] > values[1]:
        raise ValueError(f"{name} is {list(values)}; its first value must not exceed its second")
