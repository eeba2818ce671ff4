"""The point that is tracked: what it is, how it moves, and which orbits it can have."""

import copy
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from common.registry import Registry

Array = npt.NDArray[np.float64]

_PHASES = 72
"""Phases at which an orbit may be joined: 5 degrees apart."""

_COURSE_COST = 1.5
"""Cost of a course difference when an orbit is joined, in turn radii per radian [-].

To join across its course, the vehicle needs about its turn, and half of it back.
"""


class Reference(Protocol):
    """A point of constant speed to be tracked, moved in equal time steps: equation (13).

    Attributes
    ----------
    north, east : position [m]
    course : chi_r [rad]
    heading_rate : omega_r [rad/s]
    speed : V_r [m/s]
    """

    north: float
    east: float
    course: float
    heading_rate: float
    speed: float

    def step(self) -> None:
        """Advance one time step."""


class OscillatingPoint(Reference, Protocol):
    """A reference on an orbit, which can be slowed down while a vehicle is on its way to it.

    Attributes
    ----------
    turn_rate_fraction : fraction of its heading rate that it turns with now [-]
    """

    turn_rate_fraction: float

    def set_turn_rate_fraction(self, fraction: float) -> None:
        """Set the fraction of its heading rate that it turns with from a passage of phase 0 on [-].

        There it turns least, and the slower orbit, which is larger, meets the other one.
        """


class PeriodicPath(Protocol):
    """A periodic motion about a centre that moves at nu V_r on a straight course."""

    @property
    def nu(self) -> float:
        """Speed ratio, mean speed over speed [-]."""

    @property
    def speed(self) -> float:
        """V_r [m/s]."""

    @property
    def eta(self) -> float:
        """Largest course offset from that of the centre [rad]."""

    @property
    def omega_0(self) -> float:
        """Angular frequency, 2 pi over the period [rad/s]."""

    @property
    def limit(self) -> str:
        """What set the frequency, such as ``heading rate`` or ``roll rate``."""

    @property
    def amplitude(self) -> float:
        """Largest heading rate [rad/s]."""

    @property
    def period(self) -> float:
        """Time of one oscillation [s]."""

    @property
    def crossing_interval(self) -> float:
        """Time between passages through the centre of oscillation [s]."""

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the reference's offset from the centre, along its course and to its right [m].

        ``time`` [s] counts from phase 0, the passage through the centre at the largest course
        offset to the right. Both have its shape.
        """

    def half_widths(self) -> tuple[float, float]:
        """Return how far the orbit reaches from the centre, along its course and across [m]."""


class Orbit(PeriodicPath, Protocol):
    """A reference's periodic motion about the centre of oscillation."""

    @property
    def symmetric(self) -> bool:
        """Whether the second half of the orbit mirrors the first across the centre's course."""

    def course(self, phase: float) -> float:
        """Return the course offset from that of the centre at a phase, omega_0 times time [rad]."""

    def heading_rate(self, phase: float) -> float:
        """Return the heading rate at a phase [rad/s]."""

    def sidebands(self, orders: npt.NDArray[np.int64]) -> Array:
        """Return |c_n|^2 of the Fourier series of exp(i course) at each order n, same shape [-]."""


class Swing(Protocol):
    """The courses of a shape at every amplitude eta, through which a steered reference moves.

    A course is eta at phase 0, -eta half a period later, and everywhere the negative of itself half
    a period later.
    """

    def eta(self, speed_ratio: float) -> float:
        """Return the amplitude for a mean speed over speed between -0.2 and 1 [rad]."""

    def frequency(self, eta: float, heading_rate: float) -> float:
        """Return the largest omega_0 within a heading rate [rad/s] and the roll rate [rad/s].

        Below ``gnc.reference.shapes.ETA_FREQUENCY`` it no longer rises.
        """

    def course(self, eta: float, phase: float) -> float:
        """Return the course offset from the mean course [rad]."""

    def slopes(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the slopes of the course offset: over eta, and over the phase per eta [-]."""

    def offset(self, eta: float, phase: float) -> tuple[float, float]:
        """Return the offset from the orbit's centre, along its course and right [V_r/omega_0]."""


class ReferenceShape(Protocol):
    """A kind of orbit: a frozen dataclass, registered by a name."""

    @property
    def turn_rate_fraction_until_tracked(self) -> float:
        """Fraction of its heading rate that a reference turns with until it is tracked [-].

        A vehicle whose commands are cut at omega_max cannot catch up with a reference that takes
        all of it.
        """

    def design(
        self,
        *,
        nu: float,
        speed: float,
        heading_rate_max: float,
        reserve: float,
        vessel_heading_rate: float,
        roll_rate_max: float,
    ) -> Orbit:
        """Return the fastest orbit that the vehicle can follow.

        Parameters
        ----------
        nu : speed ratio [-]
        speed : V_r [m/s]
        heading_rate_max : omega_max [rad/s]
        reserve : fraction of omega_max that the reference leaves to feedback [-]
        vessel_heading_rate : omega_V [rad/s]
        roll_rate_max : of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : there is none
        """

    def swing(self, *, speed: float, heading_rate: float, roll_rate_max: float) -> Swing:
        """Return the courses of this shape for a steered reference.

        Parameters
        ----------
        speed : V_r [m/s]
        heading_rate : largest of the reference [rad/s]
        roll_rate_max : of the vehicle [rad/s]

        Raises
        ------
        InfeasibleError : a reference of this shape cannot be steered
        """


REFERENCE_SHAPES: Registry[Callable[..., ReferenceShape]] = Registry(
    "reference_shape", folder="gnc.reference", methods=("design", "swing")
)
"""Reference shapes by name; calling one with its parameters makes it."""

reference_shape = REFERENCE_SHAPES.register
"""Decorator that registers a reference shape by a name."""


class CirclingReference:
    """A reference that turns steadily, that of the paper's Simulation 1: (13) at constant omega_r.

    It starts at the origin on course 0. Its motion is in closed form; time comes from the step
    count.

    Parameters
    ----------
    speed : V_r [m/s]
    heading_rate : omega_r, positive to the right, not 0 [rad/s]
    time_step : [s]

    Attributes
    ----------
    north, east, course, heading_rate, speed : same as ``Reference``
    """

    def __init__(self, *, speed: float, heading_rate: float, time_step: float) -> None:
        self.speed = speed
        self.heading_rate = heading_rate
        self.north = 0.0
        self.east = 0.0
        self.course = 0.0
        self._turn = heading_rate * time_step
        self._radius = speed / heading_rate
        self._steps = 0

    def step(self) -> None:
        """Advance one time step."""
        self._steps += 1
        self.course = self._steps * self._turn
        self.north = self._radius * math.sin(self.course)
        self.east = self._radius - self._radius * math.cos(self.course)


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

    def __deepcopy__(self, _memo: object) -> "OscillatingReference":
        """Return a copy, which a law may move ahead: the orbit is shared, for it never changes."""
        return copy.copy(self)

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
