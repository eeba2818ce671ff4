"""Where the vessel is taken to be, and how it moves: known exactly, or from its reports."""

import math
from collections.abc import Sequence
from typing import Protocol

from gnc.estimation.reachable_set import ReachableSet, Tube
from gnc.estimation.vessel_filter import VesselFilter, VesselReport

REPORTED_SCATTER = 0.03
"""What the estimated acceleration of a steady vessel scatters by, where its reports have errors
[m/s^2].
"""


class TargetMotion(Protocol):
    """The vessel's motion over the ground, updated once per guidance step.

    Attributes
    ----------
    north, east : [m]
    velocity_north, velocity_east : [m/s]
    acceleration_north, acceleration_east : when it was last planned, as much as is not the scatter
        of its reports [m/s^2]
    tubes : discs that contain it, from when it was last planned on, the one known best first
    """

    north: float
    east: float
    velocity_north: float
    velocity_east: float
    acceleration_north: float
    acceleration_east: float
    tubes: Sequence[Tube]

    def update(self, time: float, planning: bool) -> None:
        """Move on to ``time`` [s]; look anew at what is known of the vessel where the mission is
        ``planning``.
        """

    def age(self, time: float) -> float:
        """Return how old the last report is at ``time`` [s]."""


class SteadyTarget:
    """A vessel at constant velocity from the origin, known exactly; attributes as of
    ``TargetMotion``.

    Parameters
    ----------
    velocity_north, velocity_east : [m/s]
    """

    __slots__ = (
        "acceleration_east",
        "acceleration_north",
        "east",
        "north",
        "tubes",
        "velocity_east",
        "velocity_north",
    )

    def __init__(self, velocity_north: float, velocity_east: float) -> None:
        self.velocity_north, self.velocity_east = velocity_north, velocity_east
        self.north = self.east = self.acceleration_north = self.acceleration_east = 0.0
        self.tubes: Sequence[Tube] = (Tube(0.0, 0.0, 0.0, velocity_north, velocity_east),)

    def update(self, time: float, planning: bool) -> None:  # noqa: ARG002 - of the Protocol
        """Move on to ``time`` [s]."""
        self.north, self.east = self.velocity_north * time, self.velocity_east * time

    def age(self, _time: float) -> float:
        """Return 0: what is known is true at all times [s]."""
        return 0.0


class ReportedTarget:
    """A vessel known from its reports through a filter, extrapolated between looks; attributes as
    of ``TargetMotion``.

    Parameters
    ----------
    vessel : the filter of its reports
    reach : where it may be
    time_step : of the guidance [s]
    """

    __slots__ = (
        "_gain_east",
        "_gain_north",
        "_reach",
        "_time_step",
        "acceleration_east",
        "acceleration_north",
        "east",
        "north",
        "tubes",
        "velocity_east",
        "velocity_north",
        "vessel",
    )  # fmt: skip

    def __init__(self, vessel: VesselFilter, reach: ReachableSet, time_step: float) -> None:
        self.vessel, self._reach, self._time_step = vessel, reach, time_step
        self.tubes: Sequence[Tube] = ()
        self.north = self.east = self.velocity_north = self.velocity_east = 0.0
        self.acceleration_north = self.acceleration_east = self._gain_north = self._gain_east = 0.0

    def report(self, report: VesselReport) -> None:
        """Take in a report, the first one before the first update."""
        self.vessel.report(report)
        self._reach.report(report)

    def update(self, time: float, planning: bool) -> None:
        """Move on to ``time`` [s]; ask the filter anew where the mission is ``planning``."""
        if planning:
            self.tubes = self._reach.tubes(time)
            vessel = self.vessel.at(time)
            self.north, self.east = vessel.north, vessel.east
            self.velocity_north, self.velocity_east = vessel.velocity_north, vessel.velocity_east
            self.acceleration_north, self.acceleration_east = self._manoeuvre(
                vessel.acceleration_north, vessel.acceleration_east
            )
            self._gain_north = self._time_step * vessel.acceleration_north
            self._gain_east = self._time_step * vessel.acceleration_east
        else:
            self.north += self._time_step * self.velocity_north
            self.east += self._time_step * self.velocity_east
            self.velocity_north += self._gain_north
            self.velocity_east += self._gain_east

    def age(self, time: float) -> float:
        """Return how old the last report is at ``time`` [s]."""
        return time - self.vessel.time

    def _manoeuvre(self, north: float, east: float) -> tuple[float, float]:
        """Return as much of an estimated acceleration as is not the scatter of reports [m/s^2]."""
        if self.vessel.exact:
            return north, east
        size = math.hypot(north, east)
        share = 1.0 - REPORTED_SCATTER / size if size > REPORTED_SCATTER else 0.0
        return share * north, share * east
