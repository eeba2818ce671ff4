"""Ways between ships: interception of a ship in wind, exactly, and the way round the keep-out areas
of the others.

A place is a complex number, north + i east [m], and so is a velocity [m/s]. Ships and wind are
steady, so that with respect to the air every ship, and the UAV on every leg, moves on a straight
line.
"""

import heapq
import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_CORNERS = 8
"""Number of corners of the polygon by which a ship is avoided."""

_ROOM = 1.001
"""Size of that polygon, over that of the one whose sides touch the circle to keep."""

_TOUCHES = 1e-6
"""Distance by which rounding may make a leg appear nearer [m]."""


@dataclass(frozen=True, slots=True)
class Mover:
    """A ship, or a place that moves along with one.

    Attributes
    ----------
    place : over the ground at time 0 [m]
    velocity : over the ground [m/s]
    """

    place: complex
    velocity: complex

    def at(self, time: float) -> complex:
        """Return its place at a time [s]."""
        return self.place + self.velocity * time


@dataclass(frozen=True, slots=True)
class Air:
    """The air of the UAV.

    Attributes
    ----------
    wind : velocity of the air [m/s]
    speed : of the UAV through it, V_r [m/s]
    """

    wind: complex
    speed: float


@dataclass(frozen=True, slots=True)
class Leg:
    """A straight way.

    Attributes
    ----------
    begins, ends : [s]
    start, end : over the ground [m]
    """

    begins: float
    ends: float
    start: complex
    end: complex

    @property
    def velocity(self) -> complex:
        """Return the velocity over the ground [m/s]; 0 for a leg without length."""
        return (
            (self.end - self.start) / (self.ends - self.begins) if self.ends > self.begins else 0j
        )

    def course(self, air: Air) -> float:
        """Return the course through the air [rad]."""
        through = self.velocity - air.wind
        return math.atan2(through.imag, through.real)

    def distance(self, other: Mover) -> float:
        """Return the least distance to a ship on the way [m]."""
        return least_distance(
            self.start - other.at(self.begins),
            self.velocity - other.velocity,
            self.ends - self.begins,
        )


def least_distance(apart: complex, velocity: complex, duration: float) -> float:
    """Return the least distance of two points that are ``apart`` [m] and have a steady relative
    velocity [m/s] for a duration [s].
    """
    square = abs(velocity) ** 2
    nearest = -(apart.real * velocity.real + apart.imag * velocity.imag) / square if square else 0.0
    return abs(apart + velocity * min(max(nearest, 0.0), duration))


def time_to_reach(apart: complex, velocity: complex, speed: float, radius: float = 0.0) -> float:
    """Return the least time in which a pursuer comes within a radius of a target [s]; infinite if
    it never does.

    It is the first root of |p + v t| = V t + R: the pursuer flies straight to where the target will
    be, and R of that way remains.

    Parameters
    ----------
    apart, velocity : place of the target as seen from the pursuer [m], and its velocity through the
        air [m/s]: p and v
    speed : of the pursuer through the air [m/s]: V
    radius : [m]: R
    """
    outside = abs(apart) ** 2 - radius**2
    if outside <= 0.0:
        return 0.0
    closing = speed**2 - abs(velocity) ** 2
    half = apart.real * velocity.real + apart.imag * velocity.imag - speed * radius
    square = half**2 + closing * outside
    # The root in a form that loses no digits, and that holds for targets as fast as the pursuer or
    # faster, too.
    divisor = math.sqrt(square) - half if square >= 0.0 else 0.0
    return outside / divisor if divisor > 0.0 else math.inf


def straight_leg(start: complex, time: float, goal: Mover, radius: float, air: Air) -> Leg | None:
    """Return the fastest way from a place and a time [m, s] to within a radius [m] of a goal; None
    if it cannot be reached.
    """
    apart, drift = goal.at(time) - start, goal.velocity - air.wind
    takes = time_to_reach(apart, drift, air.speed, radius)
    if takes == math.inf:
        return None
    if not takes:
        return Leg(time, time, start, start)
    way = apart + drift * takes
    return Leg(time, time + takes, start, start + (way / abs(way) * air.speed + air.wind) * takes)


def keeps_clear(leg: Leg, ships: Iterable[Mover], distance: float) -> bool:
    """Return whether a leg keeps a distance from ships [m]; it must not approach a ship that is
    nearer at its start.
    """
    return all(
        leg.distance(ship) >= min(distance, abs(leg.start - ship.at(leg.begins))) - _TOUCHES
        for ship in ships
    )


def route(
    start: complex,
    time: float,
    goal: Mover,
    radius: float,
    *,
    air: Air,
    ships: Sequence[Mover],
    clearance: float,
) -> Sequence[Leg] | None:
    """Return the way to within a radius of a goal that keeps clear of ships: straight, or by
    corners round them.

    The corners move along with the ships. Of all ways by corners it is the quickest. Dijkstra's
    algorithm finds it, because a later departure never arrives earlier: the UAV is faster than
    every corner.

    Parameters
    ----------
    start, time : place and time of the departure [m, s]
    goal, radius : target, and distance from it that has to be reached [m]
    air : wind and airspeed
    ships, clearance : ships to keep clear of, and the distance to keep [m]

    Returns
    -------
    legs one after the other; empty without such a way
    """
    straight = straight_leg(start, time, goal, radius, air)
    if straight is None or keeps_clear(straight, ships, clearance):
        return None if straight is None else [straight]
    targets = [(corner, 0.0) for ship in ships for corner in _corners(ship, clearance)]
    targets.append((goal, radius))
    order = itertools.count()
    waiting: list[tuple[float, int, int, list[Leg]]] = [(time, next(order), -1, [])]
    reached: set[int] = set()
    while waiting:
        now, _, at, legs = heapq.heappop(waiting)
        if at in reached:
            continue
        reached.add(at)
        if at == len(targets) - 1:
            return legs
        place = legs[-1].end if legs else start
        for i, (target, near) in enumerate(targets):
            leg = None if i in reached else straight_leg(place, now, target, near, air)
            if leg is not None and keeps_clear(leg, ships, clearance):
                heapq.heappush(waiting, (leg.ends, next(order), i, [*legs, leg]))
    return None


def _corners(ship: Mover, distance: float) -> list[Mover]:
    size = _ROOM * distance / math.cos(math.pi / _CORNERS)
    angles = [2.0 * math.pi * i / _CORNERS for i in range(_CORNERS)]
    return [
        Mover(ship.place + size * complex(math.cos(angle), math.sin(angle)), ship.velocity)
        for angle in angles
    ]


def nearest_on(time: Array, track: npt.NDArray[np.complex128], ship: Mover) -> float:
    """Return the least distance of a recorded track to a ship, shape (n,) each [s, m]."""
    return float(np.min(np.abs(track - (ship.place + ship.velocity * time))))
