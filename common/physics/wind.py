"""Wind by the direction it comes from, and as a velocity."""

import math


def wind_towards(from_deg: float) -> float:
    """Return the course along which wind from a direction blows [rad].

    Parameters
    ----------
    from_deg : direction that it comes from, clockwise from north [deg]
    """
    return math.radians(from_deg) + math.pi


def wind_velocity(speed: float, from_deg: float) -> tuple[float, float]:
    """Return north and east velocity of the air [m/s].

    Parameters
    ----------
    speed : of the wind [m/s]
    from_deg : direction that it comes from, clockwise from north [deg]
    """
    towards = wind_towards(from_deg)
    return speed * math.cos(towards), speed * math.sin(towards)
