"""Adapt control inputs to a linear design: linear surfaces, and a throttle limited to flight idle.

Many surfaces travel further one way than the other, and some reach their stop before the command
reaches its limit. No linear model holds across such a kink. The moment of each surface is therefore
measured over its command, and the autopilot commands the effect, which is proportional to the
moment.

Flight idle is the throttle at which an aircraft decelerates most. A propeller on an electric motor
brakes most while it still turns: JSBSim's motor stops it when it gets no voltage, and a stopped
propeller has half the drag of a windmilling one. The autopilot never commands less throttle than
flight idle.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from aircraft.fdm import Fdm
from aircraft.spec import AircraftError, AircraftSpec, ControlInput
from aircraft.trim import Trim

Array = npt.NDArray[np.float64]

AXES = {"elevator": 1, "aileron": 0, "rudder": 2}
"""Index in p, q, r of the angular acceleration that a surface controls."""

_STEPS = 8
"""Number of measured commands from 0 to either end of the range, without 0."""

_NONLINEARITY_MAX = 0.05
"""Largest deviation of a moment from a straight line that is not corrected, over its span [-]."""

_STOP_SLOPE = 0.05
"""Slope below which a surface counts as having reached its stop, over its mean slope [-]."""

_IDLE_STEP = 0.05
"""Steps of throttle in the search for flight idle [-]."""

_IDLE_GAIN_MIN = 0.05
"""Least relative gain in deceleration that justifies a flight idle above closed throttle [-]."""

_IDLE_SETTLED = 1e-5
"""Change of acceleration in a step below which the propeller counts as settled [m/s^2]."""


def with_linearised_controls(fdm: Fdm, level: Trim) -> AircraftSpec:
    """Spec whose surfaces are commanded by their effect, measured in the level flight ``level``.

    The effect is 0 at the command 0 and spans 2 from stop to stop. Surfaces that already have an
    ``effectiveness`` stay unchanged.

    Raises
    ------
    AircraftError : a surface has no effect, or moves the aircraft one way only
    """
    inputs = tuple(
        _linearised(fdm, level, i) if i.name in AXES and not i.effectiveness else i
        for i in fdm.spec.inputs
    )
    return replace(fdm.spec, inputs=inputs)


def _linearised(fdm: Fdm, level: Trim, control_input: ControlInput) -> ControlInput:
    cannot_fly = f"aircraft '{fdm.spec.name}' cannot be flown: its {control_input.name}"
    below = np.linspace(control_input.lower, 0.0, _STEPS + 1)
    above = np.linspace(0.0, control_input.upper, _STEPS + 1)
    commands = np.concatenate([below, above[1:]])
    moments = _moments(fdm, level, control_input.name, commands)
    span = float(np.ptp(moments))
    if not span > 0.0:
        raise AircraftError(f"{cannot_fly} has no effect")
    line = moments[0] + (moments[-1] - moments[0]) * (commands - commands[0]) / (
        commands[-1] - commands[0]
    )
    if float(np.max(np.abs(moments - line))) < _NONLINEARITY_MAX * span:
        return control_input
    low, high = _travel(commands, moments)
    if _STEPS in (low, high):
        raise AircraftError(f"{cannot_fly} moves it one way only")
    effects = 2.0 * (moments - moments[_STEPS]) / (moments[high] - moments[low])
    points = tuple(
        (float(effect), float(command))
        for effect, command in zip(effects[low : high + 1], commands[low : high + 1], strict=True)
    )
    return replace(control_input, lower=points[0][0], upper=points[-1][0], effectiveness=points)


def _moments(fdm: Fdm, level: Trim, name: str, commands: Array) -> Array:
    """Angular acceleration about the surface's axis over its commands [rad/s^2]."""
    moments = []
    with fdm.frozen():
        for value in commands:
            fdm.command({**level.inputs, name: float(value)})
            fdm.place(level.state())
            fdm.settle()
            moments.append(fdm.angular_acceleration()[AXES[name]])
    return np.array(moments)


def _travel(commands: Array, moments: Array) -> tuple[int, int]:
    """Indices of the first and last command of the range about 0 with a monotonic moment."""
    slopes = np.diff(moments) / np.diff(commands)
    moving = slopes / float(np.mean(slopes)) > _STOP_SLOPE
    low = high = _STEPS
    while low > 0 and moving[low - 1]:
        low -= 1
    while high < moments.size - 1 and moving[high]:
        high += 1
    return low, high


def with_flight_idle(fdm: Fdm, level: Trim) -> AircraftSpec:
    """Spec whose throttle closes only to flight idle, where the aircraft decelerates most.

    The search ends at the throttle of the level flight ``level``. The state of ``fdm`` is changed.
    """
    throttle = fdm.spec.input("throttle")
    throttles = np.arange(throttle.lower, level.inputs["throttle"], _IDLE_STEP)
    decelerations = []
    for value in throttles.tolist():
        fdm.command({**level.inputs, "throttle": value})
        fdm.place(level.state())
        with fdm.frozen():
            fdm.settle(_IDLE_SETTLED)
            decelerations.append(-fdm.acceleration_body()[0])
    most = int(np.argmax(decelerations))
    if not decelerations[most] > (1.0 + _IDLE_GAIN_MIN) * decelerations[0]:
        return fdm.spec
    idle = replace(throttle, lower=float(throttles[most]))
    return replace(fdm.spec, inputs=tuple(idle if i == throttle else i for i in fdm.spec.inputs))
