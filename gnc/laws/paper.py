"""The steering laws of the paper: (24) and (30) on the relative state, and the line of sight, the
baseline of its Sim. 2.
"""

import math
from dataclasses import dataclass, field
from typing import ClassVar

from gnc.laws.steering_law import NO_CIRCLE, ON_CIRCLE, check_parameters, steering_law
from gnc.numeric import wrap
from gnc.paper import (
    LookAhead,
    RelativeState,
    cascade_law,
    look_ahead,
    lyapunov_law,
    relative_state,
    relative_velocity,
)
from gnc.reference.reference import Reference


@dataclass(frozen=True, slots=True, kw_only=True)
class DeltaLaw:
    """Base of a steering law on the relative state of the delta formulation.

    Attributes
    ----------
    epsilon_per_m : growth of the look-ahead with the squared distance [1/m]
    look_ahead_m : look-ahead on the reference, R [m], above 1/(4 epsilon)

    Raises
    ------
    ValueError : a parameter is not finite and above 0, or R is too short
    """

    given: ClassVar[str] = "the reference itself, and its turn rate"
    epsilon_per_m: float = 0.005
    look_ahead_m: float = 60.0
    _look_ahead: LookAhead = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        check_parameters(self)
        object.__setattr__(self, "_look_ahead", look_ahead(self.epsilon_per_m, self.look_ahead_m))

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        state = relative_state(self._look_ahead, to_north, to_east, reference.course, course)
        _, omega_rho = relative_velocity(
            self._look_ahead, state, reference.speed, speed, reference.heading_rate
        )
        return self.omega(state, speed, omega_rho)

    def omega(self, state: RelativeState, speed: float, omega_rho: float) -> float:
        """Return omega [rad/s] by the relative state, the speed [m/s] and the rate of the course of
        z [rad/s].
        """
        raise NotImplementedError


@steering_law("cascade")
@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeLaw(DeltaLaw):
    """The cascade law, equation (30): course error and geometry one after the other.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as of ``DeltaLaw``
    gain_per_s : slope of h(phi) at 0 [1/s]
    steering_max_rad_s : largest |h(phi)| [rad/s]
    """

    gain_per_s: float = 1.5
    steering_max_rad_s: float = 0.4

    def omega(self, state: RelativeState, speed: float, omega_rho: float) -> float:  # noqa: ARG002 - of the base
        """Return omega [rad/s], equation (30); parameters are those of ``DeltaLaw``."""
        return cascade_law(state.phi, omega_rho, self.gain_per_s, self.steering_max_rad_s)


@steering_law("lyapunov")
@dataclass(frozen=True, slots=True, kw_only=True)
class LyapunovLaw(DeltaLaw):
    """The Lyapunov-based law, equation (24). What it demands has no bound.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as of ``DeltaLaw``
    lyapunov_gain_per_m2 : k_1 [1/m^2]
    """

    lyapunov_gain_per_m2: float = 0.001

    def omega(self, state: RelativeState, speed: float, omega_rho: float) -> float:
        """Return omega [rad/s], equation (24); parameters are those of ``DeltaLaw``."""
        return lyapunov_law(state, speed, omega_rho, self.lyapunov_gain_per_m2)


def line_of_sight_law(
    to_reference_north: float, to_reference_east: float, course: float, gain: float
) -> float:
    """Return omega [rad/s] that turns the course to the line of sight, proportionally.

    Undefined on the reference itself, where it commands nothing; close by, the line of sight and so
    the command turn arbitrarily fast.
    """
    if to_reference_north == 0.0 and to_reference_east == 0.0:
        return 0.0
    return gain * wrap(math.atan2(to_reference_east, to_reference_north) - course)


@steering_law("line_of_sight")
@dataclass(frozen=True, slots=True, kw_only=True)
class LineOfSightLaw:
    """Heading rate in proportion to the angle between course and line of sight. What it demands has
    no useful bound.

    Attributes
    ----------
    gain_per_s : [1/s]

    Raises
    ------
    ValueError : the gain is not finite and above 0
    """

    given: ClassVar[str] = "the reference's place (M3); elsewhere called proportional pursuit"
    cannot: ClassVar[dict[str, str]] = {ON_CIRCLE: NO_CIRCLE}
    gain_per_s: float = 1.5

    def __post_init__(self) -> None:
        check_parameters(self)

    def heading_rate(
        self,
        reference: Reference,  # noqa: ARG002
        to_north: float,
        to_east: float,
        course: float,
        speed: float,  # noqa: ARG002
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return line_of_sight_law(to_north, to_east, course, self.gain_per_s)
