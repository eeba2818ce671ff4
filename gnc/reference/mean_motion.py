"""The mean motion that keeps a reference's orbit centred on the centre of oscillation.

It is the motion of the centre of oscillation plus a drift towards it. A drift along the centre's
motion only changes the amplitude. A drift across it turns the mean course, which by itself moves
the orbit's centre; the slower the orbit, the farther. A slow orbit therefore follows lasting swings
of the plume, but not each small swing of an uncertain plume direction.
"""

import math
from typing import NamedTuple

from gnc.numeric import limited
from gnc.reference.moving_centre import MovingCentre

_CENTRE_GAIN = 0.1
"""Demanded drift of the orbit's centre over its offset times omega_max [-]."""

_ALONG_FRACTION = 0.3
"""Largest drift along the centre's motion, over V_r [-]."""

_ACROSS_FRACTION = 0.4
"""Largest drift across, over the centre's speed [-]: more would turn the orbit."""

_STILL = 0.05
"""Speed ratio of a centre below which the orbit lies across the plume [-]."""

_SLOW = 0.25
"""Speed ratio below which the gain decreases [-]: a small turn moves a slow orbit far."""

_SLOW_GAIN_MIN = 0.1
"""Fraction of the gain for a centre at rest [-]: its orbit has to be centred as well."""

_SWING = 0.1
"""Speed over V_r of an unsteady swing that a slow orbit follows by half [-]; less is scatter."""

_SPEED_RATIO_MIN = 0.1
"""Least speed ratio of a mean motion that may turn [-]."""


class _OrbitMotion(NamedTuple):
    """Direction of an orbit's motion, speed that determines it, centre's speed along it [m/s]."""

    north: float
    east: float
    moving: float
    along: float


def motion_course(centre: MovingCentre) -> float:
    """Return the course of a centre of oscillation; at rest, the direction up the plume [rad].

    An orbit lies across its course, so beside a vessel at rest it lies across the plume.
    """
    if centre.velocity_north == centre.velocity_east == 0.0:
        return math.atan2(-math.sin(centre.axis), -math.cos(centre.axis))
    return math.atan2(centre.velocity_east, centre.velocity_north)


def mean_motion(
    centre: MovingCentre, off_north: float, off_east: float, speed: float, heading_rate_max: float
) -> tuple[float, float]:
    """Return the demanded mean course [rad] and ratio of mean speed to speed [-] of the reference.

    Parameters
    ----------
    centre : centre of oscillation, the demanded position of the orbit's centre
    off_north, off_east : offset from the orbit's centre to the centre of oscillation [m]
    speed, heading_rate_max : V_r and omega_max [m/s, rad/s]
    """
    ahead = _orbit_motion(centre, speed)
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


def _orbit_motion(centre: MovingCentre, speed: float) -> _OrbitMotion:
    """Return the direction of the orbit's motion.

    A centre that recedes faster than its vessel moves reverses its motion. The orbit then keeps the
    vessel's direction and backs away, because turning it round would move it far off.
    """
    north, east = _followed_velocity(centre, speed)
    cos_a = math.cos(centre.axis)
    sin_a = math.sin(centre.axis)
    vessel_north = north - centre.receding * cos_a
    vessel_east = east - centre.receding * sin_a
    if north * vessel_north + east * vessel_east >= 0.0:
        moving = math.hypot(north, east)
        if moving > _STILL * speed:
            return _OrbitMotion(north / moving, east / moving, moving, moving)
    else:
        moving = math.hypot(vessel_north, vessel_east)
        if moving > _STILL * speed:
            cos_m = vessel_north / moving
            sin_m = vessel_east / moving
            return _OrbitMotion(cos_m, sin_m, moving, north * cos_m + east * sin_m)
    return _OrbitMotion(-cos_a, -sin_a, moving, -(north * cos_a + east * sin_a))


def _followed_velocity(centre: MovingCentre, speed: float) -> tuple[float, float]:
    """Return a centre's velocity, north and east, without small swings of a slow centre [m/s]."""
    slow = centre.speed_ratio / _SLOW
    if slow >= 1.0:
        return centre.velocity_north, centre.velocity_east
    unsteady = centre.swing - centre.steady_swing
    followed = max(slow * slow, unsteady * unsteady / (unsteady * unsteady + (_SWING * speed) ** 2))
    left_out = (1.0 - followed) * unsteady
    north = centre.velocity_north + left_out * math.sin(centre.axis)
    east = centre.velocity_east - left_out * math.cos(centre.axis)
    return north, east
