"""What a file beside a JSBSim model, NAME.toml, may say of the aircraft. What it leaves out is
found.
"""

import json
import math
import re
import tomllib
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from aircraft.errors import AircraftError
from aircraft.spec import SETTLE_TIMES, Envelope
from common.text import did_you_mean

_Property = Annotated[
    str, Field(pattern=r"^[A-Za-z_][\w.\-]*(\[\d+\])?(/[A-Za-z_][\w.\-]*(\[\d+\])?)*$")
]
_Commands = tuple[_Property, ...]

_UNQUOTED = re.compile(r"^\s*([\w.\-\[\]]+(?:/[\w.\-\[\]]+)+)\s*=", re.MULTILINE)
"""A JSBSim property that is a key without quotes, which TOML has no other letters for."""

_TAKES = "give the JSBSim property that takes its command"
_REMEDIES = {
    "string_pattern_mismatch": 'give a JSBSim property, as in "fcs/elevator-cmd-norm"',
    "string_type": "give text in quotes",
    "tuple_type": _TAKES,
    "too_short": _TAKES,
    "model_type": "give a table with airspeed_min_mps, airspeed_mps, airspeed_max_mps and bank_deg, or leave the key out",
    "dict_type": "give a table of JSBSim properties and their values",
    "float_parsing": "it must be a number",
    "float_type": "it must be a number",
}
"""What to write instead, by pydantic's kinds of errors."""


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class EnvelopeSettings(_Table):
    """Where the autopilot may fly the aircraft."""

    airspeed_min_mps: float
    """Slowest commanded true airspeed [m/s]."""
    airspeed_max_mps: float
    """Fastest commanded true airspeed [m/s]."""
    airspeed_mps: float
    """Default airspeed of a study [m/s]."""
    bank_deg: float
    """Bank of the steepest turn that the guidance may demand [deg]."""

    @property
    def envelope(self) -> Envelope:
        """Return the envelope of an aircraft's spec, in its units."""
        return Envelope(
            airspeed_min=self.airspeed_min_mps,
            airspeed_max=self.airspeed_max_mps,
            airspeed=self.airspeed_mps,
            bank=math.radians(self.bank_deg),
        )

    @model_validator(mode="after")
    def _flyable(self) -> Self:
        if fault := self.envelope.fault:
            raise ValueError(f"envelope: {fault}")
        return self


class ModelSettings(_Table):
    """The whole file. Each key may be left out."""

    title: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    """Name in reports; the model's own name for itself if it is not given."""
    elevator: Annotated[_Commands, Field(min_length=1)] | None = None
    """JSBSim properties that take the elevator command, -1 to 1; fcs/elevator-cmd-norm if not
    given.
    """
    aileron: Annotated[_Commands, Field(min_length=1)] | None = None
    """The same of the ailerons; fcs/aileron-cmd-norm if not given."""
    rudder: _Commands | None = None
    """The same of the rudder; fcs/rudder-cmd-norm if not given, and false for an aircraft that has
    none.
    """
    throttle: Annotated[_Commands, Field(min_length=1)] | None = None
    """JSBSim properties that take the throttle command, 0 to 1; that of each engine if not given.
    """
    settle_time_s: Annotated[float, Field(ge=SETTLE_TIMES[0], le=SETTLE_TIMES[1])] | None = None
    """Time in which servos and engines come to rest while the aircraft is held; 20 s if not given
    [s].
    """
    envelope: EnvelopeSettings | None = None
    """Airspeeds and bank; found by trimming if not given."""
    properties: dict[_Property, float] = {}
    """JSBSim properties and their values in every flight, beside gear up and fuel held."""

    @field_validator("elevator", "aileron", "rudder", "throttle", mode="before")
    @classmethod
    def _one_or_more(cls, given: Any, key: ValidationInfo) -> Any:
        if given is False and key.field_name == "rudder":
            return ()
        return (given,) if isinstance(given, str) else given


def read_settings(path: Path) -> ModelSettings:
    """Return what a file says.

    Raises
    ------
    AircraftError : it is not TOML, or has a key that is unknown or out of range
    """
    text = ""
    try:
        text = path.read_text(encoding="utf-8-sig")
        return ModelSettings.model_validate(tomllib.loads(text))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        if bare := _UNQUOTED.search(text):
            raise AircraftError(
                f'{path}: key {bare[1]} has a slash; write it in quotes, "{bare[1]}" = ...'
            ) from None
        raise AircraftError(f"{path}: not valid TOML: {error}; fix the file") from None
    except OSError as error:
        raise AircraftError(
            f"{path}: cannot be read: {error.strerror}; check its permissions"
        ) from None
    except ValidationError as error:
        raise AircraftError(f"{path}: {_explained(error)}") from None


def _explained(error: ValidationError) -> str:
    """Return the first thing that is wrong, in a line."""
    first = error.errors()[0]
    *tables, key = [str(part) for part in first["loc"]] or [""]
    name = ".".join([*tables, key])
    if first["type"] == "extra_forbidden":
        known = (EnvelopeSettings if tables else ModelSettings).model_fields
        return f"unknown key '{name}'{did_you_mean(key, known) or ';'} known are {', '.join(known)}"
    if first["type"] == "missing":
        return f"key '{name}' is missing; give it, or leave out the whole table"
    if first["type"] == "value_error":
        return first["msg"].removeprefix("Value error, ")
    demanded = first["msg"].partition(",")[0].replace("Input should be", "it must be")
    remedy = _REMEDIES.get(first["type"], demanded[0].lower() + demanded[1:])
    if first["type"] in ("tuple_type", "too_short"):
        remedy += f', as in "fcs/{key}-cmd-norm", or leave the key out{"; false is for no rudder" if key == "rudder" else ""}'
    given = first["input"]
    return f"{name} is {given if isinstance(given, float) else json.dumps(given, default=str)}; {remedy}"
