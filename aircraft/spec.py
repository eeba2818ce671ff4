"""Description of a JSBSim aircraft beyond its model files.

Every aircraft, from the project, a package or a user's Python file, provides an ``AircraftSpec``.
``check_spec`` refuses a spec for which no autopilot can be designed.
"""

import bisect
import dataclasses
import functools
import math
import numbers
import re
import types
import typing
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from reprlib import repr as shortened
from typing import Any

from common.errors import RefusedError
from common.physics import RAD_S_PER_RPM

MODELS = Path(__file__).parent / "models"
"""JSBSim root of the project's own aircraft."""

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]*")
"""Names of aircraft and models: they become part of file names and of XML."""

NAME_RULE = "use letters, digits, '_', '-' and '.'"
"""The rule of ``NAME`` in words, for messages."""

PROPERTY = re.compile(r"[A-Za-z_][\w.\-]*(\[\d+\])?(/[A-Za-z_][\w.\-]*(\[\d+\])?)*")
"""Names of JSBSim properties."""

SETTLE_TIMES = (0.1, 120.0)
"""Range of the time in which servos and engines come to rest [s]."""

BANK_RESERVE = math.radians(5.0)
"""Difference between the autopilot's largest bank and the guidance's largest bank [rad]."""

DESIGN_AIRSPEEDS = 5
"""Number of airspeeds at which an autopilot is designed."""

_AIRSPEED_MAX = 400.0
"""Fastest airspeed of an envelope [m/s]."""

_BANKS_DEG = (5.0, 60.0)
"""Range of an envelope's bank [deg]."""

_ACTUATOR_NAME = re.compile(
    r"(?!(engine|none|vessel_data|satellite_navigation|sniffer_(dead|saturated))$)"
    r"[A-Za-z_][A-Za-z0-9_.\-]*"
)
"""Names of actuators: they become part of a JSBSim property, and no other fault has the same name.
"""

_REQUIRED_INPUTS = ("elevator", "aileron", "throttle")
_OPTIONAL_INPUTS = ("rudder",)


