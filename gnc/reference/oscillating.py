"""The reference point, which oscillates about the centre of oscillation."""

import math

from gnc.reference.reference import Orbit, ReferenceStart, with_state_of


def start_reference(
    oscillation: Orbit,
    *,
    phase: float,
    centre_north: float,
    centre_east: float,
    vessel_course: float,
    share: float = 1.0,
) -> ReferenceStart:
    """Return the start of a reference at phase phi_0 [rad] whose orbit is centred on a CO at
    ``centre_north``, ``centre_east`` [m].

    The course is that of phi_0 from the vessel's: of the paper's orbit eta cos(phi_0), equation
    (7). Differs from equation (3), which says A/omega_0 and so holds for phi_0 = 0 only, and from
    starting on the CO: with another phase that orbit would not be centred on it. An orbit on which
    ``share`` of the heading rate is taken is as much larger, and meets the whole one at phase 0.
    """
    there, passage = oscillation.offset(phase / oscillation.omega_0), oscillation.offset(0.0)
    along, right = (
        float(at) + (float(x) - float(at)) / share for x, at in zip(there, passage, strict=True)
    )
    sin_v, cos_v = math.sin(vessel_course), math.cos(vessel_course)
    return ReferenceStart(
        north=centre_north + along * cos_v - right * sin_v,
        east=centre_east + along * sin_v + right * cos_v,
        course=vessel_course + oscillation.course(phase),
    )


_STATE = (
    "_base", "_cos_course", "_distance", "_frequency", "_omega_0", "_oscillation", "_phase", "_share_demand", "_sin_course",
    "_steps", "_swing", "_time_step", "_turn", "course", "east", "heading_rate", "north", "share", "speed",
)  # fmt: skip
"""Attributes of a reference."""


class OscillatingReference:
    """The reference point, moved in equal time steps: equations (2), (3) and (4).

    Its course is known in closed form; its position is integrated by Simpson's rule, good to 1e-9 m
    a step at 20 Hz, and to 1e-5 m where the roll rate of a shape jumps. Time comes from the step
    count.

    Parameters
    ----------
    oscillation : its course oscillation
    start : position and course at time 0
    phase : phi_0 [rad]
    time_step : [s]
    share : part of its heading rate that it takes at first [-]

    Attributes
    ----------
    north, east : position [m]
    course : chi_r [rad]
    heading_rate : omega_r [rad/s]
    speed : V_r [m/s]
    share : part of its heading rate that it takes now [-]
    """

    __slots__ = _STATE

    def __init__(
        self,
        oscillation: Orbit,
        start: ReferenceStart,
        *,
        phase: float,
        time_step: float,
        share: float = 1.0,
    ) -> None:
        self._oscillation, self._swing, self._turn = (
            oscillation,
            oscillation.course,
            oscillation.heading_rate,
        )
        self._frequency = oscillation.omega_0
        self._omega_0 = share * self._frequency
        self.share = self._share_demand = share
        self._phase = phase
        self._time_step = time_step
        self.speed = oscillation.speed
        self._distance = oscillation.speed * time_step / 6.0
        self._base = start.course - oscillation.course(phase)
        self._steps = 0
        self.north = start.north
        self.east = start.east
        self.course = start.course
        self._cos_course, self._sin_course = math.cos(start.course), math.sin(start.course)
        self.heading_rate = share * oscillation.heading_rate(phase)

    def __copy__(self) -> "OscillatingReference":
        """Return a copy, which a law may move ahead. Python cannot make one of what is compiled."""
        start = ReferenceStart(north=self.north, east=self.east, course=self.course)
        other = OscillatingReference(
            self._oscillation, start, phase=self._phase, time_step=self._time_step
        )
        return with_state_of(self, other, _STATE)

    def __deepcopy__(self, _memo: object) -> "OscillatingReference":
        """Return a copy: its oscillation never changes."""
        return self.__copy__()

    def step(self, vessel_heading_rate: float = 0.0) -> None:
        """Advance one time step while the vessel turns at ``vessel_heading_rate`` omega_V [rad/s]."""
        steps, time_step, omega_0, distance = (
            self._steps,
            self._time_step,
            self._omega_0,
            self._distance,
        )
        turn = vessel_heading_rate * time_step
        angle = omega_0 * (steps + 0.5) * time_step + self._phase
        middle = self._base + 0.5 * turn + self._swing(angle)
        self._steps = steps = steps + 1
        self._base = base = self._base + turn
        angle = omega_0 * steps * time_step + self._phase
        if self.share != self._share_demand:
            angle = self._changed(angle)
        self.course = last = base + self._swing(angle)
        cos_first, sin_first = self._cos_course, self._sin_course
        self._cos_course, self._sin_course = cos_last, sin_last = math.cos(last), math.sin(last)
        self.north += distance * (cos_first + 4.0 * math.cos(middle) + cos_last)
        self.east += distance * (sin_first + 4.0 * math.sin(middle) + sin_last)
        self.heading_rate = vessel_heading_rate + self.share * self._turn(angle)

    def spend(self, share: float) -> None:
        """Set the part of its heading rate that it takes from its next passage of phase 0 on [-]."""
        self._share_demand = share

    def _changed(self, angle: float) -> float:
        """Return the phase at the end of a step, and go on from there as fast as is demanded, once
        phase 0 has been passed.
        """
        passage = 2.0 * math.pi * math.floor(angle / (2.0 * math.pi))
        if angle - self._omega_0 * self._time_step >= passage:
            return angle
        self._phase = passage + (angle - passage) * self._share_demand / self.share
        self.share, self._steps = self._share_demand, 0
        self._omega_0 = self.share * self._frequency
        return self._phase
