"""What mean motion takes a reference's orbit to where it should be.

It is that of the centre of oscillation, and a drift towards it. Along the centre's motion a drift
changes the amplitude alone; across, it turns the mean course, which moves the orbit's centre by
itself, the more the slower the orbit. So a slow orbit does not turn with each small swing of a
plume whose direction is not known well, but with a swing that goes on.
"""

import math

from gnc.numeric import limited
from gnc.reference.moving_centre import MovingCentre

_CENTRE_GAIN = 0.1
"""Demanded drift of the orbit's centre per distance from where it should be, in units of omega_max
[-].
"""

_ALONG_FRACTION = 0.3
"""Largest fraction of V_r that such a drift takes along the centre's motion [-]; it changes the
amplitude alone.
"""

_ACROSS_FRACTION = 0.4
"""Largest fraction of the centre's speed that it takes across [-]: more would turn the orbit
instead of moving it.
"""

_STILL = 0.05
"""Speed ratio below which a centre's motion gives no direction to an orbit [-]: then it lies across
the plume.
"""

_SLOW = 0.25
"""Speed ratio below which that gain falls in proportion [-]: turning the mean course by a little
moves a slow orbit by much.
"""

_SLOW_GAIN_MIN = 0.1
"""Fraction of that gain which is kept at any speed ratio [-]: an orbit at rest across the plume has
to be centred, too.
"""

_SWING = 0.1
"""Speed of an unsteady swing about the vessel, over V_r, of which a slow orbit follows half [-]:
less is mostly scatter.
"""

_SPEED_RATIO_MIN = 0.1
"""Speed ratio that a mean motion has at least where it is turned [-]: a smaller one would be turned
to any course by a drift.
"""


def motion_course(centre: MovingCentre) -> float:
    """Return the course of a centre of oscillation [rad]; of one at rest that against the plume,
    across which its orbit lies.
    """
    if centre.velocity_north == centre.velocity_east == 0.0:
        return math.atan2(-math.sin(centre.axis), -math.cos(centre.axis))
    return math.atan2(centre.velocity_east, centre.velocity_north)


def mean_motion(
    centre: MovingCentre, off_north: float, off_east: float, speed: float, heading_rate_max: float
) -> tuple[float, float]:
    """Return the mean course [rad] and the mean speed over the speed [-] to demand of the
    reference.

    Parameters
    ----------
    centre : of oscillation, where the orbit's centre should be
    off_north, off_east : from the orbit's centre to it [m]
    speed, heading_rate_max : V_r and omega_max [m/s, rad/s]
    """
    north, east = _followed(centre, speed)
    cos_m, sin_m, moving, ahead = _ahead(centre, north, east, speed)
    gain = _CENTRE_GAIN * heading_rate_max
    most = _ALONG_FRACTION * speed
    along = ahead + limited(gain * (off_north * cos_m + off_east * sin_m), most)
    gain *= min(1.0, max(_SLOW_GAIN_MIN, moving / (_SLOW * speed)))
    most = _ACROSS_FRACTION * max(moving, _SPEED_RATIO_MIN * speed)
    across = limited(gain * (off_east * cos_m - off_north * sin_m), most)
    turned = math.atan2(across, max(along, _SPEED_RATIO_MIN * speed))
    return math.atan2(sin_m, cos_m) + turned, along / math.cos(turned) / speed


def _ahead(
    centre: MovingCentre, north: float, east: float, speed: float
) -> tuple[float, float, float, float]:
    """Return the direction (north, east) in which an orbit goes on whose centre has some velocity
    [m/s].

    Also return the speed of whoever gives that direction, and that of the centre along it [m/s]. A
    centre that recedes faster than its vessel moves reverses its motion: then the direction is the
    vessel's, and the orbit backs away. To turn it round would take it far off.
    """
    cos_a, sin_a = math.cos(centre.axis), math.sin(centre.axis)
    vessel_north, vessel_east = north - centre.receding * cos_a, east - centre.receding * sin_a
    if north * vessel_north + east * vessel_east >= 0.0:
        moving = math.hypot(north, east)
        if moving > _STILL * speed:
            return north / moving, east / moving, moving, moving
    else:
        moving = math.hypot(vessel_north, vessel_east)
        if moving > _STILL * speed:
            cos_m, sin_m = vessel_north / moving, vessel_east / moving
            return cos_m, sin_m, moving, north * cos_m + east * sin_m
    return -cos_a, -sin_a, moving, -(north * cos_a + east * sin_a)


def _followed(centre: MovingCentre, speed: float) -> tuple[float, float]:
    """Return the velocity of a centre, of a slow one without most of a small unsteady swing, north
    and east [m/s].
    """
    slow = centre.speed_ratio / _SLOW
    if slow >= 1.0:
        return centre.velocity_north, centre.velocity_east
    unsteady = centre.swing - centre.steady_swing
    followed = max(slow * slow, unsteady * unsteady / (unsteady * unsteady + (_SWING * speed) ** 2))
    left_out = (1.0 - followed) * unsteady
    return centre.velocity_north + left_out * math.sin(
        centre.axis
    ), centre.velocity_east - left_out * math.cos(centre.axis)
