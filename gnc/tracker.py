"""Tracking a reference point: preview by the vehicle's lag, the steering law, omega_max."""

from collections import deque
from dataclasses import dataclass
from typing import Generic, TypeVar

from gnc.estimation.navigation import AirMotion
from gnc.reference.reference import Reference
from gnc.steering import STILL_AIR, Air, LimitedLaw, Motion, SteeringLaw
from gnc.unicycle import lag_ahead


@dataclass(frozen=True, slots=True, kw_only=True)
class TrackingParameters:
    """How a reference is tracked.

    Attributes
    ----------
    law : steering law
    heading_rate_max : omega_max, which no command exceeds; infinite if the vehicle has no limit
        [rad/s]
    time_step : [s]
    lag : of the vehicle's heading rate behind its command [s]; above 0 the law runs that much ahead
        of time
    """

    law: SteeringLaw
    heading_rate_max: float
    time_step: float
    lag: float


class PlacedReference:
    """A reference that is placed from outside; attributes are those of ``Reference``."""

    def __init__(
        self,
        speed: float,
        north: float = 0.0,
        east: float = 0.0,
        course: float = 0.0,
        heading_rate: float = 0.0,
    ) -> None:
        self.speed = speed
        self.north = north
        self.east = east
        self.course = course
        self.heading_rate = heading_rate


class ReferenceTracker:
    """Tracks one reference point, stepped at a fixed rate.

    Parameters
    ----------
    parameters : of the tracking
    reference : the reference point at time 0

    Attributes
    ----------
    reference : the reference point now
    heading_rate_demand : last demand of the law, before omega_max limits it [rad/s]
    heading_rate_command : last command [rad/s]; to be set if another one is flown in its place
    saturated : whether omega_max limited the last demand
    """

    def __init__(self, parameters: TrackingParameters, reference: PlacedReference) -> None:
        self._law = LimitedLaw(parameters.law, parameters.heading_rate_max, parameters.time_step)
        self.reference = reference
        self.heading_rate_demand = 0.0
        self.heading_rate_command = 0.0
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
        PluginError : the law failed, or returned no number
        """
        raise NotImplementedError


AnyReference = TypeVar("AnyReference", bound=Reference)


class Tracker(ReferenceTracker, Generic[AnyReference]):
    """Tracks a reference that moves by itself.

    Preview: a vehicle that answers ``lag`` seconds late is steered by the law's demand at that
    later time. The reference then is known in advance. The vehicle's motion until then follows from
    its heading rate, which goes from the measured value to the last command.

    Parameters
    ----------
    parameters : of the tracking
    reference : at time 0; from then on the tracker moves it
    wind : motion whose wind the law gets; none for still air

    Attributes
    ----------
    ahead : the reference point at the end of the preview; it is the one that may be steered

    Further attributes are those of ``ReferenceTracker``.
    """

    def __init__(
        self,
        parameters: TrackingParameters,
        reference: AnyReference,
        wind: AirMotion | None = None,
    ) -> None:
        super().__init__(parameters, _copied(reference))
        self.ahead = reference
        self._wind = wind
        self._air = STILL_AIR
        # The reference moves once, ahead of time; here it waits until that time has come.
        self._until_ahead: deque[PlacedReference] = deque()
        steps_ahead = round(parameters.lag / parameters.time_step)
        for _ in range(steps_ahead):
            self._move_ahead()
        self._lag = steps_ahead * parameters.time_step

    def step(
        self, north: float, east: float, course: float, speed: float, heading_rate: float
    ) -> float:
        """Return the heading rate to command [rad/s]; see ``ReferenceTracker``."""
        if self._lag > 0.0:
            last = self.heading_rate_command
            north, east, course = lag_ahead(
                north, east, course, speed, heading_rate, last, self._lag
            )
            heading_rate = last
        own = Motion(north, east, course, speed, heading_rate)
        air = self._air
        wind = self._wind
        if wind is not None and (
            wind.wind_north != air.wind_north or wind.wind_east != air.wind_east
        ):
            self._air = air = Air(wind.wind_north, wind.wind_east)
        demand, command = self._law.demand(self.ahead, own, air)
        self.heading_rate_demand = demand
        self.heading_rate_command = command
        self.saturated = command != demand
        self._move_ahead()
        self.reference = self._until_ahead.popleft()
        return command

    def _move_ahead(self) -> None:
        self.ahead.step()
        self._until_ahead.append(_copied(self.ahead))


def _copied(reference: Reference) -> PlacedReference:
    """Return where a reference is now."""
    return PlacedReference(
        reference.speed,
        reference.north,
        reference.east,
        reference.course,
        reference.heading_rate,
    )
