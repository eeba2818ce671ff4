"""How near a predicted turn comes to a disc: between two of its points, and if its speed changes
elsewhere than predicted.
"""

import math

Place = tuple[float, float, float, float, float]
"""x, y, course, the distance that is allowed for there [m], and the speed on the way there [m/s].
"""

Switch = tuple[float, float, float, float]
"""x, y, course, and by how much the vehicle has turned since the turn began [rad]."""

_REFINED = 3
"""Steps in which the closest approach between two points is found [-]: each squares the error of
the one before.
"""


def leads_away(
    x: float, y: float, cos: float, sin: float, way: float, north: float, east: float
) -> bool:
    """Return whether a vehicle flies away from a disc's centre, in the middle of its way and that
    of the disc [m].
    """
    return (x - 0.5 * north) * cos + (y - 0.5 * east) * sin + 0.5 * way > 0.0


def nearer_by_switch(
    side: float, radii: float, then: Switch, x: float, y: float, course: float
) -> float:
    """Return by how much nearer a turn comes that slows down a little before, or after, it is
    predicted to [m].

    A vehicle is predicted to slow down where it begins to fly away from the disc's centre. It comes
    nearest in another direction; seen in that, it began to fly away sooner, or later, by the course
    that lies between the two, if it turned as much.

    Parameters
    ----------
    side : of the turn
    radii : difference between those of the turn, fast and slow [m]
    then : where it was predicted to slow down
    x, y, course : where it is now
    """
    x_then, y_then, course_then, turned = then
    away = math.hypot(x, y)
    across, along = side * (x_then * y - y_then * x), x * x_then + y * y_then
    sooner = across < 0.0
    between = 0.5 * min(
        abs(math.atan2(across, along)),
        max(0.0, turned) if sooner else side * (course - course_then),
    )
    # Over that course the chords of the two circles differ.
    chord, middle = (
        2.0 * radii * math.sin(between),
        course_then + side * (-between if sooner else between),
    )
    shift = -chord if sooner else chord
    return max(0.0, away - math.hypot(x + shift * math.cos(middle), y + shift * math.sin(middle)))


def least_of_late(
    earlier: Place,
    late: Place,
    now: Place,
    velocity: tuple[float, float],
    duration: float,
    *,
    first: bool,
) -> float:
    """Return the least slack of late [m] at a point of a turn from which on it rises: before the
    last point, or since.

    Parameters
    ----------
    earlier, late, now : the last points
    velocity, duration : of the disc, north and east [m/s], and between points [s]
    first : whether the turn began at ``late``, and there is no earlier point
    """
    velocity_north, velocity_east = velocity
    x, y, course, allowed, _ = late
    speed = now[4]
    outwards = (speed * math.cos(course) - velocity_north) * x + (
        speed * math.sin(course) - velocity_east
    ) * y
    if outwards / math.hypot(x, y) <= (now[3] - allowed) / duration:
        return _least_between(late, now, velocity, duration)
    return (
        math.hypot(x, y) - allowed if first else _least_between(earlier, late, velocity, duration)
    )


def _least_between(
    begin: Place, end: Place, velocity: tuple[float, float], duration: float
) -> float:
    """Return the least slack between two points of a turn [m], which are so long apart [s].

    The path is the cubic through both places with the velocities there, which is true to 1e-6 turn
    radii. A disc may be smaller than the way between the points: so distances there tell little of
    the closest approach.
    """
    velocity_north, velocity_east = velocity
    (x, y, course, allowed, _), (x_end, y_end, course_end, allowed_end, speed) = begin, end
    north, east = duration * velocity_north, duration * velocity_east
    way = speed * duration
    x_1, y_1 = way * math.cos(course) - north, way * math.sin(course) - east
    x_then, y_then = way * math.cos(course_end) - north, way * math.sin(course_end) - east
    x_far, y_far, slope = x_end - x, y_end - y, allowed_end - allowed
    x_2, y_2 = 3.0 * x_far - 2.0 * x_1 - x_then, 3.0 * y_far - 2.0 * y_1 - y_then
    x_3, y_3 = x_1 + x_then - 2.0 * x_far, y_1 + y_then - 2.0 * y_far
    u = 0.5
    for _ in range(_REFINED):
        x_u, y_u = x + u * (x_1 + u * (x_2 + u * x_3)), y + u * (y_1 + u * (y_2 + u * y_3))
        x_rate, y_rate = (
            x_1 + u * (2.0 * x_2 + 3.0 * u * x_3),
            y_1 + u * (2.0 * y_2 + 3.0 * u * y_3),
        )
        # The square of the distance about there is square + 2 tilt du + bend du^2.
        square, tilt = x_u * x_u + y_u * y_u, x_u * x_rate + y_u * y_rate
        bend = (
            x_rate * x_rate
            + y_rate * y_rate
            + 2.0 * (x_u * (x_2 + 3.0 * u * x_3) + y_u * (y_2 + 3.0 * u * y_3))
        )
        room = bend - slope * slope
        if room <= 0.0:
            # What is allowed for grows faster than the distance ever will.
            return min(math.hypot(x, y) - allowed, math.hypot(x_end, y_end) - allowed_end)
        u += slope * math.sqrt(max(0.0, square - tilt * tilt / bend) / (room * bend)) - tilt / bend
        u = min(max(u, 0.0), 1.0)
    x_u, y_u = x + u * (x_1 + u * (x_2 + u * x_3)), y + u * (y_1 + u * (y_2 + u * y_3))
    return math.hypot(x_u, y_u) - allowed - slope * u
