"""A steering law that moves a copy of the reference ahead, and answers in single precision."""

import copy
import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class LooksAhead:
    """Steers at where the reference will be a second later."""

    pursuit_per_s: float = 1.2

    def heading_rate(self, reference, to_north, to_east, course, speed):
        """Return the demanded heading rate [rad/s]."""
        del speed
        later = copy.deepcopy(reference)
        for _ in range(20):
            later.step()
        north, east = (
            to_north + later.north - reference.north,
            to_east + later.east - reference.east,
        )
        off = math.remainder(math.atan2(east, north) - course, math.tau)
        return np.float32(self.pursuit_per_s * off + reference.heading_rate)
