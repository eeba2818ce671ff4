"""The outer loop: from the vehicle's motion to commanded heading rate and airspeed."""

import copy
import math
from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

from gnc.laws.steering_law import SteeringLaw
from gnc.numeric import limited
from gnc.reference.reference import Reference
from gnc.safety.keepout_guard import KeepoutGuard


@dataclass(frozen=True, slots=True, kw_only=True)
class GuidanceParameters:
    """Parameters of the outer loop.

    Attributes
    ----------
    law : steering law
    heading_rate_max : omega_max; no command exceeds it; infinite for a vehicle that can fly anything [rad/s]
    time_step : [s]
    lag : of the vehicle's heading rate behind its command [s]; above 0 the law runs that much ahead of time
    airspeed_gain : commanded airspeed per along-track error [1/s]; 0 switches trimming off
    airspeed_trim_max : largest change of commanded airspeed [m/s]
    """

    law: SteeringLaw
    heading_rate_max: float
    time_step: float
    lag: float
    airspeed_gain: float
    airspeed_trim_max: float


class PlacedReference:
    """Where a reference is, put there from outside.

    Attributes
    ----------
    north, east, course, heading_rate, speed : as of ``gnc.reference.reference.Reference``
    """

    __slots__ = ("course", "east", "heading_rate", "north", "speed")

    def __init__(self, reference: Reference) -> None:
        self.north, self.east = reference.north, reference.east
        self.course, self.heading_rate, self.speed = reference.course, reference.heading_rate, reference.speed


AnyReference = TypeVar("AnyReference", bound=Reference)


class Guidance(Generic[AnyReference]):
    """The outer loop of one flight, stepped at a fixed rate.

    Preview: a vehicle that answers ``lag`` seconds late is steered by the law as it will stand then. The reference is known in
    advance; the vehicle's motion until then follows from its heading rate, which goes from the measured value to the last command.

    Parameters
    ----------
    parameters : of the loop
    reference : at time 0; it is copied
    guard : of the keep-out area, or none; it is copied

    Attributes
    ----------
    reference : the reference point now
    guard : the copy
    ahead : the reference point as far ahead of time as the preview looks; where it is steered, the reference follows
    heading_rate_wanted : what the law asked for last, before omega_max and guard had their say [rad/s]
    heading_rate_command : last command [rad/s]
    airspeed_command : last command [m/s]
    saturated : whether the last heading-rate command was cut at omega_max
    """

    __slots__ = (
        "_lag",
        "_law",
        "_parameters",
        "_speed",
        "_until_ahead",
        "ahead",
        "airspeed_command",
        "guard",
        "heading_rate_command",
        "heading_rate_wanted",
        "reference",
        "saturated",
    )

    def __init__(self, parameters: GuidanceParameters, reference: AnyReference, *, guard: KeepoutGuard | None = None) -> None:
        self._parameters = parameters
        self._law = parameters.law.heading_rate
        self._speed = reference.speed
        self.reference = PlacedReference(reference)
        self.ahead = copy.copy(reference)
        # The reference moves once, ahead of time; until then its places wait in line.
        self._until_ahead: deque[tuple[float, float, float, float]] = deque()
        lead = round(parameters.lag / parameters.time_step)
        for _ in range(lead):
            self._move_ahead()
        self._lag = lead * parameters.time_step
        self.guard = copy.deepcopy(guard)
        self.heading_rate_wanted = self.heading_rate_command = 0.0
        self.airspeed_command = reference.speed
        self.saturated = False

    def step(
        self,
        north: float,
        east: float,
        course: float,
        speed: float,
        heading_rate: float,
        disc: tuple[float, float, float, float] | None = None,
    ) -> None:
        """Compute the commands from the vehicle's motion now, then move the reference on by one time step.

        Parameters
        ----------
        north, east : position [m]
        course : chi [rad]
        speed : horizontal speed [m/s]
        heading_rate : measured rate of the course [rad/s]
        disc : north and east of the keep-out area's centre [m], and its velocity [m/s]; a guard has to be told

        Raises
        ------
        ValueError : there is a guard, and no disc is given
        """
        p = self._parameters
        reference, ahead = self.reference, self.ahead
        if p.airspeed_gain > 0.0:
            along = (reference.north - north) * math.cos(reference.course) + (reference.east - east) * math.sin(reference.course)
            self.airspeed_command = self._speed + limited(p.airspeed_gain * along, p.airspeed_trim_max)
        then_north, then_east, then_course, lag = north, east, course, self._lag
        if lag > 0.0:
            # Heading rate linear in time from the measured value to the last command; its integrals over the lag.
            last = self.heading_rate_command
            middle = course + lag * (heading_rate / 3.0 + last / 6.0)
            then_north += speed * lag * math.cos(middle)
            then_east += speed * lag * math.sin(middle)
            then_course += 0.5 * lag * (heading_rate + last)
        wanted = self._law(ahead, ahead.north - then_north, ahead.east - then_east, then_course, speed)
        command = limited(wanted, p.heading_rate_max)
        self.saturated = command != wanted
        if self.guard is not None:
            if disc is None:
                raise ValueError("the guidance has a keep-out guard and was not told where the disc is; give it to step()")
            # The guard has the lag inside: it is asked about the motion now. A turn away is flown at V_r: what the trim has taken
            # from the airspeed comes back in it.
            disc_north, disc_east, velocity_north, velocity_east = disc
            x, y, fastest = north - disc_north, east - disc_east, speed if speed > self._speed else self._speed
            command = self.guard.limit(command, x, y, velocity_north, velocity_east, course, fastest, heading_rate)
            if self.guard.intervening:
                self.airspeed_command = self._speed
        self.heading_rate_wanted = wanted
        self.heading_rate_command = command
        self._move_ahead()
        reference.north, reference.east, reference.course, reference.heading_rate = self._until_ahead.popleft()

    def _move_ahead(self) -> None:
        ahead = self.ahead
        ahead.step()
        self._until_ahead.append((ahead.north, ahead.east, ahead.course, ahead.heading_rate))
