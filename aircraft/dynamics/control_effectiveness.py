"""Straightening controls: what a surface does, over what it is told.

Many aircraft travel further one way than the other, and some surfaces stop before their command does; about such a
kink no linear model holds. So the moment of each surface is measured over its command, and the aircraft is then flown
by a command that is proportional to that moment.
"""

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from aircraft.dynamics.equilibrium import Trim
from aircraft.errors import AircraftError
from aircraft.simulation.fdm import Fdm
from aircraft.spec import AircraftSpec, ControlInput

AXES = {"elevator": 1, "aileron": 0, "rudder": 2}
"""Axis of the angular acceleration that a surface is there for: p, q, r."""

_COMMANDS = np.linspace(-1.0, 1.0, 17)
_STRAIGHT = 0.05
"""A surface whose moment keeps this near to a straight line, over its span, is left as it is [-]."""

_FLAT = 0.05
"""Slope below which a surface counts as having reached its stop, over its mean slope [-]."""


def straightened(fdm: Fdm, level: Trim) -> AircraftSpec:
    """Return the aircraft's spec with its surfaces straightened, measured in the level flight of ``level``.

    The new commands run from 0 at the old 0, and over 2 from stop to stop. Surfaces that were straightened before are
    left.

    Raises
    ------
    AircraftError : a surface does nothing
    """
    inputs = tuple(_straighten(fdm, level, i) if i.name in AXES and not i.shape else i for i in fdm.spec.inputs)
    return replace(fdm.spec, inputs=inputs)


def _straighten(fdm: Fdm, level: Trim, control_input: ControlInput) -> ControlInput:
    moment = _moments(fdm, level, control_input.name)
    span = float(np.ptp(moment))
    if not span > 0.0:
        raise AircraftError(f"aircraft '{fdm.spec.name}' cannot be flown: its {control_input.name} does nothing")
    straight = moment[0] + (moment[-1] - moment[0]) * 0.5 * (_COMMANDS + 1.0)
    if float(np.max(np.abs(moment - straight))) < _STRAIGHT * span:
        return control_input
    low, high = _travel(moment)
    if _COMMANDS.size // 2 in (low, high):
        raise AircraftError(f"aircraft '{fdm.spec.name}' cannot be flown: its {control_input.name} moves it one way only")
    effect = 2.0 * (moment - moment[_COMMANDS.size // 2]) / (moment[high] - moment[low])
    shape = tuple((float(e), float(c)) for e, c in zip(effect[low : high + 1], _COMMANDS[low : high + 1], strict=True))
    return replace(control_input, lower=shape[0][0], upper=shape[-1][0], shape=shape)


def _moments(fdm: Fdm, level: Trim, name: str) -> npt.NDArray[np.float64]:
    """Return the angular acceleration about the surface's axis over ``_COMMANDS`` [rad/s^2]."""
    moments = []
    with fdm.frozen():
        for value in _COMMANDS:
            fdm.command({**level.inputs, name: float(value)})
            fdm.place(level.state())
            fdm.settle()
            moments.append(fdm.angular_acceleration()[AXES[name]])
    return np.array(moments)


def _travel(moment: npt.NDArray[np.float64]) -> tuple[int, int]:
    """Return the first and the last command between which the moment grows or falls all the way, about the middle."""
    slopes = np.diff(moment)
    mean = float(np.mean(slopes))
    moving = slopes / mean > _FLAT
    middle = moment.size // 2
    low = high = middle
    while low > 0 and moving[low - 1]:
        low -= 1
    while high < moment.size - 1 and moving[high]:
        high += 1
    return low, high
