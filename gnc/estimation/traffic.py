"""The known vessels other than the measured one: which of them are near, and where each of them may
be.

Each vessel has a radius, and discs that it cannot have left, made of its reports
(``gnc.estimation.vessel``). Most vessels are far away. So discs are made only of those that can
come near within the **horizon**: a vessel at a distance d, with the radius to keep r and with a
disc that reaches R after the horizon T, is out of reach for at least

    (d - r - R - c T) / c    with the closing speed    c = V_max + |w| + |v|,

from the largest airspeed, the wind and the vessel's speed, and is not looked at before that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import ReachableSet, Tube, VesselLimits, VesselReport, discs_of

_LOOKED_AT_AFTER = 10.0
"""Time after which a vessel is looked at again, however far off it is [s]: its disc grows, and the
estimated wind changes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherVessel:
    """A known vessel other than the measured one.

    Attributes
    ----------
    name : in messages and tables
    radius : that the vehicle's path must keep from it [m]
    limits : of its motion and of its reports
    """

    name: str
    radius: float
    limits: VesselLimits


class KnownVessel:
    """The knowledge of another vessel in flight.

    Attributes
    ----------
    name, radius : of ``OtherVessel`` [m]
    newest : disc by acceleration of its newest report, when it was looked at last
    near : whether it may come near within the horizon
    due : when it is looked at next, while it is not near [s]
    """

    def __init__(self, parameters: OtherVessel) -> None:
        self.name = parameters.name
        self.radius = parameters.radius
        self.newest = Tube(-math.inf, 0.0, 0.0, 0.0, 0.0)
        self.near = False
        self.due = -math.inf
        self.last_report = -math.inf
        self._limits = parameters.limits
        self._reach = ReachableSet(parameters.limits)
        # Discs of the last plan: the guard looks at a vessel less often than there are plans.
        self._reports: Sequence[VesselReport] = ()
        self._tubes: Sequence[Tube] | None = None

    @property
    def tubes(self) -> Sequence[Tube]:
        """Discs that contain it from the last plan on; the newest first."""
        tubes = self._tubes
        if tubes is None:
            tubes = self._tubes = discs_of(self._reports, self._limits, self.newest.time)
        return tubes

    def report(self, report: VesselReport) -> None:
        """Take in a report, which may be older than others."""
        self._reach.report(report)
        self.last_report = max(self.last_report, report.time)

    def look(self, time: float) -> Tube:
        """Return its newest disc at ``time`` [s]; ``tubes`` are of the same reports."""
        self.newest = self._reach.newest(time)
        self._reports = self._reach.reports
        self._tubes = None
        return self.newest


class Traffic:
    """The other vessels of a flight.

    Parameters
    ----------
    vessels : that are known, or may become known
    speed_max : largest airspeed of the vehicle [m/s]
    horizon : time within which a vessel counts as near [s]

    Attributes
    ----------
    vessels : in the order of the parameters
    near : those of them that may come near within the horizon
    """

    def __init__(self, vessels: Sequence[OtherVessel], *, speed_max: float, horizon: float) -> None:
        self.vessels = [KnownVessel(vessel) for vessel in vessels]
        self.near: list[KnownVessel] = []
        self._speed_max = speed_max
        self._horizon = horizon
        # Time at which vessels that are not near are looked at next [s].
        self._due = -math.inf

    def add(self, vessel: OtherVessel) -> int:
        """Take in a vessel that becomes known in flight; return its number."""
        self.vessels.append(KnownVessel(vessel))
        return len(self.vessels) - 1

    def is_due(self, number: int, time: float) -> bool:
        """Return whether a report of a vessel is of use at a time [s]: it is near, or is due for a
        look.
        """
        vessel = self.vessels[number]
        return vessel.near or vessel.due <= time

    def report(self, number: int, report: VesselReport) -> None:
        """Take in a report of a vessel, by its number."""
        vessel = self.vessels[number]
        if vessel.last_report == -math.inf:
            # The vessel was not known before.
            vessel.due = self._due = -math.inf
        vessel.report(report)

    def update(self, time: float, own: AirMotion) -> None:
        """Find the vessels that are near, and make their discs at ``time`` [s]."""
        vessels = self.near
        if time >= self._due:
            vessels = self.vessels
            self._due = math.inf
        near = []
        for vessel in vessels:
            if vessel.last_report == -math.inf:
                continue
            if vessel.near or vessel.due <= time:
                out_of_reach = self._out_of_reach(vessel.radius, vessel.look(time), own)
                vessel.near = out_of_reach <= 0.0
                if vessel.near:
                    near.append(vessel)
                    continue
                vessel.due = time + min(out_of_reach, _LOOKED_AT_AFTER)
            self._due = min(self._due, vessel.due)
        self.near = near

    def _out_of_reach(self, radius: float, disc: Tube, own: AirMotion) -> float:
        """Return the time for which a vessel stays out of reach [s], from its radius to keep [m]
        and its disc; below 0 if it is in reach.
        """
        horizon = self._horizon
        closing = (
            self._speed_max
            + math.hypot(own.wind_north, own.wind_east)
            + math.hypot(disc.velocity_north, disc.velocity_east)
        )
        distance = math.hypot(own.ground_north - disc.north, own.ground_east - disc.east)
        reach = radius + disc.reach(horizon + _LOOKED_AT_AFTER) + closing * horizon
        return (distance - reach) / closing
