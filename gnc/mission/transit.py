"""The way to a place beside a moving disc, round the disc where it stands in the way.

Seen from the disc, the way is a straight line to the target or, where that is blocked, a tangent of
a circle about the disc, on the side that is shorter. The vehicle heads so that its velocity
relative to the disc lies along that way.
"""

import math

from gnc.numeric import limited, wrap

_OUTWARD = 0.6
"""How far the way leans outwards for a vehicle a turn radius or more inside of the circle by which
to go round [rad].

By less, a vehicle near the keep-out area would go along it all the way round, and the guard would
turn it away all the time.
"""


class Transit:
    """Courses to a target, with the memory of the side on which the disc is being passed.

    Parameters
    ----------
    turn_radius : of the vehicle; what its turns cost when a side is chosen [m]

    Attributes
    ----------
    side : 1 while the disc is passed clockwise as seen from above, -1 the other way, 0 while
        nothing is in the way
    """

    __slots__ = ("_turn_radius", "side")

    def __init__(self, turn_radius: float) -> None:
        self._turn_radius = turn_radius
        self.side = 0

    def course(
        self,
        x: float,
        y: float,
        target_x: float,
        target_y: float,
        *,
        blocked_radius: float,
        round_radius: float,
        velocity_north: float,
        velocity_east: float,
        course: float,
        speed: float,
    ) -> float:
        """Return the course to fly [rad].

        Parameters
        ----------
        x, y : of the vehicle, north and east of the disc's centre [m]
        target_x, target_y : of the target, which moves with the disc [m]
        blocked_radius : a straight way that comes closer than this is blocked; below the target's
            distance [m]
        round_radius : of the circle by which to go round [m]
        velocity_north, velocity_east : of the disc in the frame in which the vehicle flies at
            ``speed`` [m/s]
        course, speed : of the vehicle [rad, m/s]; faster than the disc
        """
        if _way_is_clear(x, y, target_x, target_y, blocked_radius):
            self.side = 0
            way = math.atan2(target_y - y, target_x - x)
        else:
            bearing = math.atan2(y, x)
            distance = math.hypot(x, y)
            if distance > round_radius:
                lean = math.asin(round_radius / distance)
            else:
                lean = 0.5 * math.pi + _OUTWARD * min(
                    1.0, (round_radius - distance) / self._turn_radius
                )
            if self.side == 0:
                self.side = self._shorter_side(
                    bearing, lean, math.atan2(target_y, target_x), course, round_radius
                )
            way = bearing + math.pi - self.side * lean
        across = velocity_east * math.cos(way) - velocity_north * math.sin(way)
        return way + math.asin(limited(across / speed, 1.0))

    def _shorter_side(
        self, bearing: float, lean: float, target_bearing: float, course: float, radius: float
    ) -> int:
        clockwise = (target_bearing - bearing) % (2.0 * math.pi)
        lengths = {}
        for side, angle in ((1, clockwise), (-1, 2.0 * math.pi - clockwise)):
            turn = abs(wrap(bearing + math.pi - side * lean - course))
            lengths[side] = radius * angle + 2.0 * self._turn_radius * turn
        return 1 if lengths[1] <= lengths[-1] else -1


def _way_is_clear(x: float, y: float, target_x: float, target_y: float, radius: float) -> bool:
    """Return whether a straight way never comes closer to the origin than ``radius``, but for
    leaving from there outwards.
    """
    to_x, to_y = target_x - x, target_y - y
    inward = -(x * to_x + y * to_y)
    if inward <= 0.0:
        return True
    share = min(1.0, inward / (to_x * to_x + to_y * to_y))
    return math.hypot(x + share * to_x, y + share * to_y) >= radius
