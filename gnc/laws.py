"""Steering laws: what one is, which there are, and those of the paper.

The laws of the paper are (24) and (30) on the relative state, and the line of sight, which its
Sim. 2 compares with. Laws of autopilots and of the literature are in ``gnc.path_laws``.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from numbers import Real
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from common.registry import Registry
from gnc.errors import LawError
from gnc.numeric import wrap
from gnc.paper import (
    LookAhead,
    RelativeState,
    cascade_law,
    look_ahead,
    lyapunov_law,
    relative_motion,
)
from gnc.reference.reference import Reference

ON_OSCILLATION = "oscillation"
"""The task of tracking a point that oscillates."""

ON_CIRCLE = "standoff"
"""The task of flying a circle about the vessel."""

ONLY_CIRCLES = {
    ON_OSCILLATION: "it flies a circle about a centre, and the oscillating reference is on none;"
    " set guidance.mission to 'standoff'"
}
"""``unsupported_tasks`` of a law for circles."""

ONLY_MOVING_POINTS = {
    ON_CIRCLE: "it steers at a point that moves on, and the nearest point of a circle does not;"
    " set guidance.mission to 'follow'"
}
"""``unsupported_tasks`` of a law of pursuit."""


# ---------------------------------------------------------------- What a steering law is


class Motion(NamedTuple):
    """The motion of the vehicle.

    Where the vehicle answers late, the tracker predicts this motion ahead by the lag.

    Attributes
    ----------
    north, east : position, in the frame of the reference [m]
    course : chi, clockwise from north [rad]
    speed : horizontal speed [m/s]
    heading_rate : rate of the course, positive to the right [rad/s]
    """

    north: float
    east: float
    course: float
    speed: float
    heading_rate: float


class Air(NamedTuple):
    """The motion of the air and of the path, over the ground.

    Attributes
    ----------
    wind_north, wind_east : wind, as it is known on board [m/s]
    path_north, path_east : velocity of the frame in which the reference's path is at rest [m/s]
    """

    wind_north: float = 0.0
    wind_east: float = 0.0
    path_north: float = 0.0
    path_east: float = 0.0


STILL_AIR = Air()
"""No wind, and a path at rest over the ground."""


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


STEERING_LAWS: Registry[Callable[..., SteeringLaw]] = Registry(
    "steering_law", folder="gnc.path_laws", protocol="gnc.laws", methods=("heading_rate",)
)
"""Steering laws by name; calling one with its parameters makes it."""

steering_law = STEERING_LAWS.register
"""Decorator that registers a steering law by a name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedLaw:
    """Base of a law whose parameters are all finite and above 0.

    Raises
    ------
    ValueError : one is not
    """

    def __post_init__(self) -> None:
        for parameter in fields(self):
            if not parameter.init:
                continue
            value = getattr(self, parameter.name)
            if not (math.isfinite(value) and value > 0.0):
                raise ValueError(
                    f"{parameter.name} is {value:g}; it must be finite and above 0; the default is"
                    f" {parameter.default:g}"
                )


# ---------------------------------------------------------------- A law in flight

_HEADING_RATE = "its method heading_rate(reference, own, air) has to return a number [rad/s]"
_START = (
    "its method start(time_step) has to return the law of one flight, with a method heading_rate,"
    " or itself"
)


def started(law: SteeringLaw, time_step: float) -> SteeringLaw:
    """Return the law of one flight: what ``start`` returns, or the law itself if it has no memory.

    Parameters
    ----------
    law : as chosen
    time_step : time between two calls [s]

    Raises
    ------
    LawError : its ``start`` cannot be called so, or returns no law
    """
    start: Callable[[float], SteeringLaw] | None = getattr(law, "start", None)
    if start is None:
        return law
    name = type(law).__qualname__
    try:
        flown = start(time_step)
    except TypeError as error:
        raise _call_error(name, error, _START) from None
    if not callable(getattr(flown, "heading_rate", None)):
        raise LawError(f"steering law '{name}' returned {flown!r} from start(): {_START}")
    return flown


class LimitedLaw:
    """The law of one flight, with its result checked and kept within a limit.

    Parameters
    ----------
    law : as chosen
    limit : omega_max, which no command exceeds [rad/s]
    time_step : time between two calls [s]
    """

    def __init__(self, law: SteeringLaw, limit: float, time_step: float) -> None:
        self._name = type(law).__qualname__
        self._steer = started(law, time_step).heading_rate
        self._limit = limit

    def demand(self, reference: Reference, own: Motion, air: Air) -> tuple[float, float]:
        """Return the demanded heading rate, and the same kept within the limit [rad/s].

        Parameters are those of ``SteeringLaw.heading_rate``.

        Raises
        ------
        LawError : the law cannot be called so, or returns no number although all inputs are finite
        """
        try:
            rate: Any = self._steer(reference, own, air)
        except TypeError as error:
            raise _call_error(self._name, error, _HEADING_RATE) from None
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

    def _no_number(self, rate: object) -> LawError:
        shown = repr(rate) if isinstance(rate, str) else " ".join(str(rate).split())
        return LawError(f"steering law '{self._name}' returned {shown}: {_HEADING_RATE}")


