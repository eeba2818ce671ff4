"""What a steering law is, and which there are."""

import math
from collections.abc import Callable
from dataclasses import fields
from typing import Any, Protocol

from common.registry import Registry
from gnc.reference.reference import Reference


class SteeringLaw(Protocol):
    """What heading rate to command, from where the reference is and how the vehicle moves.

    A law is a frozen dataclass that is registered by a name in a file of its own. Its fields are the keys of a scenario's
    ``[guidance]`` by the same names, in SI units, each with a default.
    """

    def heading_rate(self, reference: Reference, to_north: float, to_east: float, course: float, speed: float) -> float:
        """Return the demanded heading rate [rad/s], positive to the right, before any limit of the vehicle.

        Parameters
        ----------
        reference : the point to track; its ``course`` [rad], ``heading_rate`` [rad/s] and ``speed`` V_r [m/s] are for the law,
            its position may be given for another frame than ``to_north`` and ``to_east``
        to_north, to_east : from the vehicle to the reference [m]
        course : chi of the vehicle, clockwise from north [rad]
        speed : horizontal speed of the vehicle [m/s]
        """


STEERING_LAWS: Registry[Callable[..., SteeringLaw]] = Registry("steering_law", folder="gnc.laws", methods=("heading_rate",))
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
            raise ValueError(f"{field.name} is {value:g}; it must be finite and above 0; the default is {field.default:g}")
