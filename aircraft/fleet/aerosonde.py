"""The Aerosonde of Beard and McLain, with elevator, ailerons, rudder and a pusher propeller."""

import math

from aircraft.fleet import AIRCRAFT
from aircraft.spec import (
    MODELS,
    AircraftSpec,
    Envelope,
    propeller_speed,
    servo_position,
    surface,
    throttle,
)

AEROSONDE = AircraftSpec(
    name="aerosonde",
    title="Aerosonde",
    root=MODELS,
    model="aerosonde",
    inputs=(surface("elevator"), surface("aileron"), throttle(1), surface("rudder")),
    driven_states=(
        servo_position("elevator"),
        servo_position("aileron"),
        propeller_speed(),
        servo_position("rudder"),
    ),
    envelope=Envelope(airspeed_min=21.0, airspeed_max=30.0, airspeed=25.0, bank=math.radians(45.0)),
    source=(
        "Beard and McLain, Small Unmanned Aircraft, supplement; servos and rotor inertia as"
        " explained in the model files"
    ),
)
AIRCRAFT.register(AEROSONDE.name)(AEROSONDE)
