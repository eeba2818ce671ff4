"""How far from the vessel an orbit has to lie for the keep-out guard not to act on it."""

import itertools
import math
from collections.abc import Callable

import numpy as np

from gnc.estimation.error_budget import WindErrorByGusts
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import Tube
from gnc.guard.guard import GuardParameters, HeadingRateFilter
from gnc.mission.standoff import CirclePoint
from gnc.reference.reference import Orbit

_PHASES = 24
"""Points of half an orbit from which a turn away is predicted; the other half is its mirror image,
or has as many [-].
"""

ASTERN = (-1.0, 0.0)
"""Direction of a plume straight astern, ahead of the vessel and to its right [-]."""

_ALIGNED = 1e-9
"""Part to the right up to which a direction counts as along the vessel's course: then half an orbit
tells it all [-].
"""

_FAR = 3.0
"""Distance at which clearances are found first, over the radius to be kept [-]."""


def orbit_distance(
    guard: GuardParameters,
    vessel: Tube,
    orbit: Orbit,
    direction: tuple[float, float] = ASTERN,
    *,
    wind: WindErrorByGusts | None = None,
) -> float:
    """Return the smallest distance of an orbit from the vessel for which a turn away is always left
    to the guard [m].

    It is that of its centre less its half-width along.

    Parameters
    ----------
    guard : its parameters
    vessel : where it may be, as large as that becomes
    orbit : about a centre of oscillation
    direction : of that centre from the vessel, a unit vector, ahead and to the right [-]
    wind : error of the estimated wind by turbulence
    """
    ahead, right = direction
    phases = _PHASES if orbit.symmetric and abs(right) < _ALIGNED else 2 * _PHASES
    time = orbit.period * (np.arange(phases) + 0.5) / (2.0 * _PHASES)
    piece = 1e-3 * orbit.period
    places = [orbit.offset(time + i * piece) for i in range(3)]
    mean = orbit.nu * orbit.speed
    courses = [
        np.arctan2((y1 - y0) / piece, (x1 - x0) / piece + mean)
        for (x0, y0), (x1, y1) in itertools.pairwise(places)
    ]
    rates = (courses[1] - courses[0]) / piece
    along, _ = orbit.half_widths()
    points = np.column_stack([*places[0], courses[0], rates]).tolist()

    def motions(distance: float) -> list[AirMotion]:
        return [
            AirMotion(
                ground_north=x + ahead * distance + ahead * along,
                ground_east=y + right * distance + right * along,
                course=course,
                heading_rate=rate,
                wind_by_gusts=wind,
            )
            for x, y, course, rate in points
        ]

    return _distance(guard, vessel, motions, orbit.speed, mean)


def circle_distance(
    guard: GuardParameters,
    vessel: Tube,
    speed: float,
    drift: float,
    *,
    wind: WindErrorByGusts | None = None,
) -> float:
    """Return the smallest radius of a circle about the vessel on which a turn away is always left
    to the guard [m].

    Parameters
    ----------
    guard : its parameters
    vessel : where it may be, as large as that becomes
    speed, drift : of the vehicle and of the vessel through the air [m/s]
    wind : error of the estimated wind by turbulence
    """
    point = CirclePoint(speed)

    def motions(radius: float) -> list[AirMotion]:
        found = []
        for bearing in 2.0 * np.pi * (np.arange(2 * _PHASES) + 0.5) / (2 * _PHASES):
            place = radius * float(np.cos(bearing)), radius * float(np.sin(bearing))
            point.place((0.0, 0.0), (drift, 0.0), place, radius)
            found.append(
                AirMotion(
                    ground_north=place[0],
                    ground_east=place[1],
                    course=point.course,
                    heading_rate=point.heading_rate,
                    wind_by_gusts=wind,
                )
            )
        return found

    return _distance(guard, vessel, motions, speed, drift)


def _distance(
    guard: GuardParameters,
    vessel: Tube,
    motions: Callable[[float], list[AirMotion]],
    speed: float,
    drift: float,
) -> float:
    """Return the distance at which the nearest of the motions that belong to it leaves the guard
    nothing to do [m].
    """
    keeping = HeadingRateFilter(guard)
    disc = vessel._replace(time=0.0, north=0.0, east=0.0, velocity_north=drift, velocity_east=0.0)
    distance = _FAR * (guard.radius + vessel.radius)
    for _ in range(2):
        # Clearances change as the distance does, but for the curvature of a disc: what is found is
        # up to 0.3 m too large.
        least = math.inf
        for motion in motions(distance):
            least = min(least, keeping.clearance(0.0, motion, (disc,), speed, enough=least))
        distance -= least
    return distance
