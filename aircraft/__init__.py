"""Aircraft: JSBSim models, their simulation and linear models. Only this package uses JSBSim."""

from aircraft.spec import (
    MODELS,
    Actuator,
    AircraftError,
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
