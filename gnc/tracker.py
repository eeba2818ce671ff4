"""Tracking a reference point: preview by the vehicle's lag, the steering law, omega_max."""

from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

from gnc.laws.steering_law import (
    STILL_AIR,
    SteeringLaw,
    Surroundings,
    begun,
    call_error,
    within_limit,
)
from gnc.reference.reference import Reference
from gnc.unicycle import lag_ahead


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackingParameters:
    """How a reference is tracked.

    Attributes
    ----------
    law : steering law
    heading_rate_max : omega_max; no command exceeds it; infinite for a vehicle that can fly
        anything [rad/s]
    time_step : [s]
    lag : of the vehicle's heading rate behind its command [s]; above 0 the law runs that much ahead
        of time
    """

    law: SteeringLaw
    heading_rate_max: float
    time_step: float
    lag: float


class PlacedReference:
    """Where a reference is, put there from outside.

    Attributes
    ----------
    north, east, course, heading_rate, speed : as of ``gnc.reference.reference.Reference``
    """

    __slots__ = ("course", "east", "heading_rate", "north", "speed")

    def __init__(self, reference: Reference) -> None:
        self.north, self.east = reference.north, reference.east
        self.course, self.heading_rate, self.speed = (
            reference.course,
            reference.heading_rate,
            reference.speed,
        )


AnyReference = TypeVar("AnyReference", bound=Reference)


class Tracker(Generic[AnyReference]):
    """Tracks one reference point, stepped at a fixed rate.

    Preview: a vehicle that answers ``lag`` seconds late is steered by the law as it will stand
    then. The reference is known in advance; the vehicle's motion until then follows from its
    heading rate, which goes from the measured value to the last command.

    Parameters
    ----------
    parameters : of the tracking
    reference : at time 0; from then on the tracker moves it
    surroundings : that the law may look at

    Attributes
    ----------
    reference : the reference point now
    ahead : the reference point as far ahead of time as the preview looks; where it is steered, the
        reference follows
    heading_rate_demand : what the law asked for last, before omega_max had its say [rad/s]
    heading_rate_command : what was commanded last; whoever changes it on its way to the vehicle
        sets it [rad/s]
    saturated : whether the last demand was cut at omega_max
    """

    __slots__ = (
        "_lag", "_law", "_limit", "_steer", "_until_ahead", "ahead", "heading_rate_command", "heading_rate_demand",
        "reference", "saturated",
    )  # fmt: skip

    def __init__(
        self,
        parameters: TrackingParameters,
        reference: AnyReference,
        surroundings: Surroundings = STILL_AIR,
    ) -> None:
        law = begun(parameters.law, surroundings, parameters.time_step)
        self._law = type(parameters.law).__qualname__
        self._steer, self._limit = law.heading_rate, parameters.heading_rate_max
        self.reference = PlacedReference(reference)
        self.ahead = reference
        # The reference moves once, ahead of time; until then its places wait in line.
        self._until_ahead: deque[tuple[float, float, float, float]] = deque()
        lead = round(parameters.lag / parameters.time_step)
        for _ in range(lead):
            self._move_ahead()
        self._lag = lead * parameters.time_step
        self.heading_rate_demand = self.heading_rate_command = 0.0
        self.saturated = False

    def step(
        self, north: float, east: float, course: float, speed: float, heading_rate: float
    ) -> float:
        """Return the heading rate to command [rad/s], and move the reference on by one time step.

        Parameters
        ----------
        north, east : position [m]
        course : chi [rad]
        speed : horizontal speed [m/s]
        heading_rate : measured rate of the course [rad/s]

        Raises
        ------
        LawError : the law returned no number
        """
        reference, ahead, lag = self.reference, self.ahead, self._lag
        then_north, then_east, then_course = north, east, course
        if lag > 0.0:
            then_north, then_east, then_course = lag_ahead(
                north, east, course, speed, heading_rate, self.heading_rate_command, lag
            )
        to_north, to_east, limit = ahead.north - then_north, ahead.east - then_east, self._limit
        try:
            demand = self._steer(ahead, to_north, to_east, then_course, speed)
        except TypeError as error:
            raise call_error(self._law, error) from None
        try:
            inside = -limit <= demand <= limit
        except (TypeError, ValueError):
            inside = False
        command = demand
        # Of an array of one number it is an array, too.
        if inside is not True:
            demand, command = within_limit(
                demand, limit, self._law, (to_north, to_east, then_course, speed)
            )
        self.heading_rate_demand, self.heading_rate_command = demand, command
        self.saturated = command != demand
        ahead.step()
        waiting = self._until_ahead
        waiting.append((ahead.north, ahead.east, ahead.course, ahead.heading_rate))
        reference.north, reference.east, reference.course, reference.heading_rate = (
            waiting.popleft()
        )
        return command

    def _move_ahead(self) -> None:
        ahead = self.ahead
        ahead.step()
        self._until_ahead.append((ahead.north, ahead.east, ahead.course, ahead.heading_rate))
