"""Proportional navigation: turn N times as fast as the line of sight does."""

from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.steering_law import NO_CIRCLE, ON_CIRCLE, check_parameters, steering_law
from gnc.reference.reference import Reference
from gnc.vectors import Vector, along, cross, dot, minus, scaled


def sight_rate(to_target: Vector, relative_velocity: Vector) -> float:
    """Return the rate of the line of sight [rad/s]; 0 on the target, where there is none. A pure
    function.

    Parameters
    ----------
    to_target : from the vehicle to the point [m]
    relative_velocity : of the point less that of the vehicle [m/s]
    """
    squared = dot(to_target, to_target)
    return cross(to_target, relative_velocity) / squared if squared > 0.0 else 0.0


@steering_law("proportional_navigation")
@dataclass(frozen=True, slots=True, kw_only=True)
class ProportionalNavigationLaw:
    """Proportional navigation towards the reference itself (M3). What it demands has no bound close
    to the reference.

    Attributes
    ----------
    navigation_constant : navigation constant N, heading rate over the rate of the line of sight [-]
    """

    given: ClassVar[str] = "the reference's place and velocity (M3)"
    navigation_constant: float = 3.0
    cannot: ClassVar[dict[str, str]] = {ON_CIRCLE: NO_CIRCLE}

    def __post_init__(self) -> None:
        check_parameters(self)

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        relative = minus(
            scaled(along(reference.course), reference.speed), scaled(along(course), speed)
        )
        return self.navigation_constant * sight_rate((to_north, to_east), relative)
