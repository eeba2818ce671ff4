"""What a steering law is, and one in flight: what it gets, and its result checked and limited.

The module is compiled by ``make fast``; the laws themselves, which users extend, are not.
"""

import math
from collections.abc import Callable
from numbers import Real
from typing import Any, NamedTuple, Protocol

import numpy as np

from common.errors import PluginError
from common.plugins import PASSED_ON, call_plugin, explained, rejected_result
from gnc.errors import InfeasibleError
from gnc.paper import LookAhead, RelativeState, relative_state, relative_velocity
from gnc.reference.reference import Reference
from gnc.vectors import Vector, along, course_of, dot, norm, plus, scaled


class Motion:
    """The motion of the vehicle.

    Where the vehicle answers late, the tracker predicts this motion ahead by the lag.

    Attributes
    ----------
    north, east : position, in the frame of the reference [m]
    course : chi, clockwise from north [rad]
    speed : horizontal speed [m/s]
    heading_rate : rate of the course, positive to the right [rad/s]
    """

    def __init__(
        self, north: float, east: float, course: float, speed: float, heading_rate: float
    ) -> None:
        self.north = north
        self.east = east
        self.course = course
        self.speed = speed
        self.heading_rate = heading_rate


class Air:
    """The motion of the air and of the path, over the ground.

    Attributes
    ----------
    wind_north, wind_east : wind, as it is known on board [m/s]
    path_north, path_east : velocity of the frame in which the reference's path is at rest [m/s]
    """

    def __init__(
        self,
        wind_north: float = 0.0,
        wind_east: float = 0.0,
        path_north: float = 0.0,
        path_east: float = 0.0,
    ) -> None:
        self.wind_north = wind_north
        self.wind_east = wind_east
        self.path_north = path_north
        self.path_east = path_east


STILL_AIR = Air()
"""No wind, and a path at rest over the ground."""


class DesiredCourse(NamedTuple):
    """A course or heading to take, and its rate.

    Attributes
    ----------
    course : over the ground, relative to a centre, or through the air [rad]
    rate : as the vehicle moves [rad/s]
    """

    course: float
    rate: float


def heading_for(course: float, course_rate: float, airspeed: float, drift: Vector) -> DesiredCourse:
    """Return the heading that gives a course relative to a centre, and its rate.

    It follows from the triangle of velocities.

    Parameters
    ----------
    course, course_rate : of the velocity relative to the centre [rad, rad/s]
    airspeed : V_a [m/s]
    drift : velocity of the centre through the air [m/s]

    Raises
    ------
    InfeasibleError : the centre is as fast through the air as the vehicle
    """
    if norm(drift) >= airspeed:
        raise InfeasibleError(
            f"the centre moves through the air at {norm(drift):.2f} m/s, the vehicle at"
            f" {airspeed:.2f} m/s; no circle about it can be flown: follow a slower vessel, or fly"
            " faster"
        )
    direction = along(course)
    back = dot(direction, drift)
    speed = -back + math.sqrt(back * back + airspeed * airspeed - dot(drift, drift))
    heading = course_of(plus(scaled(direction, speed), drift))
    return DesiredCourse(heading, course_rate * speed / (airspeed * math.cos(heading - course)))


class SteeringLaw(Protocol):
    """A steering law: a heading rate from the reference, the vehicle's motion and the air.

    A law is a frozen dataclass. Its fields are keys of a scenario's ``[guidance]`` by the same
    names, in SI units, each with a default. This one is complete::

        @dataclass(frozen=True, kw_only=True)
        class Pursuit:
            pursuit_gain_per_s: float = 1.2

            def heading_rate(self, reference, own, air):
                sight = math.atan2(reference.east - own.east, reference.north - own.north)
                return self.pursuit_gain_per_s * math.remainder(sight - own.course, math.tau)

    Three more members are optional.

    ``start(time_step)`` returns the law of one flight, an object with ``heading_rate``. A law that
    remembers something needs it, because one law flies many flights. The time step is in s.

    ``inputs`` is a class attribute: what the law uses of the reference and of the air, in words.

    ``unsupported_tasks`` is a class attribute: why the law cannot do a task, by the task
    (``oscillation``, ``standoff``), as in ``{"standoff": "it steers at a point"}``.
    """

    def heading_rate(self, reference: Reference, own: Motion, air: Air, /) -> float:
        """Return the demanded heading rate [rad/s], positive to the right, before any limit.

        Parameters
        ----------
        reference : the point to track; it must not be changed
        own : motion of the vehicle
        air : wind, and velocity of the path
        """


