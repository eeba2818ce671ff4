"""Whether the control surfaces follow their commands, from the positions that servos report.

A sound servo trails its command by its lag and its limited speed, from stop to stop when a turn is
reversed. A stuck servo stays where it is while its commands change. Time distinguishes them without
a model of the servo: the command of a sound servo was at its present position, or beyond, within
the last few tenths of a second.
"""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from aircraft.fdm import Fdm
from aircraft.spec import Feedback
from innerloop.jsbsim.system import commanded_property

_TRAVEL_TIME = 0.4
"""Longest time a sound surface may trail its command [s]: the X8's travels 0.30 s, lags 25 ms."""


class _Surface(NamedTuple):
    """Command [-] and position of a surface, its travel [unit of position], and recent commands."""

    command: Callable[[], float]
    position: Callable[[], float]
    travel: float
    recent: deque[float]


class ServoMonitor:
    """Monitors every control surface of one aircraft in flight.

    The throttle is not monitored: it moves no surface. A control input without a servo model counts
    as being at its command, as it is behind the switch of a fault.

    Parameters
    ----------
    fdm : of an aircraft with its autopilot
    time_step : between calls of ``watch`` or ``error`` [s]
    """

    def __init__(self, fdm: Fdm, time_step: float) -> None:
        self._surfaces: list[_Surface] = []
        for actuator in fdm.spec.actuators:
            control_input = next(
                (i for i in fdm.spec.inputs if set(actuator.commands) <= set(i.commands)), None
            )
            if control_input is not None and control_input.name == "throttle":
                continue
            feedback = actuator.feedback
            if feedback is None and control_input is not None:
                feedback = Feedback(
                    commanded=commanded_property(control_input),
                    position=control_input.commands[0],
                    travel=1.0,
                )
            if feedback is None:
                continue
            self._surfaces.append(
                _Surface(
                    command=fdm.node(feedback.commanded).get_double_value,
                    position=fdm.node(feedback.position).get_double_value,
                    travel=feedback.travel,
                    recent=deque(maxlen=1 + round(_TRAVEL_TIME / time_step)),
                )
            )

    def watch(self) -> None:
        """Record the commands."""
        for surface in self._surfaces:
            surface.recent.append(surface.command())

    def error(self) -> float:
        """Record the commands; return the largest distance of a surface from the recent ones [-].

        The distance is a fraction of the surface's travel.
        """
        worst = 0.0
        for command, position, travel, recent in self._surfaces:
            now = command()
            at = position() / travel
            recent.append(now)
            oldest = recent[0]
            # Between the oldest and the newest command a surface is at no distance from them.
            if not (oldest <= at <= now or now <= at <= oldest):
                off = at - max(recent) if at > now else min(recent) - at
                worst = off if off > worst else worst
        return worst
