"""Registry of steering laws, and the laws of the paper.

``gnc.steering`` has the Protocol of a law. The paper has the laws (24) and (30) on the relative
state, and compares them in Simulation 2 with the line of sight. Installed packages announce other
laws; ``extensions/arena`` has those of autopilots and of the literature.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import ClassVar

from common.registry import Registry
from gnc.numeric import wrap
from gnc.paper import LookAhead, cascade_law, look_ahead, lyapunov_law
from gnc.reference.reference import Reference
from gnc.steering import Air, Motion, SteeringLaw, relative_motion

ON_OSCILLATION = "oscillation"
"""Task of tracking an oscillating reference."""

ON_CIRCLE = "standoff"
"""Task of flying a circle about the vessel."""

ONLY_CIRCLES = {
    ON_OSCILLATION: "it flies a circle about a centre, and the oscillating reference has none;"
    " set guidance.mission to 'standoff'"
}
"""``unsupported_tasks`` of a law that flies circles."""

ONLY_MOVING_POINTS = {
    ON_CIRCLE: "it steers at a moving point, and the nearest point of a circle does not move ahead;"
    " set guidance.mission to 'follow'"
}
"""``unsupported_tasks`` of a pursuit law."""


STEERING_LAWS: Registry[Callable[..., SteeringLaw]] = Registry(
    "steering_law", folder="gnc.laws", methods=("heading_rate",)
)
"""Steering laws by name: classes that are called with the law's parameters."""

steering_law = STEERING_LAWS.register
"""Decorator that registers a steering law under a name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedLaw:
    """Base of a law whose parameters must all be finite and above 0.

    Raises
    ------
    ValueError : a parameter is not
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
    ValueError : as in ``CheckedLaw``, or R is too short
    """

    inputs: ClassVar[str] = "the reference itself, and its turn rate"
    epsilon_per_m: float = 0.005
    look_ahead_m: float = 60.0
    _look_ahead: LookAhead = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        CheckedLaw.__post_init__(self)
        object.__setattr__(self, "_look_ahead", look_ahead(self.epsilon_per_m, self.look_ahead_m))


@steering_law("cascade")
@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeLaw(DeltaLaw):
    """The cascade law, equation (30).

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as in ``DeltaLaw``
    gain_per_s : slope of h(phi) at 0 [1/s]
    steering_max_rad_s : largest |h(phi)| [rad/s]
    """

    gain_per_s: float = 1.5
    steering_max_rad_s: float = 0.4

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return omega [rad/s]; parameters are as in ``SteeringLaw``."""
        state, omega_rho = relative_motion(self._look_ahead, reference, own)
        return cascade_law(state.phi, omega_rho, self.gain_per_s, self.steering_max_rad_s)


@steering_law("lyapunov")
@dataclass(frozen=True, slots=True, kw_only=True)
class LyapunovLaw(DeltaLaw):
    """The Lyapunov-based law, equation (24), whose command is unbounded.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as in ``DeltaLaw``
    lyapunov_gain_per_m2 : k_1 [1/m^2]
    """

    lyapunov_gain_per_m2: float = 0.001

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return omega [rad/s]; parameters are as in ``SteeringLaw``."""
        state, omega_rho = relative_motion(self._look_ahead, reference, own)
        return lyapunov_law(state, own.speed, omega_rho, self.lyapunov_gain_per_m2)


def line_of_sight_law(
    to_reference_north: float, to_reference_east: float, course: float, gain: float
) -> float:
    """Return omega [rad/s], proportional to the angle from the course to the line of sight.

    Close to the reference the line of sight turns arbitrarily fast. On the reference it is
    undefined, and the command is 0.

    Parameters
    ----------
    to_reference_north, to_reference_east : d, from the vehicle to the reference [m]
    course : chi of the vehicle [rad]
    gain : heading rate per angle [1/s]
    """
    if to_reference_north == 0.0 and to_reference_east == 0.0:
        return 0.0
    return gain * wrap(math.atan2(to_reference_east, to_reference_north) - course)


@steering_law("line_of_sight")
@dataclass(frozen=True, slots=True, kw_only=True)
class LineOfSightLaw(CheckedLaw):
    """Heading rate proportional to the angle from the course to the line of sight.

    The command has no useful bound.

    Attributes
    ----------
    gain_per_s : heading rate per angle [1/s]
    """

    inputs: ClassVar[str] = "the reference's place (M3); elsewhere called proportional pursuit"
    unsupported_tasks: ClassVar[dict[str, str]] = ONLY_MOVING_POINTS
    gain_per_s: float = 1.5

    def heading_rate(self, reference: Reference, own: Motion, _air: Air, /) -> float:
        """Return omega [rad/s]; parameters are as in ``SteeringLaw``."""
        return line_of_sight_law(
            reference.north - own.north, reference.east - own.east, own.course, self.gain_per_s
        )