def relative_motion(
    look_ahead: LookAhead, reference: Reference, own: Motion
) -> tuple[RelativeState, float]:
    """Return what the paper's laws need: the relative state (19) and omega_rho (18) [rad/s].

    Parameters
    ----------
    look_ahead : its parameters
    reference, own : motion of the reference point and of the vehicle
    """
    state = relative_state(
        look_ahead,
        reference.north - own.north,
        reference.east - own.east,
        reference.course,
        own.course,
    )
    _, omega_rho = relative_velocity(
        look_ahead, state, reference.speed, own.speed, reference.heading_rate
    )
    return state, omega_rho


# ---------------------------------------------------------------- A law in flight

_HEADING_RATE = "a number, the heading rate [rad/s]"


def started(law: SteeringLaw, time_step: float) -> SteeringLaw:
    """Return the law of one flight: what ``start`` returns, or the law itself if it has no memory.

    Parameters
    ----------
    law : as chosen
    time_step : time between two calls [s]

    Raises
    ------
    PluginError : its ``start`` fails, or returns no law
    """
    start: Callable[[float], SteeringLaw] | None = getattr(law, "start", None)
    if start is None:
        return law
    return call_plugin(f"steering law '{type(law).__qualname__}'", start, time_step, result=_law)


def _law(found: Any) -> SteeringLaw:
    if not callable(getattr(found, "heading_rate", None)):
        raise TypeError("the law of one flight, with a method heading_rate, or itself")
    law: SteeringLaw = found
    return law


class LimitedLaw:
    """The law of one flight, with its result checked and kept within a limit.

    Parameters
    ----------
    law : as chosen
    limit : omega_max, which no command exceeds [rad/s]
    time_step : time between two calls [s]
    """

    def __init__(self, law: SteeringLaw, limit: float, time_step: float) -> None:
        self._part = f"steering law '{type(law).__qualname__}'"
        self._steer = started(law, time_step).heading_rate
        self._limit = limit

    def demand(self, reference: Reference, own: Motion, air: Air) -> tuple[float, float]:
        """Return the demanded heading rate, and the same kept within the limit [rad/s].

        Parameters are those of ``SteeringLaw.heading_rate``.

        Raises
        ------
        PluginError : the law fails, or returns no number although all inputs are finite
        """
        try:
            rate: Any = self._steer(reference, own, air)
        except PASSED_ON:
            raise
        except Exception as error:
            raise explained(self._part, self._steer, error) from error
        if type(rate) is not float:
            rate = self._number(rate)
        if math.isnan(rate) and _is_finite(reference, own):
            raise self._no_number(rate)
        # Same as ``limited``, without a call.
        limit = self._limit
        if rate > limit:
            return rate, limit
        return rate, -limit if rate < -limit else rate

    def _number(self, rate: Any) -> float:
        """Return a real number as a float: one of NumPy would pass its precision on."""
        number = rate[()] if isinstance(rate, np.ndarray) and rate.ndim == 0 else rate
        if not isinstance(number, Real):
            raise self._no_number(rate)
        return float(number)

    def _no_number(self, rate: object) -> PluginError:
        return rejected_result(f"{self._part}: heading_rate() returned", rate, _HEADING_RATE)


def _is_finite(reference: Reference, own: Motion) -> bool:
    """Return whether a law's inputs are finite; after an aircraft has diverged they are not."""
    inputs = (reference.north, reference.east, own.north, own.east, own.course, own.speed)
    return all(math.isfinite(value) for value in inputs)
