"""Ships that are known from their reports: the measured one, its plume, and the other ships."""

import bisect
import math
from collections.abc import Callable
from typing import NamedTuple

from gnc.estimation.antenna import AntennaReport, at_funnel
from gnc.estimation.traffic import OtherVessel, Traffic
from gnc.estimation.vessel import VesselLimits, VesselReport
from scenarios.world.ais.track import AT_THE_FUNNEL
from scenarios.world.traffic import OtherShip

KNOWN_WITHIN = 10_000.0
"""Largest distance from the vehicle of another ship that is taken in [m]."""


_TURN_TIME = 20.0
"""Least time over which a rate of turn is averaged [s]: headings are in whole degrees."""


class Seen(NamedTuple):
    """A ship as seen from another one.

    Attributes
    ----------
    north, east : of it from there [m]
    velocity_north, velocity_east : over the ground [m/s]
    radius : kept from it [m]
    """

    north: float
    east: float
    velocity_north: float
    velocity_east: float
    radius: float


class Antenna:
    """A ship's antenna, whose place it reports, seen from its funnel, from which the plume trails.

    Parameters
    ----------
    offset : of the antenna, ahead of the funnel and to starboard of it [m]
    """

    def __init__(self, offset: tuple[float, float]) -> None:
        self._offset = offset
        self._bows: list[tuple[float, float]] = []

    def funnel(self, report: VesselReport, bow: float) -> VesselReport:
        """Return a report of the antenna as one of the funnel.

        The ship turns at the mean rate since its report of ``_TURN_TIME`` ago.

        Parameters
        ----------
        report, bow : of the antenna, and the direction of the bow [rad]; in the order of time
        """
        if self._offset == AT_THE_FUNNEL:
            return report
        self._bows.append((report.time, bow))
        early = [of for of in self._bows if of[0] <= report.time - _TURN_TIME]
        before, bow_before = early[-1] if early else self._bows[0]
        since = report.time - before
        rate = math.remainder(bow - bow_before, math.tau) / since if since > 0.0 else 0.0
        return at_funnel(AntennaReport(report, bow, rate), self._offset)


class ReceivedVessel:
    """A vessel's track from its reports, by dead reckoning from the last one."""

    manoeuvres_end = math.nan

    def __init__(self) -> None:
        self._reports: list[VesselReport] = []
        self._times: list[float] = []
        self._courses: list[float] = []

    def report(self, report: VesselReport) -> None:
        """Add a report, which is later than all earlier ones."""
        course = math.atan2(report.velocity_east, report.velocity_north)
        if self._courses:
            last = self._courses[-1]
            course = last + math.remainder(course - last, math.tau)
        self._reports.append(report)
        self._times.append(report.time)
        self._courses.append(course)

    def _last(self, time: float) -> int:
        return max(0, bisect.bisect_right(self._times, time) - 1)

    def motion(self, time: float) -> tuple[float, float, float, float]:
        """Return north, east [m] and their rates [m/s] at a time [s]."""
        if not self._reports:
            return 0.0, 0.0, 0.0, 0.0
        of = self._reports[self._last(time)]
        since = time - of.time
        return (
            of.north + since * of.velocity_north,
            of.east + since * of.velocity_east,
            of.velocity_north,
            of.velocity_east,
        )

    def course(self, time: float) -> float:
        """Return the course [rad]."""
        return self._courses[self._last(time)] if self._courses else 0.0


class ReceivedPlume:
    """The axis of the plume behind a vessel that is known from reports, in the estimated wind.

    Parameters
    ----------
    vessel : from its reports
    heading : of the plume from the bow, where it does not trail with the wind [rad]; None where it
        does
    """

    def __init__(self, vessel: ReceivedVessel, heading: float | None) -> None:
        self._vessel, self._heading = vessel, heading
        self.wind: Callable[[], tuple[float, float]] = lambda: (0.0, 0.0)
        self._axis = 0.0

    def axis(self, time: float) -> float:
        """Return the course along which the plume trails [rad]."""
        if self._heading is not None:
            return self._vessel.course(time) + self._heading
        _, _, v_north, v_east = self._vessel.motion(time)
        wind_north, wind_east = self.wind()
        axis = math.atan2(wind_east - v_east, wind_north - v_north)
        self._axis += math.remainder(axis - self._axis, math.tau)
        return self._axis


class OtherShips:
    """The ships other than the measured one, which become known by their first reports.

    Parameters
    ----------
    radius : kept from each of them [m]
    limits : of their motion and their reports

    Attributes
    ----------
    ships : known so far
    reports : of each of them so far, in the same order
    """

    def __init__(self, radius: float, limits: VesselLimits) -> None:
        self._radius, self._limits = radius, limits
        self.ships: list[OtherShip] = []
        self.reports: list[list[VesselReport]] = []
        self._tracks: list[ReceivedVessel] = []
        self._numbers: dict[int, int] = {}
        self._traffic: Traffic | None = None

    @property
    def vessels(self) -> tuple[OtherVessel, ...]:
        """The guidance's knowledge of each of them before its reports."""
        return tuple(map(self._vessel, self.ships))

    def _vessel(self, ship: OtherShip) -> OtherVessel:
        return OtherVessel(name=ship.name, radius=ship.radius, limits=self._limits)

    def report(self, mmsi: int, report: VesselReport, own: tuple[float, float]) -> None:
        """Add a report of a ship; a ship that is not known yet has to be within ``KNOWN_WITHIN`` of
        the vehicle.

        Parameters
        ----------
        mmsi, report : of the ship
        own : place of the vehicle, north and east [m]
        """
        if mmsi not in self._numbers:
            if math.hypot(report.north - own[0], report.east - own[1]) > KNOWN_WITHIN:
                return
            self._add(mmsi, report.time)
        number = self._numbers[mmsi]
        self._tracks[number].report(report)
        self.reports[number].append(report)
        if self._traffic is not None:
            self._traffic.report(number, report)

    def _add(self, mmsi: int, time: float) -> None:
        """Add a ship that becomes known at a time [s]."""
        self._numbers[mmsi] = len(self.ships)
        self._tracks.append(ReceivedVessel())
        ship = OtherShip(
            name=f"MMSI_{mmsi}",
            radius=self._radius,
            track=self._tracks[-1],
            begins=time,
            ends=math.inf,
            key=f"AIS of MMSI {mmsi}",
        )
        self.ships.append(ship)
        self.reports.append([])
        if self._traffic is not None:
            self._traffic.add(self._vessel(ship))

    def pass_on_to(self, traffic: Traffic) -> None:
        """Pass all present and later reports on to a guidance without any of these ships."""
        self._traffic = traffic
        for number, vessel in enumerate(self.vessels):
            traffic.add(vessel)
            for report in self.reports[number]:
                traffic.report(number, report)

    def seen(self, time: float, place: tuple[float, float]) -> list[Seen]:
        """Return the ships that are near a place [m] at a time [s], as seen from it."""
        found = []
        for ship in self.ships:
            north, east, v_north, v_east = ship.track.motion(time)
            x, y = north - place[0], east - place[1]
            if math.hypot(x, y) <= KNOWN_WITHIN:
                found.append(Seen(x, y, v_north, v_east, ship.radius))
        return found
