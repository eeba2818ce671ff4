"""A reference whose orbit stands off from its place, and closes in once it is tracked."""

import math

from gnc.reference.reference import OscillatingPoint


class ClosingReference:
    """A reference that is moved outwards along the plume's axis; attributes as of
    ``gnc.reference.reference.Reference``.

    Parameters
    ----------
    reference : the reference in its place
    axis : course along which the plume trails [rad]
    standoff : by which it is moved outwards at first [m]
    rate : at which it closes in [m/s]
    time_step : [s]

    Attributes
    ----------
    standoff : by which it is moved outwards now [m]
    closing : whether it closes in
    """

    __slots__ = (
        "_cos",
        "_sin",
        "_step",
        "closing",
        "course",
        "east",
        "heading_rate",
        "north",
        "reference",
        "speed",
        "standoff",
    )

    def __init__(
        self,
        reference: OscillatingPoint,
        *,
        axis: float,
        standoff: float,
        rate: float,
        time_step: float,
    ) -> None:
        self.reference, self.standoff, self.closing = reference, standoff, False
        self._cos, self._sin, self._step = math.cos(axis), math.sin(axis), rate * time_step
        self.speed = reference.speed
        self._place()

    def step(self) -> None:
        """Advance one time step."""
        self.reference.step()
        if self.closing:
            self.standoff = max(0.0, self.standoff - self._step)
        self._place()

    def _place(self) -> None:
        reference = self.reference
        self.north = reference.north + self.standoff * self._cos
        self.east = reference.east + self.standoff * self._sin
        self.course, self.heading_rate = reference.course, reference.heading_rate