class AircraftError(RefusedError):
    """An aircraft cannot be found, loaded, trimmed or linearised; the message is one line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlInput:
    """A normalised pilot command.

    Attributes
    ----------
    name : name in linear models, such as ``elevator``
    commands : JSBSim properties that take the command [-], one for each engine or surface that
        shares it
    lower, upper : range of the command [-]
    effectiveness : ascending points (effect, command) of a surface that is commanded by its effect;
        ``lower`` and ``upper`` then limit the effect
    """

    name: str
    commands: tuple[str, ...]
    lower: float
    upper: float
    effectiveness: tuple[tuple[float, float], ...] = ()

    def command(self, value: float) -> float:
        """Command to JSBSim for a value of this input, which may be a surface's effect [-]."""
        if not self.effectiveness:
            return value
        i = min(max(bisect.bisect(self.effectiveness, (value,)), 1), len(self.effectiveness) - 1)
        (x0, y0), (x1, y1) = self.effectiveness[i - 1], self.effectiveness[i]
        return y0 + (y1 - y0) * (value - x0) / (x1 - x0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Feedback:
    """Properties in which a servo reports its command and its position.

    Attributes
    ----------
    commanded, position : JSBSim properties of the servo's command [-] and position
    travel : position at a command of 1
    """

    commanded: str
    position: str
    travel: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator:
    """A device that moves one surface or every engine's throttle, and can stick.

    Attributes
    ----------
    name : as the user types it, such as ``left_elevon``; also the name of its fault
    commands : JSBSim properties of its command: a control input's properties, or one that an
        ``<actuator>`` of the model reads
    feedback : required unless the commands are a control input's
    """

    name: str
    commands: tuple[str, ...]
    feedback: Feedback | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenState:
    """A state outside the rigid body that follows one input, such as a deflection.

    Attributes
    ----------
    name : name in linear models
    position : JSBSim property of its value
    input : name of the control input that drives it
    scale : SI value of one unit of the property
    """

    name: str
    position: str
    input: str
    scale: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope:
    """Airspeeds and banks at which the autopilot may fly the aircraft.

    Attributes
    ----------
    airspeed_min, airspeed_max : range of commanded true airspeed [m/s]
    airspeed : default airspeed of a study [m/s]
    bank : bank of the steepest coordinated turn that the guidance may demand [rad]
    stall : stall airspeed in level flight [m/s]; NaN if unknown
    notes : reasons for the limits
    """

    airspeed_min: float
    airspeed_max: float
    airspeed: float
    bank: float
    stall: float = math.nan
    notes: tuple[str, ...] = ()

    @property
    def problem(self) -> str:
        """Why no autopilot can be designed for these airspeeds or this bank; empty if one can."""
        if not 0.0 < self.airspeed_min < self.airspeed < self.airspeed_max <= _AIRSPEED_MAX:
            return (
                f"airspeed is {self.airspeed:g} m/s; it must lie between airspeed_min,"
                f" {self.airspeed_min:g}, and airspeed_max, {self.airspeed_max:g} m/s,"
                f" and these above 0 and up to {_AIRSPEED_MAX:g}: choose others"
            )
        least, most = _BANKS_DEG
        if not math.radians(least) <= self.bank <= math.radians(most):
            return (
                f"bank is {math.degrees(self.bank):g} deg ({self.bank:g} rad); it must lie between"
                f" {least:g} and {most:g} deg: give radians in Python, degrees in a settings file"
            )
        return ""

    @property
    def bank_max(self) -> float:
        """Largest bank that the autopilot commands [rad]."""
        return self.bank + BANK_RESERVE

    @property
    def design_airspeeds(self) -> tuple[float, ...]:
        """Airspeeds at which the autopilot is designed [m/s], ascending."""
        step = (self.airspeed_max - self.airspeed_min) / (DESIGN_AIRSPEEDS - 1)
        return tuple(self.airspeed_min + i * step for i in range(DESIGN_AIRSPEEDS))


SHARED_FOLDERS = {
    "propulsion": "engine",
    "engine": "engine",
    "thruster": "engine",
    "flight_control": "systems",
    "system": "systems",
    "autopilot": "systems",
}
"""Folder of a JSBSim root that holds the files of an XML element."""

_MODEL_SUBFOLDERS = ("", "Engines", "Systems", "systems")
"""Folders of a model in which JSBSim looks for files, in order."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ModelFiles:
    """Where the files of one JSBSim model are.

    Attributes
    ----------
    model : name of the model
    folder : folder of the model file, ``MODEL.xml``
    roots : JSBSim roots whose engines and systems the model may name, in order of search
    """

    model: str
    folder: Path
    roots: tuple[Path, ...]

    @property
    def file(self) -> Path:
        """The model file."""
        return self.folder / f"{self.model}.xml"

    def find(self, element: ET.Element) -> Path | None:
        """File that an element of the model names, found in JSBSim's order of search, or None."""
        file = element.get("file")
        if not file:
            return None
        name = file if file.endswith(".xml") else f"{file}.xml"
        folders = [self.folder / subfolder for subfolder in _MODEL_SUBFOLDERS]
        if element.tag in SHARED_FOLDERS:
            folders += [root / SHARED_FOLDERS[element.tag] for root in self.roots]
        return next((folder / name for folder in folders if (folder / name).is_file()), None)


@dataclass(frozen=True, slots=True, kw_only=True)
class AircraftSpec:
    """An aircraft.

    Attributes
    ----------
    name : as the user types it, e.g. ``x8``
    title : as reports print it
    root : JSBSim root directory with ``aircraft/`` and ``engine/``
    model : JSBSim model name
    folder : folder of the model file, if it is not ``root/aircraft/model``
    other_roots : further JSBSim roots whose engines and systems the model may name
    inputs : control inputs ``elevator``, ``aileron``, ``throttle``, and ``rudder`` if there is one
    own_actuators : actuators, such as a flying wing's elevons; empty for one per control input
    driven_states : servo and propeller states that have a JSBSim property, at most one for each
        input; the lags of other inputs are measured
    envelope : envelope published by the aircraft's maker or the model's author; None to find one by
        trimming
    configuration : JSBSim properties set in every flight, such as a retracted gear
    engine_flags : JSBSim properties that are 1 while an engine runs
    alpha_max : largest angle of attack at which the model is valid [rad]; NaN if unknown
    settle_time : time in which servos and engines come to rest while the aircraft is held [s]
    source : source of the model's numbers
    """

    name: str
    title: str
    root: Path
    model: str
    folder: Path | None = None
    other_roots: tuple[Path, ...] = ()
    inputs: tuple[ControlInput, ...]
    own_actuators: tuple[Actuator, ...] = ()
    driven_states: tuple[DrivenState, ...] = ()
    envelope: Envelope | None = None
    configuration: tuple[tuple[str, float], ...] = ()
    engine_flags: tuple[str, ...] = ()
    alpha_max: float = math.nan
    settle_time: float = 2.0
    source: str

    @property
    def files(self) -> ModelFiles:
        """Where the model's files are."""
        folder = self.folder or self.root / "aircraft" / self.model
        return ModelFiles(model=self.model, folder=folder, roots=(self.root, *self.other_roots))

    @property
    def actuators(self) -> tuple[Actuator, ...]:
        """The aircraft's own actuators, or one for each control input."""
        return self.own_actuators or tuple(
            Actuator(name=i.name, commands=i.commands) for i in self.inputs
        )

    def input(self, name: str) -> ControlInput:
        """Control input ``name``; raises AircraftError if there is no such input."""
        for control_input in self.inputs:
            if control_input.name == name:
                return control_input
        known = ", ".join(i.name for i in self.inputs)
        raise AircraftError(f"aircraft '{self.name}' has no input '{name}'; it has {known}")


def surface(name: str) -> ControlInput:
    """Control input of a surface by JSBSim's name: elevator, aileron or rudder."""
    return ControlInput(name=name, commands=(f"fcs/{name}-cmd-norm",), lower=-1.0, upper=1.0)


def throttle(engines: int) -> ControlInput:
    """Control input of one throttle for all engines."""
    commands = tuple(f"fcs/throttle-cmd-norm{engine_suffix(i)}" for i in range(engines))
    return ControlInput(name="throttle", commands=commands, lower=0.0, upper=1.0)


def engine_suffix(engine: int) -> str:
    """Suffix of an engine's JSBSim properties, such as ``[1]``; empty for the first engine."""
    return f"[{engine}]" if engine else ""


def servo_position(name: str) -> DrivenState:
    """Driven state of a servo: deflection of the control surface ``name`` [rad]."""
    return DrivenState(name=f"{name}_position", position=f"fcs/{name}-pos-rad", input=name)


def propeller_speed() -> DrivenState:
    """Driven state of the only engine's propeller: its speed [rad/s]."""
    return DrivenState(
        name="propeller_speed",
        position="propulsion/engine/propeller-rpm",
        input="throttle",
        scale=RAD_S_PER_RPM,
    )


def check_spec(spec: AircraftSpec) -> None:
    """Refuse a spec for which no autopilot can be designed.

    Raises
    ------
    AircraftError : a field has another type than declared; a name does not match ``NAME``; an input
        is missing, unknown or repeated; a driven state follows no input, or one that already has a
        state; a range, an actuator, the settle time or the envelope is impossible
    """
    problem = _type_problem(spec, AircraftSpec, "") or next(_problems(spec), "")
    if problem:
        raise AircraftError(f"aircraft '{spec.name}': {problem}; correct its spec")


def _problems(spec: AircraftSpec) -> Iterator[str]:
    """Errors in the values of a spec, in words."""
    if not NAME.fullmatch(spec.name):
        yield f"'{spec.name}' is not a valid name; {NAME_RULE}"
    names = [i.name for i in spec.inputs]
    allowed = {*_REQUIRED_INPUTS, *_OPTIONAL_INPUTS}
    if not set(_REQUIRED_INPUTS) <= set(names) <= allowed or len(names) > len(set(names)):
        yield (
            f"it has the inputs {', '.join(names) or '(none)'}; it needs"
            f" {', '.join(_REQUIRED_INPUTS)}, may have {', '.join(_OPTIONAL_INPUTS)}, and no others"
        )
    for control_input in spec.inputs:
        yield from _input_problems(control_input)
    driven = [state.input for state in spec.driven_states]
    for i, state in enumerate(spec.driven_states):
        if state.input not in names or state.input in driven[:i]:
            yield (
                f"driven state '{state.name}' follows input '{state.input}'; it must be one of"
                f" {', '.join(names)} that no other state follows"
            )
    taken = [actuator.name for actuator in spec.own_actuators]
    for i, actuator in enumerate(spec.own_actuators):
        if not _ACTUATOR_NAME.fullmatch(actuator.name) or actuator.name in taken[:i]:
            yield f"'{actuator.name}' is not a valid name of an actuator, or is taken; {NAME_RULE}"
        if not actuator.commands:
            yield (
                f"actuator '{actuator.name}' has no commands; name the JSBSim properties that"
                " command it"
            )
        elif actuator.feedback is None and not any(
            set(actuator.commands) <= set(i.commands) for i in spec.inputs
        ):
            yield (
                f"actuator '{actuator.name}' has commands of no control input and no feedback;"
                " name the properties that read its command and position"
            )
    least, most = SETTLE_TIMES
    if not least <= spec.settle_time <= most:
        yield f"settle_time is {spec.settle_time:g} s; it must lie between {least:g} and {most:g} s"
    if spec.envelope is not None and spec.envelope.problem:
        yield spec.envelope.problem


def _input_problems(control: ControlInput) -> Iterator[str]:
    if not control.commands:
        yield f"input '{control.name}' has no commands; name the JSBSim properties that take it"
    given = f"input '{control.name}' ranges from {control.lower:g} to {control.upper:g}"
    if not -math.inf < control.lower < control.upper < math.inf:
        yield f"{given}; lower must be below upper, and both finite"
    elif control.name != "throttle" and not control.lower < 0.0 < control.upper:
        yield f"{given}; lower must be below 0, and upper above it"


def _type_problem(value: Any, declared: Any, name: str) -> str:
    """Message about the first part of a value whose type differs from the declared one, or "".

    Python does not check the types of dataclass fields in a user's file. Any real number counts as
    a float, and a list counts as a tuple of any length.
    """
    origin = typing.get_origin(declared)
    if origin in (typing.Union, types.UnionType):
        (other,) = (kind for kind in typing.get_args(declared) if kind is not types.NoneType)
        return "" if value is None else _type_problem(value, other, name)
    if origin is tuple:
        parts = _tuple_parts(value, typing.get_args(declared), name)
        demanded = str(declared).replace("aircraft.spec.", "")
    elif declared is float:
        is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
        parts, demanded = [] if is_number else None, "float"
    else:
        parts, demanded = _field_parts(value, declared, name), declared.__name__
    if parts is None:
        shown = " ".join(shortened(value).split())
        return f"{name} is {shown}, of type {type(value).__name__}; it must be of type {demanded}"
    return next(filter(None, (_type_problem(*part) for part in parts)), "")


_Parts = list[tuple[Any, Any, str]] | None
"""Parts of a value with their declared types and names; None if the value has another type."""


def _tuple_parts(value: Any, kinds: tuple[Any, ...], name: str) -> _Parts:
    if kinds[1:] == (...,):
        if not isinstance(value, (tuple, list)):
            return None
        kinds = (kinds[0],) * len(value)
    elif not isinstance(value, tuple) or len(value) != len(kinds):
        return None
    return [(item, kinds[i], f"{name}[{i}]") for i, item in enumerate(value)]


def _field_parts(value: Any, declared: type, name: str) -> _Parts:
    if not isinstance(value, declared):
        return None
    if not dataclasses.is_dataclass(declared):
        return []
    hints = _type_hints(declared)
    prefix = f"{name}." if name else ""
    names = [field.name for field in dataclasses.fields(declared)]
    return [(getattr(value, field), hints[field], f"{prefix}{field}") for field in names]


_type_hints = functools.cache(typing.get_type_hints)
