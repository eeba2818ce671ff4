"""The reference on the orbit beside a steady vessel, and how a vehicle joins that orbit."""

import copy
import math
from dataclasses import dataclass

from gnc.reference.reference import Orbit, OscillatingPoint, ReferenceShape

_PHASES = 72
"""Phases at which an orbit may be joined: 5 degrees apart."""

_COURSE_COST = 1.5
"""Cost of a course difference when an orbit is joined, in turn radii per radian [-].

To join across its course, the vehicle needs about its turn, and half of it back.
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
"""What changes of an oscillating reference as it moves."""


class OscillatingReference:
    """A reference on an orbit about a vessel that moves steadily: equations (2), (3) and (4).

    Its course is in closed form; its position is integrated by Simpson's rule, good to 1e-9 m a
    step at 20 Hz, and to 1e-5 m where the roll rate of a shape jumps. Time comes from the step
    count.

    It starts where its orbit is centred on the centre of oscillation, on the course of phi_0: that
    of the paper's orbit is eta cos(phi_0) from the vessel's, equation (7). Differs from equation
    (3), which says A/omega_0 and so holds for phi_0 = 0 only, and from starting on the centre: at
    another phase that orbit would not be centred on it. With a smaller turn rate the orbit is
    larger by as much, and meets the whole one at phase 0.

    Parameters
    ----------
    orbit : that it flies
    phase : phi_0 [rad]
    centre_north, centre_east : of oscillation at time 0 [m]
    vessel_course : at time 0 [rad]
    time_step : [s]
    turn_rate_fraction : fraction of its heading rate that it turns with at first [-]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``Reference``
    turn_rate_fraction : now [-]
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
        """Return a copy, which a law may move ahead. Python cannot copy a compiled object."""
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
        """Return a copy: its orbit never changes."""
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
        """Set the fraction of its heading rate that it turns with from phase 0 on [-]."""
        self._fraction_demand = fraction

    def _change_fraction(self, angle: float) -> float:
        """Return the phase after a step [rad]; past phase 0 it goes on at the demanded rate."""
        passage = 2.0 * math.pi * math.floor(angle / (2.0 * math.pi))
        if angle - self._omega_0 * self._time_step >= passage:
            return angle
        self._phase = passage + (angle - passage) * self._fraction_demand / self.turn_rate_fraction
        self.turn_rate_fraction = self._fraction_demand
        self._steps = 0
        self._omega_0 = self.turn_rate_fraction * self._orbit.omega_0
        return self._phase


class ClosingReference:
    """A reference that is moved outwards along the plume's axis, and closes in once it is tracked.

    Parameters
    ----------
    reference : the reference in its place
    axis : course along which the plume trails [rad]
    standoff : how far it is moved outwards at first [m]
    rate : at which it closes in [m/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``Reference``
    standoff : how far it is moved outwards now [m]
    closing : whether it closes in
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
        """Return a copy, which a law may move ahead. Python cannot copy a compiled object."""
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
    """An orbit beside a steady vessel, to be joined at any phase.

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
        self,
        phase: float,
        centre_north: float,
        centre_east: float,
        *,
        turn_rate_fraction: float = 1.0,
    ) -> OscillatingReference:
        """Return the reference at a phase [rad] of the orbit about a centre [m]."""
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
        """Return the reference that a vehicle reaches with the least effort, slowed down for it.

        Parameters
        ----------
        centre_north, centre_east : of oscillation now [m]
        north, east, course : of the vehicle now [m, m, rad]
        turn_radius : of the vehicle [m]
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
