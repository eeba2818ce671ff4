"""Where a vessel may be that is known from reports: discs that it cannot have left, each from one
report.

Between reports the vessel moves as it likes within what is declared of it: an acceleration, in any
direction, and a speed. From a report at time t_i its place at t_i + s lies within

    k hypot(sigma_p, sigma_v s) + a s^2/2    of p_i + v_i s,    and within    k sigma_p + v_max s
    of p_i,

k standard deviations of the report's errors being the largest that are allowed for. Every such disc
is true for good, whatever is reported later. So the vessel is in all of them at once, and to keep
off one of them is enough (docs/keepout_guard.md).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from gnc.estimation.vessel_filter import VesselReport

KEPT = 3
"""Newest reports that discs are made of: an older one could be nearer the truth only by its luck
[-].
"""


_EXACT = 1e-3
"""Standard deviation of a place below which its error grows with that of the velocity from the
first moment on [m].
"""

Value = TypeVar("Value", float, npt.NDArray[np.float64])
"""A number, or many."""


class Tube(NamedTuple):
    """A disc that contains the vessel from ``time`` on, as it moves and grows.

    Its centre moves at a constant velocity, its radius is ``radius`` + ``growth`` t +
    ``acceleration`` t^2/2 after t seconds.

    Attributes
    ----------
    time : [s]
    north, east : of its centre then [m]
    velocity_north, velocity_east : of its centre over the ground [m/s]
    radius, growth, acceleration : [m, m/s, m/s^2]
    """

    time: float
    north: float
    east: float
    velocity_north: float
    velocity_east: float
    radius: float = 0.0
    growth: float = 0.0
    acceleration: float = 0.0

    def reach(self, ahead: float) -> float:
        """Return the radius some time ahead [s, m]."""
        return self.radius + (self.growth + 0.5 * self.acceleration * ahead) * ahead


@dataclass(frozen=True, slots=True, kw_only=True)
class VesselLimits:
    """What a vessel and its reports are declared to keep within.

    Attributes
    ----------
    acceleration : largest, in any direction [m/s^2]
    speed_max : largest over the ground; infinite if none is declared [m/s]
    position_sigma, velocity_sigma : of a report's components; the vehicle's own place counts as the
        vessel's [m, m/s]
    deviations : k, largest error of a report in any direction over its standard deviation [-]
    horizon : for how long ahead discs are asked for: a turn away [s]
    """

    acceleration: float
    speed_max: float
    position_sigma: float
    velocity_sigma: float
    deviations: float
    horizon: float


def radius_after(limits: VesselLimits, age: Value) -> Value:
    """Return the radius [m] of the disc that a vessel cannot have left so long after a report [s]."""
    spread = (limits.position_sigma**2 + (limits.velocity_sigma * age) ** 2) ** 0.5
    radius: Value = limits.deviations * spread + 0.5 * limits.acceleration * age * age
    return radius


def radius_by_speed(limits: VesselLimits, age: Value) -> Value:
    """Return the radius [m] of the disc about a reported place that she cannot have left by her
    largest speed so long after [s].
    """
    radius: Value = limits.deviations * limits.position_sigma + limits.speed_max * age
    return radius


def tube(report: VesselReport, limits: VesselLimits, time: float) -> Tube:
    """Return the disc at ``time`` [s] of a vessel that may have accelerated since its report, as it
    grows from then on.

    Parameters
    ----------
    report, limits : the report, and what the vessel keeps within
    time : not before the report's [s]
    """
    age, k, acceleration = time - report.time, limits.deviations, limits.acceleration
    place, drift = limits.position_sigma, limits.velocity_sigma
    # Of the errors' growth no more than the first and second derivative now are needed: the second
    # one falls. Of a place that is next to exact the second is beyond all bounds at first; the
    # growth is never above that of the velocity's error.
    spread = math.hypot(place, drift * age)
    drifting, faster = k * drift, 0.0
    if place > _EXACT:
        drifting, faster = k * drift * drift * age / spread, k * (drift * place) ** 2 / spread**3
    return Tube(
        time,
        report.north + report.velocity_north * age,
        report.east + report.velocity_east * age,
        report.velocity_north,
        report.velocity_east,
        radius_after(limits, age),
        drifting + acceleration * age,
        faster + acceleration,
    )


def tube_by_speed(report: VesselReport, limits: VesselLimits, time: float) -> Tube:
    """Return the disc of a vessel that may go anywhere at its largest speed from ``time`` on;
    parameters as of ``tube``.

    It begins as where the vessel may be by its acceleration, or by its largest speed since its
    report, whichever is smaller. A disc by acceleration is left for good only until its edge moves
    as fast as the vehicle; this one, by a vehicle that is faster than the vessel, always. Since it
    begins no larger, the one takes over from the other before that.
    """
    by_acceleration, speed = tube(report, limits, time), limits.speed_max
    since_report = radius_by_speed(limits, time - report.time)
    if by_acceleration.radius <= since_report:
        return Tube(
            time,
            by_acceleration.north,
            by_acceleration.east,
            0.0,
            0.0,
            by_acceleration.radius,
            speed,
        )
    return Tube(time, report.north, report.east, 0.0, 0.0, since_report, speed)


class ReachableSet:
    """The discs of a vessel that is known from reports.

    Parameters
    ----------
    limits : what vessel and reports keep within
    """

    __slots__ = ("_limits", "_reports")

    def __init__(self, limits: VesselLimits) -> None:
        self._limits = limits
        self._reports: list[VesselReport] = []

    def report(self, report: VesselReport) -> None:
        """Take in a report, which may be older than others."""
        self._reports = sorted([*self._reports, report], key=lambda of: -of.time)[:KEPT]

    def tubes(self, time: float) -> Sequence[Tube]:
        """Return the discs of the reports that are kept at ``time`` [s], that of the newest first."""
        limits, reports = self._limits, self._reports
        found = [tube(report, limits, time) for report in reports]
        if limits.acceleration > 0.0 and limits.speed_max < math.inf:
            speed_max, horizon = limits.speed_max, limits.horizon
            for disc, report in zip(tuple(found), reports, strict=True):
                # Of use once the edge of the other may move faster than the vessel, by when a turn
                # away is over.
                edge = disc.growth + disc.acceleration * horizon
                if math.hypot(disc.velocity_north, disc.velocity_east) + edge > speed_max:
                    found.append(tube_by_speed(report, limits, time))
        return found
