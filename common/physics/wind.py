"""Wind as it is given, by where it comes from, and as a velocity."""

import math


def wind_towards(from_deg: float) -> float:
    """Return the course that wind blows along [rad], by where it comes from, clockwise from north
    [deg].
    """
    return math.radians(from_deg) + math.pi


def wind_velocity(speed: float, from_deg: float) -> tuple[float, float]:
    """Return north and east velocity of the air [m/s], by its speed [m/s] and where it comes from,
    clockwise from north [deg].
    """
    towards = wind_towards(from_deg)
    return speed * math.cos(towards), speed * math.sin(towards)
