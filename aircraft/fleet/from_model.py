"""Read an aircraft's spec from its JSBSim model and the user's settings file.

The model gives engines and controls, and shows whether the aircraft is an aeroplane. An envelope
that the settings do not give is found by trimming (``aircraft.envelope``).
"""

import json
import math
import tomllib
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from aircraft.model import content_of, read_model, read_xml
from aircraft.spec import (
    PROPERTY,
    SETTLE_TIMES,
    AircraftError,
    AircraftSpec,
    ControlInput,
    Envelope,
    ModelFiles,
    engine_suffix,
    surface,
    throttle,
)
from common.text import did_you_mean

_SURFACES = ("elevator", "aileron", "rudder")
_STARTED_ENGINES = ("piston_engine", "turbine_engine", "turboprop_engine")
"""Types of engine that have to be started."""

_ELECTRIC_ENGINES = ("electric_engine", "brushless_dc_motor")
"""Types of engine that run without being started."""

_SETTLE_TIME = 20.0
"""Time in which piston engines and their propellers settle while the aircraft is held [s]."""


def _property(name: str) -> str:
    if not PROPERTY.fullmatch(name):
        raise ValueError(f"'{name}' is not a JSBSim property, such as fcs/elevator-cmd-norm")
    return name


_Property = Annotated[str, AfterValidator(_property)]
_Commands = tuple[_Property, ...]


