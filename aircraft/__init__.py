"""Aircraft: JSBSim models, their simulation and their linear models; no other room touches JSBSim."""

from aircraft.errors import AircraftError
from aircraft.spec import (
    MODELS,
    Actuator,
    AircraftSpec,
    ControlInput,
    DrivenState,
    Envelope,
    Feedback,
    propeller_speed,
    servo_position,
    surface,
    throttle,
)

__all__ = [
    "MODELS",
    "Actuator",
    "AircraftError",
    "AircraftSpec",
    "ControlInput",
    "DrivenState",
    "Envelope",
    "Feedback",
    "propeller_speed",
    "servo_position",
    "surface",
    "throttle",
]
