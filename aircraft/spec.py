"""What the project has to know about a JSBSim aircraft beyond its model files: the contract of an
aircraft.
"""

import bisect
import math
import re
from dataclasses import dataclass, replace
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.model_files import ModelFiles
from common.physics.units import RAD_S_PER_RPM

MODELS = Path(__file__).parent / "models"
"""The JSBSim root of the project's own aircraft."""

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_.\-]*")
"""What an aircraft and its model may be called: the name becomes part of file names and of XML."""

SETTLE_TIMES = 0.1, 120.0
"""Range of the time in which servos and engines come to rest [s]."""

_AIRSPEED_MAX, _BANKS_DEG = 400.0, (5.0, 60.0)
"""Fastest airspeed of an envelope [m/s], and range of its bank [deg]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlInput:
    """A normalised pilot command.

    Attributes
    ----------
    name : the input's name in linear models, e.g. ``elevator``
    commands : JSBSim properties that take the command, one for each engine or surface that shares
        it [-]
    lower, upper : range of the command [-]
    effectiveness : points (effect, command) of a surface that is commanded by its effect,
        ascending; the range is then that of the effect
    """

    name: str
    commands: tuple[str, ...]
    lower: float
    upper: float
    effectiveness: tuple[tuple[float, float], ...] = ()

    def command(self, value: float) -> float:
        """Return the command to JSBSim for a value of this input: an effect, if its effectiveness
        is known [-].
        """
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
    commanded, position : JSBSim properties of its command [-] and of its position
    travel : position at a command of 1
    """

    commanded: str
    position: str
    travel: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator:
    """A device that moves one surface or every engine's throttle, and can stick
    (``aircraft.simulation.faults``).

    Attributes
    ----------
    name : as the user types it, e.g. ``left_elevon``
    commands : JSBSim properties that command it: those of a control input, or one that an
        ``<actuator>`` reads
    feedback : what it reports, if its command is not one of a control input's own
    """

    name: str
    commands: tuple[str, ...]
    feedback: Feedback | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenState:
    """A state outside the rigid body that follows one input: a servo's deflection, a propeller's
    speed.

    Attributes
    ----------
    name : the state's name in linear models
    position : JSBSim property that reads it
    input : name of the control input that drives it
    scale : SI value of one unit of the property
    """

    name: str
    position: str
    input: str
    scale: float = 1.0


BANK_RESERVE = math.radians(5.0)
"""Bank that the autopilot may use beyond the bank that the guidance plans with [rad]."""

