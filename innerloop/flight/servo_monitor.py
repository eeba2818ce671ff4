"""Whether the control surfaces follow their commands, from what their servos report.

A sound servo trails its command by its lag and its limited speed, from stop to stop when a turn is
reversed; a stuck one stays where it is while its commands change. What distinguishes them without a
model of the servo is time: wherever a sound servo is, its command was there, or beyond, within the
last few tenths of a second.
"""

from collections import deque

from aircraft.fdm import Fdm
from aircraft.spec import Feedback
from innerloop.jsbsim.properties import commanded_property

_TRAVEL_TIME = 0.4
"""Longest time a sound surface may trail its command [s]: the X8's takes 0.30 s from stop to stop
and lags by 25 ms."""


class ServoMonitor:
    """Monitors every control surface of one aircraft in flight.

    The throttle is not monitored, for no surface moves with it. A control input without a servo
    model is taken to be at its command, as it is behind the switch of a fault.

    Parameters
    ----------
    fdm : of an aircraft with its autopilot
    time_step : between looks at the commands, by ``watch`` or ``error`` [s]
    """

    __slots__ = ("_surfaces",)

    def __init__(self, fdm: Fdm, time_step: float) -> None:
        self._surfaces = []
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
            command, position = (
                fdm.node(name).get_double_value for name in (feedback.commanded, feedback.position)
            )
            recent: deque[float] = deque(maxlen=1 + round(_TRAVEL_TIME / time_step))
            self._surfaces.append((command, position, feedback.travel, recent))

    def watch(self) -> None:
        """Take note of the commands."""
        for command, _, _, recent in self._surfaces:
            recent.append(command())

    def error(self) -> float:
        """Take note of the commands, and return the largest distance of a surface from the recent
        ones, over its travel [-].
        """
        worst = 0.0
        for command, position, travel, recent in self._surfaces:
            now, at = command(), position() / travel
            recent.append(now)
            oldest = recent[0]
            # Between the oldest and the newest of its commands a surface is at no distance from
            # them.
            if not (oldest <= at <= now or now <= at <= oldest):
                off = at - max(recent) if at > now else min(recent) - at
                worst = off if off > worst else worst
        return worst
