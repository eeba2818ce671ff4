"""The reference on an orbit beside a steady vessel, and its start when a vehicle joins it."""

import copy
import math
from dataclasses import dataclass

from gnc.reference.reference import Orbit, OscillatingPoint, ReferenceShape

_PHASES = 72
"""Number of phases at which an orbit may be joined, 5 degrees apart."""

_COURSE_COST = 1.5
"""Cost of a course difference when an orbit is joined, in turn radii per radian [-].

The vehicle has to turn by the difference, and by about half of it back.
"""


_STATE = (
    "north",
    "east",
    "course",
    "heading_rate",
    "turn_rate_fraction",
    "_base",
    "_fraction_demand",
    "_omega_0",
    "_phase",
    "_steps",
)
"""Attributes that change as an oscillating reference moves."""


class OscillatingReference:
    """A reference on an orbit about a vessel that moves steadily: equations (2), (3) and (4).

    The course is computed in closed form. The position is integrated by Simpson's rule, with an
    error of 1e-9 m per step at 20 Hz, or 1e-5 m where the roll rate of a shape jumps. Time comes
    from the step count.

    The start is the point of phase phi_0 on an orbit centred on the centre of oscillation; the
    course there is eta cos(phi_0) from the vessel's in the paper's orbit, equation (7). Differs
    from equation (3), whose A/omega_0 holds for phi_0 = 0 only, and from a start on the centre,
    because an orbit that starts there at another phase is not centred on it. With a smaller turn
    rate the orbit is larger in proportion, and meets the original orbit at phase 0.

    Parameters
    ----------
    orbit : orbit of the reference
    phase : phi_0 [rad]
    centre_north, centre_east : centre of oscillation at time 0 [m]
    vessel_course : course at time 0 [rad]
    time_step : [s]
    turn_rate_fraction : initial fraction of the orbit's heading rate [-]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``Reference``
    turn_rate_fraction : present fraction of the orbit's heading rate [-]
    """

    def __init__(
        self,
        orbit: Orbit,
        *,
        phase: float,
        centre_north: float,
        centre_east: float,
        vessel_course: float,
        time_step: float,
        turn_rate_fraction: float = 1.0,
    ) -> None:
        self._orbit = orbit
        self._phase = phase
        self._time_step = time_step
        self.turn_rate_fraction = turn_rate_fraction
        self._fraction_demand = turn_rate_fraction
        self._omega_0 = turn_rate_fraction * orbit.omega_0
        self.speed = orbit.speed
        self._steps = 0
        there = orbit.offset(phase / orbit.omega_0)
        passage = orbit.offset(0.0)
        along, right = (
            float(at) + (float(x) - float(at)) / turn_rate_fraction
            for x, at in zip(there, passage, strict=True)
        )
        sin_v = math.sin(vessel_course)
        cos_v = math.cos(vessel_course)
        self.north = centre_north + along * cos_v - right * sin_v
        self.east = centre_east + along * sin_v + right * cos_v
        self.course = vessel_course + orbit.course(phase)
        self._base = self.course - orbit.course(phase)
        self.heading_rate = turn_rate_fraction * orbit.heading_rate(phase)

    def __copy__(self) -> "OscillatingReference":
        """Return a copy, which a law may move ahead; Python cannot copy a compiled object."""
        other = OscillatingReference(
            self._orbit,
            phase=self._phase,
            centre_north=0.0,
            centre_east=0.0,
            vessel_course=0.0,
            time_step=self._time_step,
        )
        for name in _STATE:
            setattr(other, name, getattr(self, name))
        return other

    def __deepcopy__(self, _memo: object) -> "OscillatingReference":
        """Return a copy that shares the orbit, which never changes."""
        return self.__copy__()

    def step(self, vessel_heading_rate: float = 0.0) -> None:
        """Advance one time step while the vessel turns at ``vessel_heading_rate`` [rad/s]."""
        time_step = self._time_step
        orbit_course = self._orbit.course
        turn = vessel_heading_rate * time_step
        first = self.course
        angle = self._omega_0 * (self._steps + 0.5) * time_step + self._phase
        middle = self._base + 0.5 * turn + orbit_course(angle)
        self._steps += 1
        self._base += turn
        angle = self._omega_0 * self._steps * time_step + self._phase
        if self.turn_rate_fraction != self._fraction_demand:
            angle = self._change_fraction(angle)
        last = self._base + orbit_course(angle)
        self.course = last
        # Simpson's rule over the step.
        sixth = self.speed * time_step / 6.0
        self.north += sixth * (math.cos(first) + 4.0 * math.cos(middle) + math.cos(last))
        self.east += sixth * (math.sin(first) + 4.0 * math.sin(middle) + math.sin(last))
        self.heading_rate = vessel_heading_rate + self.turn_rate_fraction * (
            self._orbit.heading_rate(angle)
        )

    def set_turn_rate_fraction(self, fraction: float) -> None:
        """Set the fraction of the orbit's heading rate from the next phase 0 on [-]."""
        self._fraction_demand = fraction

    def _change_fraction(self, angle: float) -> float:
        """Return the phase after a step [rad]; past phase 0 the demanded fraction applies."""
        passage = 2.0 * math.pi * math.floor(angle / (2.0 * math.pi))
        if angle - self._omega_0 * self._time_step >= passage:
            return angle
        self._phase = passage + (angle - passage) * self._fraction_demand / self.turn_rate_fraction
        self.turn_rate_fraction = self._fraction_demand
        self._steps = 0
        self._omega_0 = self.turn_rate_fraction * self._orbit.omega_0
        return self._phase


