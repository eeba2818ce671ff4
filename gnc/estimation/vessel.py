"""Where the vessel is, how it moves and where it may be: known exactly, or from its reports.

Reports arrive every few seconds, noisy, late, or not at all. A filter estimates the vessel's motion
from them, for the mission. Discs that the vessel cannot have left bound it, for the guard.

Between reports the vessel keeps within a declared acceleration, in any direction, and a declared
speed. From a report at time t_i its position at t_i + s lies within

    k hypot(sigma_p, sigma_v s) + a s^2/2    of p_i + v_i s,    and within    k sigma_p + v_max s
    of p_i,

where k standard deviations of the report's errors are the largest that are allowed for. No later
report makes a disc wrong. So the vessel is in all of them at once, and keeping off one of them is
enough (docs/keepout_guard.md).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

KEPT = 3
"""Number of newest reports that discs are made of [-]: an older report is more accurate only by
chance.
"""

REPORTED_SCATTER = 0.03
"""Scatter of the estimated acceleration of a steady vessel whose reports have errors [m/s^2]."""

_EXACT = 1e-3
"""Deviation of a position below which its error grows at the rate of the velocity's error from the
start [m].
"""

_SHORT = 0.005
"""Time, over the filter's memory, below which only the leading terms of the process noise are used
[-].
"""


class VesselReport(NamedTuple):
    """A vessel's report of its motion, as by AIS.

    Attributes
    ----------
    time : at which it was true [s]
    north, east : [m]
    velocity_north, velocity_east : over the ground [m/s]
    """

    time: float
    north: float
    east: float
    velocity_north: float
    velocity_east: float


class VesselMotion(NamedTuple):
    """A vessel's estimated motion.

    Attributes
    ----------
    north, east : [m]
    velocity_north, velocity_east : over the ground [m/s]
    acceleration_north, acceleration_east : [m/s^2]
    sigma : standard deviation of each coordinate of the position [m]
    """

    north: float
    east: float
    velocity_north: float
    velocity_east: float
    acceleration_north: float
    acceleration_east: float
    sigma: float


@dataclass(frozen=True, slots=True, kw_only=True)
class FilterParameters:
    """Parameters of the filter of a vessel's reports.

    Attributes
    ----------
    position_sigma, velocity_sigma : of a report's components [m, m/s]; 0 where they are exact
    acceleration : standard deviation of its components [m/s^2]
    memory : time constant of the acceleration [s]
    """

    position_sigma: float
    velocity_sigma: float
    acceleration: float
    memory: float


class AxisState(NamedTuple):
    """Position, velocity and acceleration along one axis [m, m/s, m/s^2], or gains on them."""

    position: float
    velocity: float
    acceleration: float


class Covariance(NamedTuple):
    """Covariance of an ``AxisState``: of p position, v velocity, a acceleration."""

    pp: float
    pv: float
    pa: float
    vv: float
    va: float
    aa: float


def singer_response(memory: float, time: float) -> AxisState:
    """Return the response after ``time`` [s] to an acceleration of 1 now, which fades."""
    decay = math.exp(-time / memory)
    to_velocity = memory * (1.0 - decay)
    return AxisState(memory * (time - to_velocity), to_velocity, decay)


def singer_noise(variance: float, memory: float, time: float) -> Covariance:
    """Return the covariance that the random acceleration adds in some time.

    It is Singer's exact discrete process noise. Over short times its closed forms cancel to
    nothing; their leading terms are true to 0.5 %.

    Parameters
    ----------
    variance : of the acceleration [m^2/s^4]
    memory, time : time constant of the acceleration, and the time [s]
    """
    m, t = memory, time
    if t < _SHORT * m:
        q = 2.0 * variance / m
        return Covariance(
            pp=q * t**5 / 20.0,
            pv=q * t**4 / 8.0,
            pa=q * t**3 / 6.0,
            vv=q * t**3 / 3.0,
            va=q * t**2 / 2.0,
            aa=q * t,
        )
    e = math.exp(-t / m)
    x = t / m
    position = 1.0 - e * e + 2.0 * x + 2.0 * x**3 / 3.0 - 2.0 * x * x - 4.0 * x * e
    return Covariance(
        pp=variance * m**4 * position,
        pv=variance * m**3 * (e * e + 1.0 - 2.0 * e + 2.0 * x * e - 2.0 * x + x * x),
        pa=variance * m**2 * (1.0 - e * e - 2.0 * x * e),
        vv=variance * m**2 * (4.0 * e - 3.0 - e * e + 2.0 * x),
        va=variance * m * (e * e + 1.0 - 2.0 * e),
        aa=variance * (1.0 - e * e),
    )


class VesselFilter:
    """Singer's model of a manoeuvring target as two Kalman filters, for north and east.

    They share their covariance. Acceleration is a random process of standard deviation
    ``acceleration`` and time constant ``memory``; position is its double integral (R. A. Singer,
    IEEE Trans. AES 6:473, 1970; Bar-Shalom et al., Estimation with Applications to Tracking and
    Navigation, 2001, section 8.2). A report that is older than the newest one is dropped; a late
    one counts at the time at which it was true.

    Parameters
    ----------
    parameters : of the reports' errors and of the vessel's acceleration

    Attributes
    ----------
    time : of the newest report; minus infinity before the first one [s]
    north, east, covariance : estimate at that time, and its covariance along either axis
    """

    def __init__(self, parameters: FilterParameters) -> None:
        self._position_variance = parameters.position_sigma**2
        self._velocity_variance = parameters.velocity_sigma**2
        self._acceleration_variance = parameters.acceleration**2
        self._memory = parameters.memory
        self.north = AxisState(0.0, 0.0, 0.0)
        self.east = AxisState(0.0, 0.0, 0.0)
        self.covariance = Covariance(0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        self.time = -math.inf

    @property
    def exact(self) -> bool:
        """Whether reports have no errors."""
        return self._position_variance == self._velocity_variance == 0.0

    def report(self, report: VesselReport) -> None:
        """Correct the estimate by a report."""
        if report.time <= self.time:
            return
        if self.time == -math.inf:
            self._begin(report)
        else:
            ahead = report.time - self.time
            self.north = self._predicted(self.north, ahead)
            self.east = self._predicted(self.east, ahead)
            self.covariance = self._predicted_covariance(ahead)
            p = self.covariance
            self._correct(
                AxisState(p.pp, p.pv, p.pa),
                p.pp + self._position_variance,
                report.north - self.north.position,
                report.east - self.east.position,
            )
            p = self.covariance
            self._correct(
                AxisState(p.pv, p.vv, p.va),
                p.vv + self._velocity_variance,
                report.velocity_north - self.north.velocity,
                report.velocity_east - self.east.velocity,
            )
        self.time = report.time

    def at(self, time: float) -> VesselMotion:
        """Return the motion extrapolated to ``time`` [s], not before that of the newest report."""
        ahead = time - self.time
        north = self._predicted(self.north, ahead)
        east = self._predicted(self.east, ahead)
        variance = self._predicted_covariance(ahead).pp
        return VesselMotion(
            north.position,
            east.position,
            north.velocity,
            east.velocity,
            north.acceleration,
            east.acceleration,
            math.sqrt(max(0.0, variance)),
        )

    def _begin(self, report: VesselReport) -> None:
        self.north = AxisState(report.north, report.velocity_north, 0.0)
        self.east = AxisState(report.east, report.velocity_east, 0.0)
        self.covariance = Covariance(
            pp=self._position_variance,
            pv=0.0,
            pa=0.0,
            vv=self._velocity_variance,
            va=0.0,
            aa=self._acceleration_variance,
        )

    def _predicted(self, axis: AxisState, time: float) -> AxisState:
        to_position, to_velocity, decay = singer_response(self._memory, time)
        position, velocity, acceleration = axis
        return AxisState(
            position + time * velocity + to_position * acceleration,
            velocity + to_velocity * acceleration,
            decay * acceleration,
        )

    def _predicted_covariance(self, time: float) -> Covariance:
        """Return the covariance after ``time`` [s]: F P F' + Q."""
        b, c, d = singer_response(self._memory, time)
        p = self.covariance
        q = singer_noise(self._acceleration_variance, self._memory, time)
        # The rows of F P.
        pp = p.pp + time * p.pv + b * p.pa
        pv = p.pv + time * p.vv + b * p.va
        pa = p.pa + time * p.va + b * p.aa
        vv = p.vv + c * p.va
        va = p.va + c * p.aa
        return Covariance(
            pp=pp + time * pv + b * pa + q.pp,
            pv=pv + c * pa + q.pv,
            pa=d * pa + q.pa,
            vv=vv + c * va + q.vv,
            va=d * va + q.va,
            aa=d * d * p.aa + q.aa,
        )

    def _correct(self, column: AxisState, total: float, off_north: float, off_east: float) -> None:
        """Correct both axes by one measured coordinate.

        Parameters
        ----------
        column : covariance of the measured coordinate with the state
        total : variance of the innovation
        off_north, off_east : innovations
        """
        if total <= 0.0:
            return
        gain = AxisState(
            column.position / total, column.velocity / total, column.acceleration / total
        )
        self.north = _corrected(self.north, gain, off_north)
        self.east = _corrected(self.east, gain, off_east)
        p = self.covariance
        self.covariance = Covariance(
            pp=p.pp - gain.position * column.position,
            pv=p.pv - gain.position * column.velocity,
            pa=p.pa - gain.position * column.acceleration,
            vv=p.vv - gain.velocity * column.velocity,
            va=p.va - gain.velocity * column.acceleration,
            aa=p.aa - gain.acceleration * column.acceleration,
        )


