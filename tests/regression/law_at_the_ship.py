"""A steering law that flies at the ship: only the keep-out guard keeps it away.

To be flown on a circle about the ship that is wider than the vehicle's distance: then the nearest
point of the circle is on the side away from the ship.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class AtTheShip:
    """Parameters are the gain of the course [1/s]."""

    gain: float = 20.0

    def heading_rate(self, reference, own, air):
        del air
        away = math.atan2(-(reference.east - own.east), -(reference.north - own.north))
        return self.gain * math.remainder(away - own.course, math.tau)
