"""The Skywalker X8, a flying wing of 3 kg with elevons and an electric pusher."""

import math

from aircraft.fleet import AIRCRAFT
from aircraft.spec import (
    MODELS,
    Actuator,
    AircraftSpec,
    Envelope,
    Feedback,
    propeller_speed,
    servo_position,
    surface,
    throttle,
)

_ELEVONS = tuple(
    Actuator(
        name=f"{side}_elevon",
        commands=(f"fcs/{side}-elevon-cmd-rad",),
        feedback=Feedback(
            commanded=f"fcs/{side}-elevon-mixer",
            position=f"fcs/{side}-elevon-pos-rad",
            travel=0.5236,
        ),
    )
    for side in ("left", "right")
)

X8 = AircraftSpec(
    name="x8",
    title="Skywalker X8",
    root=MODELS,
    model="x8",
    inputs=(surface("elevator"), surface("aileron"), throttle(1)),
    own_actuators=(*_ELEVONS, Actuator(name="throttle", commands=throttle(1).commands)),
    driven_states=(servo_position("elevator"), servo_position("aileron"), propeller_speed()),
    envelope=Envelope(
        airspeed_min=15.0, airspeed_max=25.0, airspeed=19.42, bank=math.radians(45.0)
    ),
    # The published lift has no stall.
    alpha_max=0.2,
    source="Gryte et al., ICUAS 2018; inertia and propulsion as explained in the model file",
)
AIRCRAFT.register(X8.name)(X8)