def _corrected(axis: AxisState, gain: AxisState, off: float) -> AxisState:
    return AxisState(
        axis.position + gain.position * off,
        axis.velocity + gain.velocity * off,
        axis.acceleration + gain.acceleration * off,
    )


class Tube(NamedTuple):
    """A disc that contains the vessel from ``time`` on, as it moves and grows.

    Its centre moves at a constant velocity. Its radius after t seconds is ``radius`` + ``growth`` t
    + ``acceleration`` t^2/2.

    Attributes
    ----------
    time : [s]
    north, east : of its centre at that time [m]
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
        """Return the radius [m] some time ahead [s]."""
        return self.radius + (self.growth + 0.5 * self.acceleration * ahead) * ahead


@dataclass(frozen=True, slots=True, kw_only=True)
class VesselLimits:
    """Declared limits of a vessel's motion and of its reports' errors.

    Attributes
    ----------
    acceleration : largest one in any direction [m/s^2]
    speed_max : largest speed over the ground; infinite if it is not declared [m/s]
    position_sigma, velocity_sigma : of a report's components; an error of the vehicle's position
        counts as one of the vessel's [m, m/s]
    deviations : k, largest error of a report in any direction over its standard deviation [-]
    horizon : time of a turn away, for which discs are needed ahead [s]
    """

    acceleration: float
    speed_max: float
    position_sigma: float
    velocity_sigma: float
    deviations: float
    horizon: float


def radius_after(limits: VesselLimits, age: Any) -> Any:
    """Return the radius of the disc by acceleration [m] at an age of its report [s].

    Parameters
    ----------
    limits : of the vessel and its reports
    age : a number, or an array of any shape
    """
    spread = (limits.position_sigma**2 + (limits.velocity_sigma * age) ** 2) ** 0.5
    return limits.deviations * spread + 0.5 * limits.acceleration * age * age


def radius_by_speed(limits: VesselLimits, age: Any) -> Any:
    """Return the radius of the disc by the largest speed [m]; parameters as in ``radius_after``."""
    return limits.deviations * limits.position_sigma + limits.speed_max * age


def tube(report: VesselReport, limits: VesselLimits, time: float) -> Tube:
    """Return the disc at ``time`` of a vessel that may have accelerated since its report.

    Parameters
    ----------
    report, limits : the report, and the vessel's limits
    time : from which the disc is valid, not before the report's [s]
    """
    age = time - report.time
    spread = math.hypot(limits.position_sigma, limits.velocity_sigma * age)
    growth, acceleration = _error_growth(limits, age, spread)
    return Tube(
        time,
        report.north + report.velocity_north * age,
        report.east + report.velocity_east * age,
        report.velocity_north,
        report.velocity_east,
        radius_after(limits, age),
        growth + limits.acceleration * age,
        acceleration + limits.acceleration,
    )


def _error_growth(limits: VesselLimits, age: float, spread: float) -> tuple[float, float]:
    """Return first and second derivative of the error k hypot(sigma_p, sigma_v s) [m/s, m/s^2].

    Derivatives beyond the second are not needed, since the second one falls with time. For a
    position that is almost exact it is unbounded at first; there the growth is at most that of the
    velocity's error.
    """
    k, place, drift = limits.deviations, limits.position_sigma, limits.velocity_sigma
    if place > _EXACT:
        return k * drift * drift * age / spread, k * (drift * place) ** 2 / spread**3
    return k * drift, 0.0


def tube_by_speed(report: VesselReport, limits: VesselLimits, time: float) -> Tube:
    """Return the disc of a vessel that may go anywhere at its largest speed from ``time`` on.

    It begins as the disc by acceleration, or as the disc by the largest speed since the report,
    whichever is smaller. A vehicle can leave a disc by acceleration for good only until the disc's
    edge is as fast as the vehicle; it can always leave this disc, if it is faster than the vessel.
    Since this disc begins no larger, it takes over from the other one before that.

    Parameters
    ----------
    report, limits, time : same as ``tube``
    """
    by_acceleration, speed = tube(report, limits, time), limits.speed_max
    since_report = radius_by_speed(limits, time - report.time)
    if by_acceleration.radius <= since_report:
        north, east, radius = by_acceleration.north, by_acceleration.east, by_acceleration.radius
    else:
        north, east, radius = report.north, report.east, since_report
    return Tube(time, north, east, 0.0, 0.0, radius, speed)


class ReachableSet:
    """The discs of a vessel that is known from reports.

    Parameters
    ----------
    limits : of the vessel and its reports

    Attributes
    ----------
    reports : that are kept, the newest first; the list is replaced, and never changed
    """

    def __init__(self, limits: VesselLimits) -> None:
        self._limits = limits
        self.reports: Sequence[VesselReport] = ()

    def report(self, report: VesselReport) -> None:
        """Take in a report, which may be older than others."""
        reports = self.reports
        if not reports or report.time > reports[0].time:
            self.reports = [report, *reports[: KEPT - 1]]
        else:
            self.reports = sorted([*reports, report], key=lambda of: -of.time)[:KEPT]

    def newest(self, time: float) -> Tube:
        """Return the disc by acceleration of the newest report at ``time`` [s]."""
        return tube(self.reports[0], self._limits, time)

    def tubes(self, time: float) -> Sequence[Tube]:
        """Return the discs of the newest reports at ``time`` [s]; see ``discs_of``."""
        return discs_of(self.reports, self._limits, time)


def discs_of(reports: Sequence[VesselReport], limits: VesselLimits, time: float) -> Sequence[Tube]:
    """Return the discs of reports at a time, in the order of the reports.

    Discs by speed follow those by acceleration.

    Parameters
    ----------
    reports, limits : of the vessel
    time : not before that of any report [s]
    """
    discs = [tube(report, limits, time) for report in reports]
    if limits.acceleration > 0.0 and limits.speed_max < math.inf:
        discs += [
            tube_by_speed(report, limits, time)
            for disc, report in zip(discs, reports, strict=True)
            if _may_outrun_vessel(disc, limits)
        ]
    return discs


def _may_outrun_vessel(disc: Tube, limits: VesselLimits) -> bool:
    """Return whether a disc's edge may be faster than the vessel before a turn away is over."""
    edge = disc.growth + disc.acceleration * limits.horizon
    speed = math.hypot(disc.velocity_north, disc.velocity_east)
    return speed + edge > limits.speed_max


