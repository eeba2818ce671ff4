"""Whether the control surfaces go where they are told, from what their servos report.

A servo on the way trails its command by its lag and its limited speed, from stop to stop when a turn is reversed; a
stuck one stands still while its commands go elsewhere. What tells them apart without a model of the servo is time:
wherever a sound one is, it has been told to go there, or past there, a moment ago.
"""

from collections import deque

from aircraft.simulation.fdm import Fdm
from aircraft.spec import Feedback
from innerloop.jsbsim.properties import commanded_property

_MOMENT = 0.4
"""How long a surface may be on its way [s]: the X8's goes from stop to stop in 0.30 s and trails by its lag of 25
ms."""


class ServoWatch:
    """Watches every control surface of one aircraft in flight.

    The throttle is not watched: no surface moves with it. A control input without a servo model of its own is taken to
    be where it was told to be, once that has passed what may have failed.

    Parameters
    ----------
    fdm : of an aircraft with its autopilot
    time_step : between looks [s]
    """

    __slots__ = ("_surfaces",)

    def __init__(self, fdm: Fdm, time_step: float) -> None:
        self._surfaces = []
        for actuator in fdm.spec.actuators:
            if actuator.name == "throttle":
                continue
            feedback = actuator.feedback
            if feedback is None:
                control_input = fdm.spec.input(actuator.name)
                feedback = Feedback(told=commanded_property(control_input), position=control_input.commands[0], travel=1.0)
            told, position = (fdm.node(name).get_double_value for name in (feedback.told, feedback.position))
            lately: deque[float] = deque(maxlen=1 + round(_MOMENT / time_step))
            self._surfaces.append((told, position, feedback.travel, lately))

    def error(self) -> float:
        """Return how far the worst surface is from all that it was told lately, over its travel [-]; call once per
        time step."""
        worst = 0.0
        for told, position, travel, lately in self._surfaces:
            lately.append(told())
            place = position() / travel
            worst = max(worst, place - max(lately), min(lately) - place)
        return worst
