"""What a steering law is, and which there are."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from numbers import Real
from typing import Any, Protocol

import numpy as np

from common.registry import Registry
from gnc.errors import LawError
from gnc.numeric import limited
from gnc.reference.reference import Reference

ON_OSCILLATION = "oscillation"
"""The task of tracking a point that oscillates."""

ON_CIRCLE = "standoff"
"""The task of flying a circle about the vessel."""

CIRCLES_ALONE = "it flies a circle about a centre, and the oscillating reference is on none; set guidance.mission to 'standoff'"
"""Why a law for circles cannot track the oscillating reference."""

NO_CIRCLE = "it steers at a point that moves on, and the nearest point of a circle does not; set guidance.mission to 'follow'"
"""Why a law of pursuit cannot fly a circle."""


class SteeringLaw(Protocol):
    """What heading rate to command, from where the reference is and how the vehicle moves.

    A law is a frozen dataclass that is registered by a name in a file of its own. Its fields are
    the keys of a scenario's ``[guidance]`` by the same names, in SI units, each with a default. A
    law that remembers something, or that needs wind, has a method ``begin`` beside: see ``begun``.
    One that cannot do a task says so in ``cannot``, by the task, with the reason; ``given`` says in
    words what of the reference and of the air a law makes use of.
    """

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s], positive to the right, before any limit of the
        vehicle.

        Parameters
        ----------
        reference : the point to track; its ``course`` [rad], ``heading_rate`` [rad/s] and ``speed``
            V_r [m/s] are for the law, its position may be given for another frame than ``to_north``
            and ``to_east``
        to_north, to_east : from the vehicle to the reference [m]
        course : chi of the vehicle, clockwise from north [rad]
        speed : horizontal speed of the vehicle [m/s]
        """


class Air(Protocol):
    """The air mass.

    Attributes
    ----------
    wind_north, wind_east : its velocity over the ground [m/s]
    """

    @property
    def wind_north(self) -> float:
        """Velocity to the north."""

    @property
    def wind_east(self) -> float:
        """Velocity to the east."""


@dataclass(slots=True)
class Surroundings:
    """What a law may know beside its reference; kept up to date by whoever calls the law.

    Attributes
    ----------
    air : as it is known on board
    path_north, path_east : velocity over the ground of the frame in which the reference's path is
        at rest [m/s]
    """

    air: Air
    path_north: float = 0.0
    path_east: float = 0.0


@dataclass(frozen=True, slots=True)
class _StillAir:
    wind_north: float = 0.0
    wind_east: float = 0.0


STILL_AIR = Surroundings(_StillAir())
"""Surroundings without wind, of a path over the ground."""


_BEGINS = "its method begin(surroundings, time_step) has to return the law of one flight, with a method heading_rate, or itself"


def begun(law: SteeringLaw, surroundings: Surroundings, time_step: float) -> SteeringLaw:
    """Return the law of one flight: a law that has a state, or looks at its surroundings, has a
    method ``begin`` for it.

    Parameters
    ----------
    law : as chosen
    surroundings : of the flight
    time_step : with which it will be called [s]

    Raises
    ------
    LawError : its ``begin`` cannot be called so, or returns no law
    """
    begin: Callable[[Surroundings, float], SteeringLaw] | None = getattr(law, "begin", None)
    if begin is None:
        return law
    name = type(law).__qualname__
    try:
        flown = begin(surroundings, time_step)
    except TypeError as error:
        raise call_error(name, error, _BEGINS) from None
    if not callable(getattr(flown, "heading_rate", None)):
        raise LawError(f"steering law '{name}' returned {flown!r} from begin(): {_BEGINS}")
    return flown


_MUST = "its method heading_rate(reference, to_north, to_east, course, speed) has to return a number [rad/s]"


def within_limit(
    demand: Any, limit: float, law: str, given: Sequence[float]
) -> tuple[float, float]:
    """Return what a law demanded, as a plain number, and that kept within minus and plus ``limit``
    [rad/s].

    Parameters
    ----------
    demand : what it returned
    limit : omega_max [rad/s]
    law : its name, for the error
    given : what it was asked with; of what is not finite itself, as after an aircraft has diverged,
        it can make no number

    Raises
    ------
    LawError : it returned what is no number, asked with numbers
    """
    if _is_number(demand) and (
        -limit <= demand <= limit or not math.isnan(demand) or not all(map(math.isfinite, given))
    ):
        # A number of NumPy's would have all that follows computed in its own precision, or be
        # changed in place.
        return float(demand), float(limited(demand, limit))
    shown = repr(demand) if isinstance(demand, str) else " ".join(str(demand).split())
    raise LawError(f"steering law '{law}' returned {shown}: {_MUST}")


def _is_number(demand: Any) -> bool:
    """Return whether a demand is a real number, or an array of no dimensions with one in it, as
    ``numpy.where`` makes it.
    """
    if isinstance(demand, np.ndarray) and demand.ndim == 0:
        demand = demand[()]
    return isinstance(demand, float | Real)


def call_error(law: str, error: TypeError, must: str = _MUST) -> Exception:
    """Return what to raise for an error of a call: the same where it comes from inside the law,
    where it names its place.

    Parameters
    ----------
    law : its name
    error : of the call
    must : what the method that was called has to be
    """
    raised = error.__traceback__
    if raised is not None and raised.tb_next is not None:
        return error
    return LawError(f"steering law '{law}' cannot be called ({error}): {must}")


STEERING_LAWS: Registry[Callable[..., SteeringLaw]] = Registry(
    "steering_law", folder="gnc.laws", methods=("heading_rate",)
)
"""Steering laws by name; calling one with its parameters makes it."""

steering_law = STEERING_LAWS.register
"""Decorator that registers a steering law by a name."""


def check_parameters(law: Any) -> None:
    """Refuse a law whose parameters are not all finite and above 0.

    Raises
    ------
    ValueError : one is not
    """
    for field in fields(law):
        if field.init and not (math.isfinite(value := getattr(law, field.name)) and value > 0.0):
            raise ValueError(
                f"{field.name} is {value:g}; it must be finite and above 0; the default is {field.default:g}"
            )