class TargetMotion:
    """The vessel's motion over the ground, updated once per guidance step.

    Attributes
    ----------
    north, east : [m]
    velocity_north, velocity_east : [m/s]
    acceleration_north, acceleration_east : at the last plan, less the scatter of reports [m/s^2]
    tubes : discs that contain the vessel from the last plan on, the best known first
    """

    def __init__(self) -> None:
        self.north = 0.0
        self.east = 0.0
        self.velocity_north = 0.0
        self.velocity_east = 0.0
        self.acceleration_north = 0.0
        self.acceleration_east = 0.0
        self.tubes: Sequence[Tube] = ()

    def update(self, time: float, planning: bool) -> None:
        """Move on to ``time`` [s]; renew the estimate where the mission is ``planning``."""
        raise NotImplementedError

    def age(self, time: float) -> float:
        """Return the age of the last report [s] at ``time`` [s]."""
        raise NotImplementedError


class SteadyTarget(TargetMotion):
    """A vessel at constant velocity from the origin, known exactly.

    Parameters
    ----------
    velocity_north, velocity_east : [m/s]
    """

    def __init__(self, velocity_north: float, velocity_east: float) -> None:
        super().__init__()
        self.velocity_north = velocity_north
        self.velocity_east = velocity_east
        self.tubes = (Tube(0.0, 0.0, 0.0, velocity_north, velocity_east),)

    def update(self, time: float, planning: bool) -> None:  # noqa: ARG002 - of TargetMotion
        """Move on to ``time`` [s]."""
        self.north = self.velocity_north * time
        self.east = self.velocity_east * time

    def age(self, time: float) -> float:  # noqa: ARG002 - of TargetMotion
        """Return 0: exact knowledge does not age [s]."""
        return 0.0


