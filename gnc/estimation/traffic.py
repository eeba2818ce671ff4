"""The other vessels that are known, besides the one that is measured: which of them are near, and
where each of them may be.

Each has a radius of its own, and discs of its own that she cannot have left, made of her own
reports (``gnc.estimation.vessel``). Most are far away. So discs are made only of those that vehicle
and vessel can bring near within the **horizon**: a vessel at a distance d, whose radius to keep is
r and whose disc reaches R after the horizon T, is out of reach for at least

    (d - r - R - c T) / c    with the closing speed    c = V_max + |w| + |v|,

of the largest airspeed, the wind and the vessel's speed, and is not looked at before that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import ReachableSet, Tube, VesselLimits, VesselReport

_LOOKED_AT_AFTER = 10.0
"""Time after which a vessel is looked at again, however far off she is [s]: her disc grows, and the
estimated wind changes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherVessel:
    """A vessel that is known, besides the one that is measured.

    Attributes
    ----------
    name : in messages and tables
    radius : that the vehicle's path must keep from her [m]
    limits : that she and her reports keep
    """

    name: str
    radius: float
    limits: VesselLimits


class KnownVessel:
    """What is known of such a vessel in flight.

    Attributes
    ----------
    name, radius : of ``OtherVessel`` [m]
    tubes : discs that contain her from the last plan on, while she is near; the newest first
    near : whether she may come near within the horizon
    due : when she is looked at next, while she is not near [s]
    """

    def __init__(self, parameters: OtherVessel) -> None:
        self.name = parameters.name
        self.radius = parameters.radius
        self.tubes: Sequence[Tube] = ()
        self.near = False
        self.due = -math.inf
        self.reach = ReachableSet(parameters.limits)
        self.last_report = -math.inf

    def report(self, report: VesselReport) -> None:
        """Take in a report, which may be older than others."""
        self.reach.report(report)
        self.last_report = max(self.last_report, report.time)


class Traffic:
    """The other vessels of a flight.

    Parameters
    ----------
    vessels : that are known, or may come to be
    speed_max : largest airspeed of the vehicle [m/s]
    horizon : within which a vessel counts as near [s]

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
        self._due = -math.inf

    def add(self, vessel: OtherVessel) -> int:
        """Take in a vessel that comes to be known in flight; return its number."""
        self.vessels.append(KnownVessel(vessel))
        return len(self.vessels) - 1

    def is_due(self, number: int, time: float) -> bool:
        """Return whether a report of a vessel is of use now: she is near, or is looked at [s]."""
        vessel = self.vessels[number]
        return vessel.near or vessel.due <= time

    def report(self, number: int, report: VesselReport) -> None:
        """Take in a report of a vessel, by her number."""
        vessel = self.vessels[number]
        if vessel.last_report == -math.inf:
            # She was not known before.
            vessel.due = self._due = -math.inf
        vessel.report(report)

    def update(self, time: float, own: AirMotion) -> None:
        """Find the vessels that are near, and make their discs at ``time`` [s]."""
        if not self.near and time < self._due:
            return
        near = []
        self._due = math.inf
        for vessel in self.vessels:
            if vessel.last_report > -math.inf and (vessel.near or vessel.due <= time):
                disc = vessel.reach.newest(time)
                out_of_reach = self._out_of_reach(vessel.radius, disc, own)
                vessel.near = out_of_reach <= 0.0
                if vessel.near:
                    vessel.tubes = vessel.reach.tubes(time)
                    near.append(vessel)
                    continue
                vessel.tubes = ()
                vessel.due = time + min(out_of_reach, _LOOKED_AT_AFTER)
            if vessel.last_report > -math.inf:
                self._due = min(self._due, vessel.due)
        self.near = near

    def _out_of_reach(self, radius: float, disc: Tube, own: AirMotion) -> float:
        """Return for how long a vessel stays out of reach [s], by her radius to keep [m] and her
        disc; below 0 where she does not.
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
