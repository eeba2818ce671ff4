"""A steering law that flies at the ship whatever is demanded: how near it comes is up to the
keep-out guard alone.

To be flown on a circle about her that is wider than its distance: the nearest point of that is the
way she is not.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class AtTheShip:
    """Parameters are the gain of the course [1/s]."""

    gain: float = 20.0

    def heading_rate(self, reference, to_north, to_east, course, speed):
        del reference, speed
        return self.gain * math.remainder(math.atan2(-to_east, -to_north) - course, math.tau)
