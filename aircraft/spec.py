"""What the study must know of a JSBSim aircraft beyond its model files. A new aircraft is one more entry in ``SPECS``."""

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
    command : JSBSim property that takes the command [-]
    lower, upper : range of the command [-]
    """

    name: str
    command: str
    lower: float
    upper: float


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


@dataclass(frozen=True, slots=True, kw_only=True)
class Envelope:
    """Where the autopilot may fly the aircraft.

    Attributes
    ----------
    airspeed_min, airspeed_max : range of commanded true airspeed [m/s]
    bank_max : largest commanded bank angle [rad]
    """

    airspeed_min: float
    airspeed_max: float
    bank_max: float


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
    driven_states : servo and propeller states
    envelope : limits of the autopilot
    design_airspeeds : airspeeds at which the autopilot is designed [m/s], ascending
    source : where the model's numbers come from
    """

    name: str
    title: str
    root: Path
    model: str
    inputs: tuple[ControlInput, ...]
    driven_states: tuple[DrivenState, ...]
    envelope: Envelope
    design_airspeeds: tuple[float, ...]
    source: str

    def input(self, name: str) -> ControlInput:
        """Return the control input called ``name``; raises AircraftError where there is none."""
        for control_input in self.inputs:
            if control_input.name == name:
                return control_input
        raise AircraftError(f"aircraft '{self.name}' has no input '{name}'; it has {', '.join(i.name for i in self.inputs)}")


X8 = AircraftSpec(
    name="x8",
    title="Skywalker X8",
    root=MODELS,
    model="x8",
    inputs=(
        ControlInput(name="elevator", command="fcs/elevator-cmd-norm", lower=-1.0, upper=1.0),
        ControlInput(name="aileron", command="fcs/aileron-cmd-norm", lower=-1.0, upper=1.0),
        ControlInput(name="throttle", command="fcs/throttle-cmd-norm", lower=0.0, upper=1.0),
    ),
    driven_states=(
        DrivenState(name="elevator_position", position="fcs/elevator-pos-rad", input="elevator"),
        DrivenState(name="aileron_position", position="fcs/aileron-pos-rad", input="aileron"),
        DrivenState(name="propeller_speed", position="propulsion/engine/propeller-rpm", input="throttle", scale=RAD_S_PER_RPM),
    ),
    envelope=Envelope(airspeed_min=15.0, airspeed_max=25.0, bank_max=0.8727),
    design_airspeeds=(14.0, 17.0, 20.0, 23.0, 26.0),
    source="Gryte et al., ICUAS 2018; inertia and propulsion as explained in the model file",
)

AEROSONDE = AircraftSpec(
    name="aerosonde",
    title="Aerosonde",
    root=MODELS,
    model="aerosonde",
    inputs=(
        ControlInput(name="elevator", command="fcs/elevator-cmd-norm", lower=-1.0, upper=1.0),
        ControlInput(name="aileron", command="fcs/aileron-cmd-norm", lower=-1.0, upper=1.0),
        ControlInput(name="throttle", command="fcs/throttle-cmd-norm", lower=0.0, upper=1.0),
        ControlInput(name="rudder", command="fcs/rudder-cmd-norm", lower=-1.0, upper=1.0),
    ),
    driven_states=(
        DrivenState(name="elevator_position", position="fcs/elevator-pos-rad", input="elevator"),
        DrivenState(name="aileron_position", position="fcs/aileron-pos-rad", input="aileron"),
        DrivenState(name="propeller_speed", position="propulsion/engine/propeller-rpm", input="throttle", scale=RAD_S_PER_RPM),
        DrivenState(name="rudder_position", position="fcs/rudder-pos-rad", input="rudder"),
    ),
    envelope=Envelope(airspeed_min=21.0, airspeed_max=30.0, bank_max=0.8727),
    design_airspeeds=(20.0, 22.5, 25.0, 27.5, 30.0),
    source="Beard and McLain, Small Unmanned Aircraft, supplement; servos and rotor inertia as explained in the model files",
)

SPECS: dict[str, AircraftSpec] = {aircraft.name: aircraft for aircraft in (X8, AEROSONDE)}
"""Every aircraft that commands accept."""


def find_spec(name: str) -> AircraftSpec:
    """Return the aircraft called ``name``; raises AircraftError that lists the known ones."""
    try:
        return SPECS[name]
    except KeyError:
        raise AircraftError(f"unknown aircraft '{name}'; known: {', '.join(sorted(SPECS))}") from None
