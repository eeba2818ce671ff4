"""Linearising control effectiveness: the moment of each control surface over its command.

Many aircraft's surfaces travel further one way than the other, and some stop before their command
does; about such a kink no linear model holds. So the moment of each surface is measured over its
command, and the autopilot then commands the effect, which is proportional to the moment.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from aircraft.dynamics.equilibrium import Trim
from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from aircraft.spec import AircraftSpec, ControlInput

AXES = {"elevator": 1, "aileron": 0, "rudder": 2}
"""Axis of the angular acceleration that a surface controls: p, q, r."""

_STEPS = 8
"""Steps of the command from 0 to either end of its range, at which the moment is measured [-]."""

_NONLINEARITY_MAX = 0.05
"""Largest deviation of a moment from a straight line, over its span, for which the surface is left
as it is [-].
"""

_STOP_SLOPE = 0.05
"""Slope below which a surface counts as having reached its stop, over its mean slope [-]."""


def with_linearised_controls(fdm: Fdm, level: Trim) -> AircraftSpec:
    """Return the aircraft's spec with surfaces commanded by their effect, measured in the level
    flight of ``level``.

    The effect is 0 at the command 0, and spans 2 from stop to stop, within the range of the
    command. Surfaces that have an effectiveness are left as they are.

    Raises
    ------
    AircraftError : a surface has no effect
    """
    inputs = tuple(
        _linearised(fdm, level, i) if i.name in AXES and not i.effectiveness else i
        for i in fdm.spec.inputs
    )
    return replace(fdm.spec, inputs=inputs)


def _linearised(fdm: Fdm, level: Trim, control_input: ControlInput) -> ControlInput:
    commands = _commands(control_input)
    moment = _moments(fdm, level, control_input.name, commands)
    span = float(np.ptp(moment))
    if not span > 0.0:
        raise AircraftError(
            f"aircraft '{fdm.spec.name}' cannot be flown: its {control_input.name} has no effect"
        )
    line = moment[0] + (moment[-1] - moment[0]) * (commands - commands[0]) / (
        commands[-1] - commands[0]
    )
    if float(np.max(np.abs(moment - line))) < _NONLINEARITY_MAX * span:
        return control_input
    low, high = _travel(commands, moment)
    if _STEPS in (low, high):
        raise AircraftError(
            f"aircraft '{fdm.spec.name}' cannot be flown: its {control_input.name} moves it one way only"
        )
    effect = 2.0 * (moment - moment[_STEPS]) / (moment[high] - moment[low])
    points = tuple(
        (float(e), float(c))
        for e, c in zip(effect[low : high + 1], commands[low : high + 1], strict=True)
    )
    return replace(control_input, lower=points[0][0], upper=points[-1][0], effectiveness=points)


def _commands(control_input: ControlInput) -> npt.NDArray[np.float64]:
    """Return the commands at which the moment is measured [-]: over the input's range, in whose
    middle one is 0.
    """
    below = np.linspace(control_input.lower, 0.0, _STEPS + 1)
    return np.concatenate([below, np.linspace(0.0, control_input.upper, _STEPS + 1)[1:]])


def _moments(
    fdm: Fdm, level: Trim, name: str, commands: npt.NDArray[np.float64]
) -> npt.NDArray[np.float64]:
    """Return the angular acceleration about the surface's axis over its commands [rad/s^2]."""
    moments = []
    with fdm.frozen():
        for value in commands:
            fdm.command({**level.inputs, name: float(value)})
            fdm.place(level.state())
            fdm.settle()
            moments.append(fdm.angular_acceleration()[AXES[name]])
    return np.array(moments)


def _travel(commands: npt.NDArray[np.float64], moment: npt.NDArray[np.float64]) -> tuple[int, int]:
    """Return the indices of the first and the last command of the range about 0 in which the moment
    is monotonic.
    """
    slopes = np.diff(moment) / np.diff(commands)
    mean = float(np.mean(slopes))
    moving = slopes / mean > _STOP_SLOPE
    low = high = _STEPS
    while low > 0 and moving[low - 1]:
        low -= 1
    while high < moment.size - 1 and moving[high]:
        high += 1
    return low, high
