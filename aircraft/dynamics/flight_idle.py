"""Flight idle: the throttle at which an aircraft decelerates most.

A propeller on an electric motor brakes most while it still turns: without voltage JSBSim's motor
holds it still, and a stopped propeller has half the drag of a windmilling one. To slow down, an
autopilot must not go below that throttle.
"""

from dataclasses import replace

import numpy as np

from aircraft.dynamics.equilibrium import Trim
from aircraft.simulation.fdm import Fdm
from aircraft.spec import AircraftSpec

_STEP = 0.05
"""Steps of throttle in the search [-]."""

_GAIN_MIN = 0.05
"""Least gain in deceleration, over that with closed throttle, for which flight idle is above it
[-].
"""

_SETTLED = 1e-5
"""Change of acceleration a step below which the propeller counts as settled [m/s^2]."""


def flight_idle(fdm: Fdm, trim: Trim) -> float:
    """Return the throttle, from closed up to that of level flight, at which the aircraft
    decelerates most.

    Parameters
    ----------
    fdm : the aircraft; its state is changed
    trim : level flight
    """
    throttle = fdm.spec.input("throttle")
    throttles = np.arange(throttle.lower, trim.inputs["throttle"], _STEP)
    decelerations = []
    for value in throttles.tolist():
        fdm.command({**trim.inputs, "throttle": value})
        fdm.place(trim.state())
        with fdm.frozen():
            fdm.settle(_SETTLED)
            decelerations.append(-fdm.acceleration_body()[0])
    most = int(np.argmax(decelerations))
    return (
        float(throttles[most])
        if decelerations[most] > (1.0 + _GAIN_MIN) * decelerations[0]
        else throttle.lower
    )


def idling_at(spec: AircraftSpec, idle: float) -> AircraftSpec:
    """Return the aircraft with a throttle that closes no further than ``idle`` [-]."""
    inputs = tuple(replace(i, lower=idle) if i.name == "throttle" else i for i in spec.inputs)
    return replace(spec, inputs=inputs)
