"""Units, wind and coordinated turns."""

import math

# --- Units and constants

METRES_PER_FOOT = 0.3048
"""International foot, exact by definition [m/ft]."""

SECONDS_PER_HOUR = 3600.0
"""Hour [s]."""

METRES_PER_NAUTICAL_MILE = 1852.0
"""International nautical mile, exact by definition [m/nmi]."""

METRES_PER_SECOND_PER_KNOT = METRES_PER_NAUTICAL_MILE / SECONDS_PER_HOUR
"""Knot: one nautical mile per hour, exact by definition [m/s per kt]."""

NEWTONS_PER_POUND = 4.4482216152605
"""Pound-force, exact by definition [N/lbf]."""

RAD_S_PER_RPM = math.pi / 30.0
"""One revolution per minute [rad/s per rpm]."""

KG_PER_SLUG = 14.593902937206364
"""Slug: lbf s^2/ft [kg/slug]."""

STANDARD_GRAVITY = 9.80665
"""Standard acceleration of free fall, by definition (CGPM 1901) [m/s^2]."""


# --- Wind


def wind_towards(from_deg: float) -> float:
    """Return the direction to which a wind from ``from_deg`` blows, clockwise from north [rad]."""
    return math.radians(from_deg) + math.pi


def wind_velocity(speed: float, from_deg: float) -> tuple[float, float]:
    """Return north and east velocity of a wind from ``from_deg``, clockwise from north [m/s]."""
    towards = wind_towards(from_deg)
    return speed * math.cos(towards), speed * math.sin(towards)


# --- Coordinated turns


def heading_rate_for_bank(bank: float, speed: float) -> float:
    """Return the heading rate [rad/s] of a coordinated turn with a bank [rad] at a speed [m/s]."""
    return STANDARD_GRAVITY * math.tan(bank) / speed


def bank_for_heading_rate(heading_rate: float, speed: float) -> float:
    """Return the bank [rad] of a coordinated turn at a heading rate [rad/s] and a speed [m/s]."""
    return math.atan(heading_rate * speed / STANDARD_GRAVITY)