class _Table(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


class EnvelopeSettings(_Table):
    """Airspeeds and bank at which the autopilot may fly the aircraft."""

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
        """The same envelope in the units of an aircraft's spec."""
        return Envelope(
            airspeed_min=self.airspeed_min_mps,
            airspeed_max=self.airspeed_max_mps,
            airspeed=self.airspeed_mps,
            bank=math.radians(self.bank_deg),
        )

    @model_validator(mode="after")
    def _flyable(self) -> Self:
        if self.envelope.problem:
            raise ValueError(self.envelope.problem)
        return self


class ModelSettings(_Table):
    """The settings file ``NAME.toml`` in a model's folder. Each key may be left out."""

    title: Annotated[str, Field(min_length=1, max_length=80)] | None = None
    """Name in reports; the model's own name by default."""
    elevator: Annotated[_Commands, Field(min_length=1)] | None = None
    """JSBSim properties that take the elevator command, -1 to 1; default fcs/elevator-cmd-norm."""
    aileron: Annotated[_Commands, Field(min_length=1)] | None = None
    """Same for the ailerons; default fcs/aileron-cmd-norm."""
    rudder: _Commands | None = None
    """Same for the rudder; default fcs/rudder-cmd-norm; false if the aircraft has no rudder."""
    throttle: Annotated[_Commands, Field(min_length=1)] | None = None
    """JSBSim properties that take the throttle command, 0 to 1; by default one for each engine."""
    settle_time_s: Annotated[float, Field(ge=SETTLE_TIMES[0], le=SETTLE_TIMES[1])] | None = None
    """Time in which servos and engines come to rest while the aircraft is held [s]; default 20."""
    envelope: EnvelopeSettings | None = None
    """Airspeeds and bank; by default found by trimming."""
    properties: dict[_Property, float] = {}
    """JSBSim properties set in every flight, in addition to gear up and constant fuel."""

    @field_validator("elevator", "aileron", "rudder", "throttle", mode="before")
    @classmethod
    def _one_or_more(cls, given: Any, key: ValidationInfo) -> Any:
        if given is False and key.field_name == "rudder":
            return ()
        if isinstance(given, str):
            return (given,)
        if not isinstance(given, list):
            raise ValueError("give the JSBSim property that takes the command, or a list of them")
        return given


def read_settings(path: Path) -> ModelSettings:
    """Settings from a file.

    Raises
    ------
    AircraftError : the file cannot be read or is not TOML, or a key is unknown or out of range
    """
    try:
        return ModelSettings.model_validate(tomllib.loads(path.read_text(encoding="utf-8-sig")))
    except OSError as error:
        raise AircraftError(
            f"{path}: cannot be read: {error.strerror}; check its permissions"
        ) from None
    except ValidationError as error:
        raise AircraftError(f"{path}: {_first_problem(error)}") from None
    except ValueError as error:
        raise AircraftError(
            f"{path}: not valid TOML: {error}; names of properties need quotes"
        ) from None


def _first_problem(error: ValidationError) -> str:
    """First error in the settings, in one line."""
    first = error.errors()[0]
    name = ".".join(str(part) for part in first["loc"])
    *tables, key = name.split(".")
    message = first["msg"].removeprefix("Value error, ").replace("Input should be", "it must be")
    if first["type"] == "extra_forbidden":
        known = (EnvelopeSettings if tables else ModelSettings).model_fields
        return f"unknown key '{name}'{did_you_mean(key, known) or ';'} known are {', '.join(known)}"
    if first["type"] == "missing":
        return f"key '{name}' is missing; give it, or leave out the whole table"
    if first["type"] == "value_error":
        return f"{name}: {message}"
    return f"{name} is {json.dumps(first['input'], default=str)}; {message[0].lower()}{message[1:]}"


def spec_of_model(
    files: ModelFiles, *, name: str, source: str, settings: ModelSettings | None = None
) -> AircraftSpec:
    """Spec of an aircraft with engines and the usual controls.

    Parameters
    ----------
    files : the model's files; the first root becomes the root of the spec
    name : name of the aircraft
    source : source of the model's numbers
    settings : settings of a user's model; None for a model that the user cannot correct

    Raises
    ------
    AircraftError : a file is not XML, or an autopilot cannot fly the aircraft
    """
    given = settings or ModelSettings()
    try:
        config = read_model(files).getroot()
        engines = [_kind(engine, files) for engine in config.iterfind("propulsion/engine")]
        reason = _why_no_aeroplane(config, engines, files) or _wrong_element(config, files)
    except AircraftError as error:
        raise AircraftError(f"aircraft '{name}' cannot be flown: {error}") from None
    inputs = _inputs(len(engines), given)
    reason = reason or _missing_commands(inputs, config, files, of_user=settings is not None)
    if reason:
        raise AircraftError(f"aircraft '{name}' cannot be flown: {reason}")
    configuration = {
        "gear/gear-cmd-norm": 0.0,
        "gear/gear-pos-norm": 0.0,
        "propulsion/fuel_freeze": 1.0,
    }
    for lever in ("mixture", "advance"):
        for i in range(len(engines)):
            configuration[f"fcs/{lever}-cmd-norm{engine_suffix(i)}"] = 1.0
    root, *others = files.roots
    return AircraftSpec(
        name=name,
        title=" ".join((given.title or _model_title(config, name)).split()),
        root=root,
        model=files.model,
        folder=None if files.folder == root / "aircraft" / files.model else files.folder,
        other_roots=tuple(others),
        inputs=inputs,
        envelope=None if given.envelope is None else given.envelope.envelope,
        configuration=tuple((configuration | given.properties).items()),
        engine_flags=tuple(
            f"propulsion/engine{engine_suffix(i)}/set-running"
            for i, kind in enumerate(engines)
            if kind in _STARTED_ENGINES
        ),
        settle_time=_SETTLE_TIME if given.settle_time_s is None else given.settle_time_s,
        source=source,
    )


def _model_title(config: ET.Element, name: str) -> str:
    """Title for reports: the model's name, followed by the aircraft's name if the two differ."""
    title = " ".join((config.get("name") or "").replace("_", " ").split())
    return f"{title} ({name})" if title and title.lower() != name.lower() else name


def _kind(element: ET.Element, files: ModelFiles) -> str:
    """Type of an engine or thruster: the root tag of the file that it names."""
    found = files.find(element)
    return read_xml(found).getroot().tag if found else f"missing ({element.get('file')})"


def _inputs(engines: int, given: ModelSettings) -> tuple[ControlInput, ...]:
    """Control inputs, with the command properties from the settings or the usual ones."""
    inputs = []
    for control, commands in (
        (surface("elevator"), given.elevator),
        (surface("aileron"), given.aileron),
        (throttle(engines), given.throttle),
        (surface("rudder"), given.rudder),
    ):
        if commands is None:
            inputs.append(control)
        elif commands:
            inputs.append(replace(control, commands=commands))
    return tuple(inputs)


def _why_no_aeroplane(config: ET.Element, engines: list[str], files: ModelFiles) -> str:
    """Why a model is not an aeroplane with engines; empty if it is one."""
    thrusters = list(config.iterfind("propulsion/engine/thruster"))
    if config.find("buoyant_forces") is not None:
        return "it is lighter than air"
    if "rotor" in [_kind(thruster, files) for thruster in thrusters]:
        return "it is a rotorcraft"
    if any(_lifts(thruster) for thruster in thrusters):
        return "its engines lift it"
    if not engines:
        return "it has no engine"
    if "rocket_engine" in engines:
        return "it flies on rocket engines, for minutes"
    odd = [kind for kind in engines if kind not in (*_STARTED_ENGINES, *_ELECTRIC_ENGINES)]
    return f"its engine is of type {', '.join(odd)}" if odd else ""


_NEEDED = {
    "metrics": ("wingarea", "wingspan", "chord"),
    "mass_balance": ("ixx", "iyy", "izz", "emptywt"),
}
"""Required elements by section: a model has each of them exactly once, with a value above 0."""


def _wrong_element(config: ET.Element, files: ModelFiles) -> str:
    """Error in a required element of the model, in words; empty without an error.

    JSBSim itself takes a missing element as 0, and the first one of two.
    """
    for section, names in _NEEDED.items():
        given = config.find(section)
        if given is None:
            return f"it has no element <{section}>"
        content = content_of(given, files)
        for name in names:
            found = content.findall(name)
            if len(found) != 1:
                count = "no element" if not found else f"{len(found)} elements"
                return f"it has {count} <{name}> in <{section}>; it must have one"
            text = (found[0].text or "").strip()
            try:
                value = float(text)
            except ValueError:
                value = math.nan
            if not 0.0 < value < math.inf:
                return f"<{name}> in <{section}> is {text!r}; it must be a number above 0"
    return ""


def _lifts(thruster: ET.Element) -> bool:
    """Whether a thruster points more than 45 deg up or down."""
    try:
        pitch = float(thruster.findtext("orient/pitch", "0"))
    except ValueError:
        return False  # JSBSim refuses it with a message
    unit = next((orient.get("unit") for orient in thruster.iterfind("orient")), None)
    return abs(math.radians(pitch) if unit == "DEG" else pitch) > math.pi / 4.0


def _missing_commands(
    inputs: tuple[ControlInput, ...], config: ET.Element, files: ModelFiles, *, of_user: bool
) -> str:
    """Message about surfaces whose commands the model does not read; empty without such surfaces.

    For a user's model the message has a remedy.
    """
    text = _text(config, files)
    missing = [
        control.name
        for control in inputs
        if control.name in _SURFACES and any(command not in text for command in control.commands)
    ]
    if not missing:
        return ""
    problem = f"its controls take no {' and no '.join(missing)} command"
    if not of_user:
        return problem
    keys = ", ".join(f'{name} = "PROPERTY"' for name in missing)
    remedy = f"{problem}; name the properties that take them in {files.model}.toml, {keys}"
    return f"{remedy}, or rudder = false" if "rudder" in missing else remedy


def _text(config: ET.Element, files: ModelFiles) -> str:
    """Text of all files in the model's folder, and of the systems outside of it."""
    shared = [found for system in config.iterfind("system[@file]") if (found := files.find(system))]
    beside = sorted(files.folder.rglob("*.xml"))
    paths = [path for path in dict.fromkeys([*beside, *shared]) if path.is_file()]
    return "".join(path.read_text(encoding="utf-8", errors="replace") for path in paths)
