"""Detect stuck control surfaces from the positions that servos report.

A sound servo trails its command because of its lag and its limited speed. A stuck servo stays at
its position while its commands change. No model of the servo is needed to distinguish them: the
command of a sound servo has been at or beyond the present position within the last few tenths of a
second.
"""

from collections import deque
from collections.abc import Callable
from typing import NamedTuple

from aircraft.fdm import Fdm
from aircraft.spec import Feedback
from innerloop.jsbsim.system import commanded_property

_TRAVEL_TIME = 0.4
"""Longest time that a sound surface trails its command [s]: X8, 0.30 s of travel, 25 ms of lag."""


class _Surface(NamedTuple):
    """Command [-], position and travel [unit of the position] of a surface, and recent commands."""

    command: Callable[[], float]
    position: Callable[[], float]
    travel: float
    recent: deque[float]


class ServoMonitor:
    """Monitors every control surface of one aircraft in flight.

    The throttle is not monitored, because it moves no surface. Without a servo model, a surface is
    taken to be at the command that a fault may have overwritten.

    Parameters
    ----------
    fdm : simulation of an aircraft with its autopilot
    time_step : time between calls of ``watch`` or ``error`` [s]
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
        """Record the commands; return the largest distance of a surface from its recent commands.

        The distance is a fraction of the surface's travel [-].
        """
        worst = 0.0
        for command, position, travel, recent in self._surfaces:
            now = command()
            at = position() / travel
            recent.append(now)
            oldest = recent[0]
            # A surface between its oldest and newest command follows its commands.
            if not (oldest <= at <= now or now <= at <= oldest):
                off = at - max(recent) if at > now else min(recent) - at
                worst = off if off > worst else worst
        return worst
