"""The mean motion that takes a reference's orbit to its place.

It is that of the centre of oscillation, plus a drift towards it. Along the centre's motion a drift
changes the amplitude alone; across, it turns the mean course, which moves the orbit's centre by
itself, the more the slower the orbit. So a slow orbit does not turn with each small swing of a
plume whose direction is not known well, but with a swing that goes on.
"""

import math
from typing import NamedTuple

from gnc.numeric import limited
from gnc.reference.moving_centre import MovingCentre

_CENTRE_GAIN = 0.1
"""Demanded drift of the orbit's centre per distance from its place over omega_max [-]."""

_ALONG_FRACTION = 0.3
"""Largest fraction of V_r that a drift takes along the centre's motion [-]."""

_ACROSS_FRACTION = 0.4
"""Largest fraction of the centre's speed that it takes across [-]: more would turn the orbit."""

_STILL = 0.05
"""Speed ratio of a centre below which its orbit lies across the plume [-]."""

_SLOW = 0.25
"""Speed ratio below which the gain falls [-]: a small turn moves a slow orbit by much."""

_SLOW_GAIN_MIN = 0.1
"""Fraction of that gain at rest [-]: an orbit at rest has to be centred, too."""

_SWING = 0.1
"""Speed over V_r of an unsteady swing that a slow orbit follows by half [-]: less is scatter."""

_SPEED_RATIO_MIN = 0.1
"""Least speed ratio of a mean motion that is turned [-]."""


class _Ahead(NamedTuple):
    """Direction in which an orbit goes on, speed that gives it, centre's speed along it [m/s]."""

    north: float
    east: float
    moving: float
    along: float


def motion_course(centre: MovingCentre) -> float:
    """Return the course of a centre of oscillation; at rest, that against the plume [rad].

    An orbit lies across its course, and so across the plume of a vessel at rest.
    """
    if centre.velocity_north == centre.velocity_east == 0.0:
        return math.atan2(-math.sin(centre.axis), -math.cos(centre.axis))
    return math.atan2(centre.velocity_east, centre.velocity_north)


def mean_motion(
    centre: MovingCentre, off_north: float, off_east: float, speed: float, heading_rate_max: float
) -> tuple[float, float]:
    """Return the mean course [rad] and the mean speed over speed [-] to demand of the reference.

    Parameters
    ----------
    centre : of oscillation, where the orbit's centre should be
    off_north, off_east : from the orbit's centre to it [m]
    speed, heading_rate_max : V_r and omega_max [m/s, rad/s]
    """
    ahead = _ahead(centre, speed)
    gain = _CENTRE_GAIN * heading_rate_max
    most = _ALONG_FRACTION * speed
    behind = off_north * ahead.north + off_east * ahead.east
    along = ahead.along + limited(gain * behind, most)
    gain *= min(1.0, max(_SLOW_GAIN_MIN, ahead.moving / (_SLOW * speed)))
    most = _ACROSS_FRACTION * max(ahead.moving, _SPEED_RATIO_MIN * speed)
    beside = off_east * ahead.north - off_north * ahead.east
    across = limited(gain * beside, most)
    turned = math.atan2(across, max(along, _SPEED_RATIO_MIN * speed))
    course = math.atan2(ahead.east, ahead.north) + turned
    return course, along / math.cos(turned) / speed


def _ahead(centre: MovingCentre, speed: float) -> _Ahead:
    """Return the direction in which the orbit of a centre goes on.

    A centre that recedes faster than its vessel moves reverses its motion: then the direction is
    the vessel's, and the orbit backs away. To turn it round would take it far off.
    """
    north, east = _followed_velocity(centre, speed)
    cos_a = math.cos(centre.axis)
    sin_a = math.sin(centre.axis)
    vessel_north = north - centre.receding * cos_a
    vessel_east = east - centre.receding * sin_a
    if north * vessel_north + east * vessel_east >= 0.0:
        moving = math.hypot(north, east)
        if moving > _STILL * speed:
            return _Ahead(north / moving, east / moving, moving, moving)
    else:
        moving = math.hypot(vessel_north, vessel_east)
        if moving > _STILL * speed:
            cos_m = vessel_north / moving
            sin_m = vessel_east / moving
            return _Ahead(cos_m, sin_m, moving, north * cos_m + east * sin_m)
    return _Ahead(-cos_a, -sin_a, moving, -(north * cos_a + east * sin_a))


def _followed_velocity(centre: MovingCentre, speed: float) -> tuple[float, float]:
    """Return a centre's velocity, north and east, without a slow one's small swings [m/s]."""
    slow = centre.speed_ratio / _SLOW
    if slow >= 1.0:
        return centre.velocity_north, centre.velocity_east
    unsteady = centre.swing - centre.steady_swing
    followed = max(slow * slow, unsteady * unsteady / (unsteady * unsteady + (_SWING * speed) ** 2))
    left_out = (1.0 - followed) * unsteady
    north = centre.velocity_north + left_out * math.sin(centre.axis)
    east = centre.velocity_east - left_out * math.cos(centre.axis)
    return north, east
