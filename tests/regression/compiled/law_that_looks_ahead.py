"""A steering law that moves a copy of the reference ahead, and answers in single precision."""

import copy
import math
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True)
class LooksAhead:
    """Steers at where the reference will be a second later."""

    pursuit_per_s: float = 1.2

    def heading_rate(self, reference, own, air):
        """Return the demanded heading rate [rad/s]."""
        del air
        later = copy.deepcopy(reference)
        for _ in range(20):
            later.step()
        sight = math.atan2(later.east - own.east, later.north - own.north)
        off = math.remainder(sight - own.course, math.tau)
        return np.float32(self.pursuit_per_s * off + reference.heading_rate)
