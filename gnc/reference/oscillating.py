"""The virtual reference point: oscillating about the centre of oscillation, or circling."""

import math
from dataclasses import dataclass
from typing import Protocol

from gnc.reference.orbit import offset
from gnc.reference.oscillation import Oscillation


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


@dataclass(frozen=True, slots=True, kw_only=True)
class ReferenceStart:
    """Where a reference starts.

    Attributes
    ----------
    north, east : [m]
    course : chi_r [rad]
    """

    north: float
    east: float
    course: float


def start_reference(
    oscillation: Oscillation, *, phase: float, centre_north: float, centre_east: float, vessel_course: float
) -> ReferenceStart:
    """Return the start of a reference at phase phi_0 [rad] whose orbit is centred on a CO at ``centre_north``, ``centre_east`` [m].

    The course is eta cos(phi_0) from the vessel's, equation (7). Differs from equation (3), which says A/omega_0 and so holds for
    phi_0 = 0 only, and from starting on the CO: with another phase that orbit would not be centred on it.
    """
    along, right = (float(x) for x in offset(oscillation, phase / oscillation.omega_0))
    sin_v, cos_v = math.sin(vessel_course), math.cos(vessel_course)
    return ReferenceStart(
        north=centre_north + along * cos_v - right * sin_v,
        east=centre_east + along * sin_v + right * cos_v,
        course=vessel_course + oscillation.eta * math.cos(phase),
    )


class ReferencePoint:
    """The reference point, moved in equal time steps: equations (2), (3) and (4).

    Its course is known in closed form; its position is integrated by Simpson's rule, good to 1e-9 m a step at 20 Hz. Time comes
    from the step count.

    Parameters
    ----------
    oscillation : its course oscillation
    start : position and course at time 0
    phase : phi_0 [rad]
    time_step : [s]

    Attributes
    ----------
    north, east : position [m]
    course : chi_r [rad]
    heading_rate : omega_r [rad/s]
    speed : V_r [m/s]
    """

    __slots__ = (
        "_amplitude",
        "_base",
        "_cos_course",
        "_distance",
        "_eta",
        "_omega_0",
        "_phase",
        "_sin_course",
        "_steps",
        "_time_step",
        "course",
        "east",
        "heading_rate",
        "north",
        "speed",
    )

    def __init__(self, oscillation: Oscillation, start: ReferenceStart, *, phase: float, time_step: float) -> None:
        self._eta = oscillation.eta
        self._omega_0 = oscillation.omega_0
        self._amplitude = oscillation.amplitude
        self._phase = phase
        self._time_step = time_step
        self.speed = oscillation.speed
        self._distance = oscillation.speed * time_step / 6.0
        self._base = start.course - oscillation.eta * math.cos(phase)
        self._steps = 0
        self.north = start.north
        self.east = start.east
        self.course = start.course
        self._cos_course, self._sin_course = math.cos(start.course), math.sin(start.course)
        self.heading_rate = -self._amplitude * math.sin(phase)

    def step(self, vessel_heading_rate: float = 0.0) -> None:
        """Advance one time step while the vessel turns at ``vessel_heading_rate`` omega_V [rad/s]."""
        cos, sin = math.cos, math.sin
        steps, time_step, omega_0, distance = self._steps, self._time_step, self._omega_0, self._distance
        turn = vessel_heading_rate * time_step
        angle = omega_0 * (steps + 0.5) * time_step + self._phase
        middle = self._base + 0.5 * turn + self._eta * cos(angle)
        self._steps = steps = steps + 1
        self._base = base = self._base + turn
        angle = omega_0 * steps * time_step + self._phase
        self.course = last = base + self._eta * cos(angle)
        cos_first, sin_first = self._cos_course, self._sin_course
        self._cos_course, self._sin_course = cos_last, sin_last = cos(last), sin(last)
        self.north += distance * (cos_first + 4.0 * cos(middle) + cos_last)
        self.east += distance * (sin_first + 4.0 * sin(middle) + sin_last)
        self.heading_rate = vessel_heading_rate - self._amplitude * sin(angle)


class CirclingReference:
    """A reference that turns steadily, that of the paper's Simulation 1: equation (13) with a constant omega_r.

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

    def __init__(self, start: ReferenceStart, *, speed: float, heading_rate: float, time_step: float) -> None:
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