class ClosingReference:
    """A reference displaced outwards along the plume's axis, which closes in once it is tracked.

    Parameters
    ----------
    reference : the reference without displacement
    axis : direction in which the plume trails [rad]
    standoff : initial displacement [m]
    rate : rate of closing in [m/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``Reference``
    standoff : present displacement [m]
    closing : whether the displacement decreases
    """

    def __init__(
        self,
        reference: OscillatingPoint,
        *,
        axis: float,
        standoff: float,
        rate: float,
        time_step: float,
    ) -> None:
        self.reference = reference
        self.standoff = standoff
        self.closing = False
        self.speed = reference.speed
        self._cos = math.cos(axis)
        self._sin = math.sin(axis)
        self._step = rate * time_step
        self._place()

    def step(self) -> None:
        """Advance one time step."""
        self.reference.step()
        if self.closing:
            self.standoff = max(0.0, self.standoff - self._step)
        self._place()

    def __copy__(self) -> "ClosingReference":
        """Return a copy, which a law may move ahead; Python cannot copy a compiled object."""
        other = ClosingReference(
            copy.copy(self.reference), axis=0.0, standoff=self.standoff, rate=0.0, time_step=1.0
        )
        other.closing = self.closing
        other._cos = self._cos
        other._sin = self._sin
        other._step = self._step
        other._place()
        return other

    def __deepcopy__(self, _memo: object) -> "ClosingReference":
        """Return a copy."""
        return self.__copy__()

    def _place(self) -> None:
        reference = self.reference
        self.north = reference.north + self.standoff * self._cos
        self.east = reference.east + self.standoff * self._sin
        self.course = reference.course
        self.heading_rate = reference.heading_rate


@dataclass(frozen=True, slots=True, kw_only=True)
class JoinedOrbit:
    """An orbit beside a steady vessel that can be joined at any phase.

    Attributes
    ----------
    shape, orbit : shape and orbit of the reference
    vessel_course : [rad]
    time_step : [s]
    """

    shape: ReferenceShape
    orbit: Orbit
    vessel_course: float
    time_step: float

    def reference(
        self,
        phase: float,
        centre_north: float,
        centre_east: float,
        *,
        turn_rate_fraction: float = 1.0,
    ) -> OscillatingReference:
        """Return a reference that starts at a phase [rad] of the orbit about a centre [m]."""
        return OscillatingReference(
            self.orbit,
            phase=phase,
            centre_north=centre_north,
            centre_east=centre_east,
            vessel_course=self.vessel_course,
            time_step=self.time_step,
            turn_rate_fraction=turn_rate_fraction,
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
    ) -> OscillatingReference:
        """Return the reference that a vehicle reaches with the least effort; it turns more slowly.

        Parameters
        ----------
        centre_north, centre_east : present centre of oscillation [m]
        north, east, course : present position and course of the vehicle [m, m, rad]
        turn_radius : turn radius of the vehicle [m]
        """

        def cost(reference: OscillatingReference) -> float:
            turn = math.remainder(reference.course - course, 2.0 * math.pi)
            return math.hypot(
                reference.north - north, reference.east - east, _COURSE_COST * turn_radius * turn
            )

        fraction = self.shape.turn_rate_fraction_until_tracked
        references = (
            self.reference(
                2.0 * math.pi * i / _PHASES, centre_north, centre_east, turn_rate_fraction=fraction
            )
            for i in range(_PHASES)
        )
        return min(references, key=cost)
