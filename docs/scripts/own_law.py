"""Fly a steering law of your own over the speed ratio: pursue a point ahead on the reference."""

import math
from dataclasses import dataclass

from scenarios import run


@dataclass(frozen=True, kw_only=True)
class Pursuit:
    """Steers at a point ahead of the reference."""

    gain: float = 1.2
    lead_s: float = 1.0

    def heading_rate(self, reference, own, air):
        """Return the demanded heading rate [rad/s]."""
        lead = self.lead_s * reference.speed
        sight = math.atan2(
            reference.east - own.east + lead * math.sin(reference.course),
            reference.north - own.north + lead * math.cos(reference.course),
        )
        return self.gain * math.remainder(sight - own.course, math.tau) + reference.heading_rate


if __name__ == "__main__":
    sweep = run(
        "sweep_nu",
        nu=[0.3, 0.6],
        law=Pursuit(gain=1.5),
        flight={"crossings": 6},
        comparison={"variants": []},
    )
    print(sweep.summary[["nu", "criteria_met", "min_distance_m", "tracking_error_rms_m"]])
