"""A steering law that flies at a steady ship, ahead of it, or along a tangent of a disc about it.

Its keys say how the ship moves; where the ship is follows from them and from the wind.
"""

import math
from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class PastTheShip:
    """Parameters are the ship's motion, a disc's radius, the gain of the course [1/s], and which
    share of the way that the ship makes meanwhile is flown ahead of it [-].
    """

    ship_speed_mps: float = 0.0
    ship_course_deg: float = 0.0
    tangent_radius_m: float = 0.0
    attack_gain: float = 5.0
    lead_share: float = 0.0

    def start(self, time_step):
        return _Flight(self, time_step)

    def heading_rate(self, reference, own, air):
        raise NotImplementedError


class _Flight:
    def __init__(self, law, time_step):
        self._law = law
        self._time_step = time_step
        self._steps = 0
        self._drift = [0.0, 0.0]

    def heading_rate(self, reference, own, air):
        del reference
        law, wind = self._law, (air.wind_north, air.wind_east)
        sailed = law.ship_speed_mps * self._steps * self._time_step
        self._steps += 1
        self._drift = [
            moved + self._time_step * speed for moved, speed in zip(self._drift, wind, strict=True)
        ]
        course = math.radians(law.ship_course_deg)
        ahead = math.cos(course), math.sin(course)
        to_ship = [
            sailed * towards - place - moved
            for towards, place, moved in zip(ahead, (own.north, own.east), self._drift, strict=True)
        ]
        lead = law.lead_share * math.hypot(*to_ship) / max(5.0, own.speed)
        north, east = (
            place + lead * (law.ship_speed_mps * towards - speed)
            for place, towards, speed in zip(to_ship, ahead, wind, strict=True)
        )
        tangent = math.asin(min(1.0, law.tangent_radius_m / max(1.0, math.hypot(north, east))))
        wanted = math.atan2(east, north) + tangent
        return law.attack_gain * math.remainder(wanted - own.course, math.tau)
