"""A reference on a circle, that of the paper's Simulation 1."""

import math

from gnc.reference.reference import ReferenceStart


class CirclingReference:
    """A reference that turns steadily, that of the paper's Simulation 1: equation (13) with a
    constant omega_r.

    Its motion is known in closed form; time comes from the step count.

    Parameters
    ----------
    start : position and course at time 0
    speed : V_r [m/s]
    heading_rate : omega_r [rad/s], positive to the right, not 0
    time_step : [s]

    Attributes
    ----------
    north, east : position [m]
    course : chi_r [rad]
    heading_rate, speed : omega_r [rad/s] and V_r [m/s]
    """

    __slots__ = (
        "_centre_east",
        "_centre_north",
        "_course",
        "_radius",
        "_steps",
        "_turn",
        "course",
        "east",
        "heading_rate",
        "north",
        "speed",
    )

    def __init__(
        self, start: ReferenceStart, *, speed: float, heading_rate: float, time_step: float
    ) -> None:
        self.speed, self.heading_rate = speed, heading_rate
        self.north, self.east, self.course = start.north, start.east, start.course
        self._course = start.course
        self._turn = heading_rate * time_step
        self._radius = speed / heading_rate
        self._centre_north = start.north - self._radius * math.sin(start.course)
        self._centre_east = start.east + self._radius * math.cos(start.course)
        self._steps = 0

    def step(self) -> None:
        """Advance one time step."""
        self._steps += 1
        self.course = self._course + self._steps * self._turn
        self.north = self._centre_north + self._radius * math.sin(self.course)
        self.east = self._centre_east - self._radius * math.cos(self.course)