DESIGN_AIRSPEEDS = 5
"""Number of airspeeds at which an autopilot is designed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope:
    """Airspeeds and banks at which the autopilot may fly the aircraft.

    Attributes
    ----------
    airspeed_min, airspeed_max : range of commanded true airspeed [m/s]
    airspeed : default airspeed of a study [m/s]
    bank : of the steepest coordinated turn that the guidance may demand [rad]
    stall : stall airspeed in level flight; NaN if unknown [m/s]
    notes : reasons for the limits
    """

    airspeed_min: float
    airspeed_max: float
    airspeed: float
    bank: float
    stall: float = math.nan
    notes: tuple[str, ...] = ()

    @property
    def fault(self) -> str:
        """Return why no autopilot can be designed for these airspeeds, or this bank, and the
        remedy; empty if one can.
        """
        if not 0.0 < self.airspeed_min < self.airspeed < self.airspeed_max <= _AIRSPEED_MAX:
            return (
                f"airspeed is {self.airspeed:g} m/s; it must lie between airspeed_min, {self.airspeed_min:g}, and airspeed_max,"
                f" {self.airspeed_max:g} m/s, and these above 0 and up to {_AIRSPEED_MAX:g}: choose others"
            )
        least, most = _BANKS_DEG
        if not math.radians(least) <= self.bank <= math.radians(most):
            return (
                f"bank is {math.degrees(self.bank):g} deg ({self.bank:g} rad); it must lie between {least:g} and {most:g} deg:"
                " give radians in Python, degrees in a file of settings"
            )
        return ""

    @property
    def bank_max(self) -> float:
        """Return the largest bank that the autopilot commands [rad]."""
        return self.bank + BANK_RESERVE

    @property
    def design_airspeeds(self) -> tuple[float, ...]:
        """Return the airspeeds at which the autopilot is designed [m/s], ascending."""
        step = (self.airspeed_max - self.airspeed_min) / (DESIGN_AIRSPEEDS - 1)
        return tuple(self.airspeed_min + i * step for i in range(DESIGN_AIRSPEEDS))


@dataclass(frozen=True, slots=True, kw_only=True)
class AircraftSpec:
    """An aircraft: what a file in ``aircraft/fleet``, an entry point or a Python file of the user
    has to provide.

    Attributes
    ----------
    name : as the user types it, e.g. ``x8``
    title : as reports print it
    root : JSBSim root directory that holds ``aircraft/`` and ``engine/``
    model : JSBSim model name
    folder : of the model file, if it is not ``root/aircraft/model``
    other_roots : further JSBSim roots whose engines and systems the model may name
    inputs : control inputs: ``elevator``, ``aileron`` and ``throttle``, perhaps ``rudder``, and no
        others
    own_actuators : only if they are not one for each control input, such as a flying wing's elevons
    driven_states : servo and propeller states that have a property of their own, one of an input;
        other lags are measured
    envelope : as published by its maker or its model's author; None if it is to be found by
        trimming
    configuration : JSBSim properties and their values in every flight, such as a retracted gear
    engine_flags : JSBSim properties that are 1 while an engine runs
    alpha_max : largest angle of attack of an equilibrium, up to which the model is right; not a
        number if not known [rad]
    settle_time : in which servos and engines come to rest while the aircraft is held [s]
    source : of the model's numbers
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
        """Return where the model's files are."""
        folder = self.folder or self.root / "aircraft" / self.model
        return ModelFiles(model=self.model, folder=folder, roots=(self.root, *self.other_roots))

    def placed(self, other: "AircraftSpec") -> "AircraftSpec":
        """Return this aircraft with its files where those of ``other`` are."""
        return replace(self, root=other.root, folder=other.folder, other_roots=other.other_roots)

    @property
    def actuators(self) -> tuple[Actuator, ...]:
        """Return the actuators: its own ones, or one for each control input."""
        return self.own_actuators or tuple(
            Actuator(name=i.name, commands=i.commands) for i in self.inputs
        )

    def input(self, name: str) -> ControlInput:
        """Return the control input called ``name``; raises AircraftError if there is no such input."""
        for control_input in self.inputs:
            if control_input.name == name:
                return control_input
        raise AircraftError(
            f"aircraft '{self.name}' has no input '{name}'; it has {', '.join(i.name for i in self.inputs)}"
        )


def surface(name: str) -> ControlInput:
    """Return the command of a control surface by the name that JSBSim gives it: elevator, aileron,
    rudder.
    """
    return ControlInput(name=name, commands=(f"fcs/{name}-cmd-norm",), lower=-1.0, upper=1.0)


def throttle(engines: int) -> ControlInput:
    """Return the one throttle of a number of engines."""
    commands = tuple(f"fcs/throttle-cmd-norm{numbered(engine)}" for engine in range(engines))
    return ControlInput(name="throttle", commands=commands, lower=0.0, upper=1.0)


def numbered(engine: int) -> str:
    """Return the suffix of an engine's properties in JSBSim: empty for the first engine."""
    return f"[{engine}]" if engine else ""


def servo_position(name: str) -> DrivenState:
    """Return the deflection of the control surface ``name`` [rad], which a servo moves."""
    return DrivenState(name=f"{name}_position", position=f"fcs/{name}-pos-rad", input=name)


def propeller_speed() -> DrivenState:
    """Return the speed of an only engine's propeller [rad/s]."""
    return DrivenState(
        name="propeller_speed",
        position="propulsion/engine/propeller-rpm",
        input="throttle",
        scale=RAD_S_PER_RPM,
    )
