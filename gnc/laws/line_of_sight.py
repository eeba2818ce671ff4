"""The line-of-sight law, the baseline of the paper's Sim. 2; elsewhere it is called proportional
pursuit.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from gnc.laws.steering_law import NO_CIRCLE, ON_CIRCLE, check_parameters, steering_law
from gnc.numeric import wrap
from gnc.reference.reference import Reference


def line_of_sight_law(
    to_reference_north: float, to_reference_east: float, course: float, gain: float
) -> float:
    """Return omega [rad/s] that turns the course to the line of sight, proportionally: the baseline
    of the paper's Sim. 2.

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