class ReportedTarget(TargetMotion):
    """A vessel known from its reports, extrapolated between plans.

    Parameters
    ----------
    vessel : filter of the reports
    reach : discs that contain the vessel
    time_step : of the guidance [s]
    """

    def __init__(self, vessel: VesselFilter, reach: ReachableSet, time_step: float) -> None:
        super().__init__()
        self.vessel = vessel
        self._reach = reach
        self._time_step = time_step
        # Change of the velocity in a step.
        self._gain_north = 0.0
        self._gain_east = 0.0

    def report(self, report: VesselReport) -> None:
        """Take in a report, the first one before the first update."""
        self.vessel.report(report)
        self._reach.report(report)

    def update(self, time: float, planning: bool) -> None:
        """Move on to ``time`` [s]; renew the estimate where the mission is ``planning``."""
        if not planning:
            self.north += self._time_step * self.velocity_north
            self.east += self._time_step * self.velocity_east
            self.velocity_north += self._gain_north
            self.velocity_east += self._gain_east
            return
        self.tubes = self._reach.tubes(time)
        vessel = self.vessel.at(time)
        self.north = vessel.north
        self.east = vessel.east
        self.velocity_north = vessel.velocity_north
        self.velocity_east = vessel.velocity_east
        # The share of the acceleration that is not scatter of the reports.
        share = 1.0
        if not self.vessel.exact:
            size = math.hypot(vessel.acceleration_north, vessel.acceleration_east)
            share = 1.0 - REPORTED_SCATTER / size if size > REPORTED_SCATTER else 0.0
        self.acceleration_north = share * vessel.acceleration_north
        self.acceleration_east = share * vessel.acceleration_east
        self._gain_north = self._time_step * vessel.acceleration_north
        self._gain_east = self._time_step * vessel.acceleration_east

    def age(self, time: float) -> float:
        """Return the age of the last report [s] at ``time`` [s]."""
        return time - self.vessel.time
