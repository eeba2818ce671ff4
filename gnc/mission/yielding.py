"""Gives way to other vessels before the guard has to act.

While the reference is tracked, the vehicle stays within a circle about the centre of oscillation,
the orbit's **footprint**, which moves along with the measured vessel. On its way to the orbit, it
flies a course. The mission gives way where another vessel's area is about to enter the footprint or
lies on that course. It then flies the course nearest to the wanted one among all courses on which a
straight flight keeps clear of all vessels, including the measured one. These are the courses
outside of the velocity obstacles (P. Fiorini, Z. Shiller, "Motion planning in dynamic environments
using velocity obstacles", Int. J. Robotics Research 17:760, 1998).

The guard keeps the vehicle out on any of these courses.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gnc.estimation.navigation import OwnMotion
from gnc.estimation.traffic import KnownVessel
from gnc.estimation.vessel import TargetMotion
from gnc.mission.mission import LEAVING, TRACK, Mode, OrbitStatus, Order
from gnc.mission.way import COURSE_GAIN, course_ahead
from gnc.numeric import limited, wrap

HORIZON = 60.0
"""Time for which courses are judged, and for which vessels are near [s]."""

_SOON = 30.0
"""The mission yields if an area enters the footprint, or the way, within this time [s]."""

_CLEAR = 10.0
"""Additional time for which the area has to stay clear before the mission continues [s]."""

_COURSES = 36
"""Number of courses that are judged [-]."""

_OTHER_SIDE = 0.5
"""Cost of a change of the side to which the vehicle leaves the wanted course [rad]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class YieldParameters:
    """Parameters of giving way.

    Attributes
    ----------
    footprint : radius of the circle about the centre of oscillation in which the orbit lies [m]
    room : distance kept in addition to the radius of a vessel, so that the guard does not act [m]
    measured_radius : distance kept from the measured vessel while giving way [m]
    """

    footprint: float
    room: float
    measured_radius: float


class Area:
    """A disc about a vessel that moves and grows, relative to a place.

    Attributes
    ----------
    x, y : of its centre from there, north and east [m]
    velocity_north, velocity_east : of the vessel over the ground [m/s]
    radius, growth : [m, m/s]
    """

    def __init__(
        self,
        x: float,
        y: float,
        velocity_north: float,
        velocity_east: float,
        radius: float,
        growth: float,
    ) -> None:
        self.x = x
        self.y = y
        self.velocity_north = velocity_north
        self.velocity_east = velocity_east
        self.radius = radius
        self.growth = growth

    def clearance(self, velocity_north: float, velocity_east: float, duration: float) -> float:
        """Return the least distance from the area in a straight flight from the place [m].

        It is negative within the area. Where the area recedes, it is the distance at the start.

        Parameters
        ----------
        velocity_north, velocity_east : over the ground [m/s]
        duration : time of that flight [s]
        """
        north = self.velocity_north - velocity_north
        east = self.velocity_east - velocity_east
        square = north * north + east * east
        closing = -(self.x * north + self.y * east)
        nearest_at = 0.0
        if closing > 0.0:
            nearest_at = min(closing / square, duration)
        distance = math.hypot(self.x + north * nearest_at, self.y + east * nearest_at)
        return distance - self.radius - self.growth * nearest_at