def _is_finite(reference: Reference, own: Motion) -> bool:
    """Return whether a law's inputs are finite; after an aircraft has diverged they are not."""
    inputs = (reference.north, reference.east, own.north, own.east, own.course, own.speed)
    return all(math.isfinite(value) for value in inputs)


def _call_error(name: str, error: TypeError, must: str) -> Exception:
    """Return the error if it comes from inside the law, else one that says how to call it."""
    raised = error.__traceback__
    if raised is not None and raised.tb_next is not None:
        return error
    return LawError(f"steering law '{name}' cannot be called ({error}): {must}")


# ---------------------------------------------------------------- The laws of the paper


@dataclass(frozen=True, slots=True, kw_only=True)
class DeltaLaw(CheckedLaw):
    """Base of the laws on the relative state of the delta formulation, (14) to (19).

    Attributes
    ----------
    epsilon_per_m : growth of the look-ahead with the squared distance [1/m]
    look_ahead_m : look-ahead on the reference, R [m], above 1/(4 epsilon)

    Raises
    ------
    ValueError : same as ``CheckedLaw``, or R is too short
    """

    inputs: ClassVar[str] = "the reference itself, and its turn rate"
    epsilon_per_m: float = 0.005
    look_ahead_m: float = 60.0
    _look_ahead: LookAhead = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        CheckedLaw.__post_init__(self)
        object.__setattr__(self, "_look_ahead", look_ahead(self.epsilon_per_m, self.look_ahead_m))

    def relative_motion(self, reference: Reference, own: Motion) -> tuple[RelativeState, float]:
        """Return the relative state, and omega_rho, the rate of the course of z [rad/s]."""
        return relative_motion(
            self._look_ahead,
            reference.north - own.north,
            reference.east - own.east,
            reference.course,
            own.course,
            reference.speed,
            own.speed,
            reference.heading_rate,
        )


@steering_law("cascade")
@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeLaw(DeltaLaw):
    """The cascade law, equation (30): course error and geometry one after the other.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : same as ``DeltaLaw``
    gain_per_s : slope of h(phi) at 0 [1/s]
    steering_max_rad_s : largest |h(phi)| [rad/s]
    """

    gain_per_s: float = 1.5
    steering_max_rad_s: float = 0.4

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return omega [rad/s]; parameters are those of ``SteeringLaw``."""
        state, omega_rho = self.relative_motion(reference, own)
        return cascade_law(state.phi, omega_rho, self.gain_per_s, self.steering_max_rad_s)


@steering_law("lyapunov")
@dataclass(frozen=True, slots=True, kw_only=True)
class LyapunovLaw(DeltaLaw):
    """The Lyapunov-based law, equation (24). Its demand is unbounded.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : same as ``DeltaLaw``
    lyapunov_gain_per_m2 : k_1 [1/m^2]
    """

    lyapunov_gain_per_m2: float = 0.001

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return omega [rad/s]; parameters are those of ``SteeringLaw``."""
        state, omega_rho = self.relative_motion(reference, own)
        return lyapunov_law(state, own.speed, omega_rho, self.lyapunov_gain_per_m2)


def line_of_sight_law(
    to_reference_north: float, to_reference_east: float, course: float, gain: float
) -> float:
    """Return omega [rad/s], proportional to the angle from the course to the line of sight.

    The line of sight turns arbitrarily fast close to the reference. It is undefined on the
    reference, where the command is 0.

    Parameters
    ----------
    to_reference_north, to_reference_east : from the vehicle to the reference [m]
    course : chi of the vehicle [rad]
    gain : [1/s]
    """
    if to_reference_north == 0.0 and to_reference_east == 0.0:
        return 0.0
    return gain * wrap(math.atan2(to_reference_east, to_reference_north) - course)


@steering_law("line_of_sight")
@dataclass(frozen=True, slots=True, kw_only=True)
class LineOfSightLaw(CheckedLaw):
    """Heading rate proportional to the angle from the course to the line of sight.

    Its demand has no useful bound.

    Attributes
    ----------
    gain_per_s : [1/s]
    """

    inputs: ClassVar[str] = "the reference's place (M3); elsewhere called proportional pursuit"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS
    gain_per_s: float = 1.5

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return line_of_sight_law(
            reference.north - own.north, reference.east - own.east, own.course, self.gain_per_s
        )
