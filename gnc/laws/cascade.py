"""The cascade law, equation (30)."""

from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.cascade_equation import cascade_heading_rate
from gnc.laws.delta_law import DeltaLaw
from gnc.laws.steering_law import steering_law
from gnc.reference.reference import Reference


@steering_law("cascade")
@dataclass(frozen=True, slots=True, kw_only=True)
class CascadeLaw(DeltaLaw):
    """The cascade law on the relative state of the delta formulation: course error and geometry one
    after the other.

    Attributes
    ----------
    epsilon_per_m, look_ahead_m : as of ``DeltaLaw``
    gain_per_s : slope of h(phi) at 0 [1/s]
    steering_max_rad_s : largest |h(phi)| [rad/s]

    Raises
    ------
    ValueError : as of ``DeltaLaw``
    """

    given: ClassVar[str] = "the reference itself, and its turn rate"
    gain_per_s: float = 1.5
    steering_max_rad_s: float = 0.4

    def heading_rate(
        self, reference: Reference, to_north: float, to_east: float, course: float, speed: float
    ) -> float:
        """Return the demanded heading rate [rad/s]; parameters are those of ``SteeringLaw``."""
        return cascade_heading_rate(
            self._look_ahead, to_north, to_east, course, speed,
            reference.course, reference.speed, reference.heading_rate, self.gain_per_s, self.steering_max_rad_s,
        )  # fmt: skip
