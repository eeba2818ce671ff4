"""The paper's reference point, which oscillates about the centre of oscillation."""

import math
from dataclasses import dataclass

from gnc.reference.oscillation import Oscillation, design_oscillation
from gnc.reference.reference import Orbit, Reference, ReferenceStart, reference_shape


def start_reference(
    oscillation: Orbit, *, phase: float, centre_north: float, centre_east: float, vessel_course: float
) -> ReferenceStart:
    """Return the start of a reference at phase phi_0 [rad] whose orbit is centred on a CO at ``centre_north``, ``centre_east`` [m].

    The course is eta cos(phi_0) from the vessel's, equation (7). Differs from equation (3), which says A/omega_0 and so holds for
    phi_0 = 0 only, and from starting on the CO: with another phase that orbit would not be centred on it.
    """
    along, right = (float(x) for x in oscillation.offset(phase / oscillation.omega_0))
    sin_v, cos_v = math.sin(vessel_course), math.cos(vessel_course)
    return ReferenceStart(
        north=centre_north + along * cos_v - right * sin_v,
        east=centre_east + along * sin_v + right * cos_v,
        course=vessel_course + oscillation.eta * math.cos(phase),
    )


class OscillatingReference:
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

    def __init__(self, oscillation: Orbit, start: ReferenceStart, *, phase: float, time_step: float) -> None:
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


@reference_shape("sinusoid")
@dataclass(frozen=True, slots=True)
class Sinusoid:
    """The paper's reference: its course oscillates about the vessel's as a sinusoid."""

    def design(
        self, *, nu: float, speed: float, heading_rate_max: float, reserve: float, vessel_heading_rate: float, roll_rate_max: float
    ) -> Oscillation:
        """Return the fastest oscillation that the vehicle can follow; parameters are those of ``ReferenceShape``."""
        return design_oscillation(
            nu=nu,
            speed=speed,
            heading_rate_max=heading_rate_max,
            reserve=reserve,
            vessel_heading_rate=vessel_heading_rate,
            roll_rate_max=roll_rate_max,
        )

    def reference(
        self, orbit: Orbit, *, phase: float, centre_north: float, centre_east: float, vessel_course: float, time_step: float
    ) -> Reference:
        """Return a reference on an orbit of this shape; parameters are those of ``ReferenceShape``."""
        start = start_reference(orbit, phase=phase, centre_north=centre_north, centre_east=centre_east, vessel_course=vessel_course)
        return OscillatingReference(orbit, start, phase=phase, time_step=time_step)