class Yielding:
    """Replaces the orders of a mission where these lead too near to other vessels.

    Parameters
    ----------
    parameters : of giving way
    heading_rate_max, lag : of the vehicle [rad/s, s]

    Attributes
    ----------
    to : name of the vessel to which the mission yields; empty while it does not yield
    """

    def __init__(self, parameters: YieldParameters, *, heading_rate_max: float, lag: float) -> None:
        self._parameters = parameters
        self._heading_rate_max = heading_rate_max
        self._lag = lag
        self.to = ""
        self._course = 0.0
        self._side = 0.0

    def order(
        self,
        order: Order,
        time: float,
        own: OwnMotion,
        target: TargetMotion,
        orbit: OrbitStatus | None,
        near: Sequence[KnownVessel],
        last_command: float,
        *,
        renew: bool,
    ) -> Order:
        """Return the order of the mission, or one that gives way.

        Parameters
        ----------
        order : of the mission
        time : now [s]
        own, target : motion of the vehicle and of the vessel that is measured
        orbit : of the reference
        near : other vessels
        last_command : of the heading rate [rad/s]
        renew : whether to decide anew, or to keep the last decision
        """
        if renew:
            self._decide(order, time, own, target, orbit, near)
        if not self.to:
            return order
        turn = wrap(self._course - course_ahead(own, last_command, self._lag))
        command = limited(COURSE_GAIN * self._heading_rate_max * turn, self._heading_rate_max)
        mode = order.mode if order.mode in LEAVING else Mode.YIELDING
        return Order(command, order.airspeed, order.altitude, mode)

    def _decide(
        self,
        order: Order,
        time: float,
        own: OwnMotion,
        target: TargetMotion,
        orbit: OrbitStatus | None,
        near: Sequence[KnownVessel],
    ) -> None:
        """Decide whether to yield, and which course to fly."""
        if not near or orbit is None:
            self.to, self._side = "", 0.0
            return
        soon = _SOON + (_CLEAR if self.to else 0.0)
        areas = [self._area(vessel, time, own.ground_north, own.ground_east) for vessel in near]
        blocking: int | None = None
        if order.mode not in LEAVING and _is_near(own, target, orbit):
            blocking = self._entering(target, orbit, own, areas, soon)
        if blocking is None and order.heading_rate is TRACK:
            self.to, self._side = "", 0.0
            return
        wanted = self._wanted(order, own, target, orbit)
        if blocking is None:
            blocking = _in_the_way(wanted, own, areas, soon)
        if blocking is None:
            self.to, self._side = "", 0.0
            return
        self.to = near[blocking].name
        areas.append(
            Area(
                target.north - own.ground_north,
                target.east - own.ground_east,
                target.velocity_north,
                target.velocity_east,
                self._parameters.measured_radius,
                0.0,
            )
        )
        self._choose(wanted, own, areas)

    def _area(self, vessel: KnownVessel, time: float, north: float, east: float) -> Area:
        """Return the area about a vessel, relative to a place [s, m]."""
        disc = vessel.newest
        since = time - disc.time
        return Area(
            disc.north + disc.velocity_north * since - north,
            disc.east + disc.velocity_east * since - east,
            disc.velocity_north,
            disc.velocity_east,
            vessel.radius + disc.reach(since) + self._parameters.room,
            disc.growth + disc.acceleration * since,
        )

    def _wanted(
        self, order: Order, own: OwnMotion, target: TargetMotion, orbit: OrbitStatus
    ) -> float:
        """Return the course that leads to the centre of oscillation, or away from the measured
        vessel [rad].
        """
        north, east = target.north - own.ground_north, target.east - own.ground_east
        if order.mode in LEAVING:
            return math.atan2(-east, -north)
        way = math.atan2(east + orbit.centre.y, north + orbit.centre.x)
        drift_north = target.velocity_north - own.wind_north
        drift_east = target.velocity_east - own.wind_east
        across = drift_east * math.cos(way) - drift_north * math.sin(way)
        return way + math.asin(limited(across / max(own.speed, 1.0), 1.0))

    def _entering(
        self,
        target: TargetMotion,
        orbit: OrbitStatus,
        own: OwnMotion,
        areas: Sequence[Area],
        soon: float,
    ) -> int | None:
        """Return the number of the area that enters the orbit's footprint farthest, or None."""
        to_north = target.north + orbit.centre.x - own.ground_north
        to_east = target.east + orbit.centre.y - own.ground_east
        entering, least = None, self._parameters.footprint
        for number, area in enumerate(areas):
            about_centre = Area(
                area.x - to_north,
                area.y - to_east,
                area.velocity_north,
                area.velocity_east,
                area.radius,
                area.growth,
            )
            clearance = about_centre.clearance(target.velocity_north, target.velocity_east, soon)
            if clearance < least:
                entering, least = number, clearance
        return entering

    def _choose(self, wanted: float, own: OwnMotion, areas: Sequence[Area]) -> None:
        """Return the course nearest to the wanted one that keeps clear, or the one with the largest
        clearance [rad].
        """
        best, least_cost = wanted, math.inf
        clearest, most = wanted, -math.inf
        for number in range(_COURSES):
            off = (number - _COURSES // 2) * (2.0 * math.pi / _COURSES)
            clearance = _clearance(wanted + off, own, areas, HORIZON)
            if clearance > most:
                clearest, most = wanted + off, clearance
            cost = abs(off) + (_OTHER_SIDE if off * self._side < 0.0 else 0.0)
            if clearance >= 0.0 and cost < least_cost:
                best, least_cost = wanted + off, cost
        self._course = best if least_cost < math.inf else clearest
        off = wrap(self._course - wanted)
        self._side = math.copysign(1.0, off) if off else self._side


def _is_near(own: OwnMotion, target: TargetMotion, orbit: OrbitStatus) -> bool:
    """Return whether the vehicle may be on its orbit within the horizon."""
    north = target.north + orbit.centre.x - own.ground_north
    east = target.east + orbit.centre.y - own.ground_east
    return math.hypot(north, east) < HORIZON * own.speed


def _clearance(course: float, own: OwnMotion, areas: Sequence[Area], duration: float) -> float:
    """Return the least distance of a straight flight from areas [m], on a course [rad] for a time
    [s].
    """
    north = own.speed * math.cos(course) + own.wind_north
    east = own.speed * math.sin(course) + own.wind_east
    return min(area.clearance(north, east, duration) for area in areas)


def _in_the_way(wanted: float, own: OwnMotion, areas: Sequence[Area], soon: float) -> int | None:
    """Return the number of the area that blocks the wanted course [rad] most, or else the course
    that is flown; None where neither leads into an area.
    """
    blocking, least = None, 0.0
    for number, area in enumerate(areas):
        for course in (wanted, own.course):
            clearance = _clearance(course, own, (area,), soon)
            if clearance < least:
                blocking, least = number, clearance
    return blocking
