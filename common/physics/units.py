"""Conversion factors; everything outside JSBSim's properties is in SI and radians."""

import math

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
