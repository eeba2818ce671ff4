"""A reference that a vehicle joins where it is nearest: of an orbit's phases, the one that costs
the least to reach.
"""

import math
from dataclasses import dataclass

from gnc.reference.oscillating import OscillatingReference, start_reference
from gnc.reference.reference import Orbit, OscillatingPoint, ReferenceShape

_PHASES = 72
"""Phases that are compared: 5 degrees apart."""

_COURSE_COST = 1.5
"""What a difference of course costs, in turn radii per radian [-]: the vehicle needs about its
turn, and half of it back.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedOrbit:
    """An orbit beside a steady vessel.

    Attributes
    ----------
    shape, orbit : of the reference
    vessel_course : [rad]
    time_step : [s]
    """

    shape: ReferenceShape
    orbit: Orbit
    vessel_course: float
    time_step: float

    def reference(
        self, phase: float, centre_north: float, centre_east: float, *, share: float = 1.0
    ) -> OscillatingPoint:
        """Return the reference at a phase [rad] of the orbit about a centre [m], and the part of
        its heading rate that it takes.
        """
        start = start_reference(
            self.orbit,
            phase=phase,
            centre_north=centre_north,
            centre_east=centre_east,
            vessel_course=self.vessel_course,
            share=share,
        )
        return OscillatingReference(
            self.orbit, start, phase=phase, time_step=self.time_step, share=share
        )

    def nearest(
        self,
        centre_north: float,
        centre_east: float,
        *,
        north: float,
        east: float,
        course: float,
        turn_radius: float,
    ) -> OscillatingPoint:
        """Return the reference of the orbit about a centre [m] that a vehicle reaches with the
        least effort, slowed down for it.

        Parameters
        ----------
        centre_north, centre_east : of oscillation now [m]
        north, east, course : of the vehicle now [m, m, rad]
        turn_radius : of the vehicle [m]
        """

        def cost(reference: OscillatingPoint) -> float:
            turn = math.remainder(reference.course - course, 2.0 * math.pi)
            return math.hypot(
                reference.north - north, reference.east - east, _COURSE_COST * turn_radius * turn
            )

        phases = (2.0 * math.pi * i / _PHASES for i in range(_PHASES))
        share = self.shape.joining_share
        return min(
            (self.reference(phase, centre_north, centre_east, share=share) for phase in phases),
            key=cost,
        )
