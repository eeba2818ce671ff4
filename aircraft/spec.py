"""What the study must know of a JSBSim aircraft beyond its model files."""

import bisect
import math
from dataclasses import dataclass
from pathlib import Path

from aircraft.errors import AircraftError
from aircraft.units import RAD_S_PER_RPM

MODELS = Path(__file__).parent / "models"
"""The JSBSim root of the aircraft that this project brings."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ControlInput:
    """A normalised pilot command.

    Attributes
    ----------
    name : the input's name in linear models, e.g. ``elevator``
    commands : JSBSim properties that take the command, one for each engine or surface that shares it [-]
    lower, upper : range of the command [-]
    shape : points (effect, command) of a surface that is flown by its effect, ascending; then the range is that of the
        effect
    """

    name: str
    commands: tuple[str, ...]
    lower: float
    upper: float
    shape: tuple[tuple[float, float], ...] = ()

    def command(self, value: float) -> float:
        """Return what JSBSim is told for a value of this input, which is its effect where it has a shape [-]."""
        if not self.shape:
            return value
        i = min(max(bisect.bisect(self.shape, (value,)), 1), len(self.shape) - 1)
        (x0, y0), (x1, y1) = self.shape[i - 1], self.shape[i]
        return y0 + (y1 - y0) * (value - x0) / (x1 - x0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Feedback:
    """What a servo reports.

    Attributes
    ----------
    told, position : JSBSim properties of what it is told [-] and of where it is
    travel : position of a servo that has been told 1
    """

    told: str
    position: str
    travel: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator:
    """What moves one surface or every engine's throttle, and can stick (``aircraft.simulation.faults``).

    Attributes
    ----------
    name : what the user calls it, e.g. ``left_elevon``
    commands : JSBSim properties that tell it where to go: those of a control input, or one that an ``<actuator>``
        reads
    feedback : what it reports, if it is none of a control input's own
    """

    name: str
    commands: tuple[str, ...]
    feedback: Feedback | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DrivenState:
    """A state outside the rigid body that follows one input: a servo's deflection, a propeller's speed.

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
"""What the autopilot may bank beyond the bank that the guidance plans with [rad]."""

DESIGN_AIRSPEEDS = 5
"""Number of airspeeds at which an autopilot is designed."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope:
    """Where the autopilot may fly the aircraft.

    Attributes
    ----------
    airspeed_min, airspeed_max : range of commanded true airspeed [m/s]
    airspeed : at which the aircraft flies the study unless told otherwise [m/s]
    bank : of the coordinated turn that the guidance may ask for [rad]
    stall : stall airspeed in level flight; not a number where it is not known [m/s]
    notes : what set the limits
    """

    airspeed_min: float
    airspeed_max: float
    airspeed: float
    bank: float
    stall: float = math.nan
    notes: tuple[str, ...] = ()

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
    """An aircraft for this study.

    Attributes
    ----------
    name : what the user types, e.g. ``x8``
    title : what reports print
    root : JSBSim root directory that holds ``aircraft/`` and ``engine/``
    model : JSBSim model name
    inputs : control inputs; ``elevator``, ``aileron`` and ``throttle`` at least
    own_actuators : where they are not one for each control input: a flying wing's elevons
    driven_states : servo and propeller states that have a property of their own; lags that have none are measured
    envelope : where its maker or its model's author says that it flies; none where that is to be found by trimming it
    configuration : JSBSim properties and the values they have in every flight, such as a retracted gear
    engine_flags : JSBSim properties that are 1 while an engine runs
    settle_time : in which servos and engines stand still behind a held aircraft [s]
    source : where the model's numbers come from
    """

    name: str
    title: str
    root: Path
    model: str
    inputs: tuple[ControlInput, ...]
    own_actuators: tuple[Actuator, ...] = ()
    driven_states: tuple[DrivenState, ...] = ()
    envelope: Envelope | None = None
    configuration: tuple[tuple[str, float], ...] = ()
    engine_flags: tuple[str, ...] = ()
    settle_time: float = 2.0
    source: str

    @property
    def actuators(self) -> tuple[Actuator, ...]:
        """Return what can stick: its own actuators, or one for each control input."""
        return self.own_actuators or tuple(Actuator(name=i.name, commands=i.commands) for i in self.inputs)

    def input(self, name: str) -> ControlInput:
        """Return the control input called ``name``; raises AircraftError where there is none."""
        for control_input in self.inputs:
            if control_input.name == name:
                return control_input
        raise AircraftError(f"aircraft '{self.name}' has no input '{name}'; it has {', '.join(i.name for i in self.inputs)}")


def surface(name: str) -> ControlInput:
    """Return the command of a control surface by the name that JSBSim gives it: elevator, aileron, rudder."""
    return ControlInput(name=name, commands=(f"fcs/{name}-cmd-norm",), lower=-1.0, upper=1.0)


def throttle(engines: int) -> ControlInput:
    """Return the one throttle of a number of engines."""
    commands = tuple(f"fcs/throttle-cmd-norm{numbered(engine)}" for engine in range(engines))
    return ControlInput(name="throttle", commands=commands, lower=0.0, upper=1.0)


def numbered(engine: int) -> str:
    """Return what JSBSim adds to an engine's properties: nothing for the first."""
    return f"[{engine}]" if engine else ""


def servo_position(name: str) -> DrivenState:
    """Return the deflection of the control surface ``name`` [rad], which a servo moves."""
    return DrivenState(name=f"{name}_position", position=f"fcs/{name}-pos-rad", input=name)


def propeller_speed() -> DrivenState:
    """Return the speed of an only engine's propeller [rad/s]."""
    return DrivenState(name="propeller_speed", position="propulsion/engine/propeller-rpm", input="throttle", scale=RAD_S_PER_RPM)
