"""The keep-out margin of a flight in operational conditions: the distance of its orbit from the
keep-out area. At this distance errors carry the aircraft into the area very rarely, and the guard
does not act.

The margin has three parts.

Tracking error in turbulence
    Its spread is predicted (``tracking_spread``); by Rice's formula (S. O. Rice, "Mathematical
    Analysis of Random Noise", 1944) follows how often it exceeds a margin. Gusts that exceed the
    range of the aircraft's airspeeds carry it along as long as they last. A Gaussian process near a
    high peak L is L (1 - (nu t)^2/2), where nu is the ratio of the deviation of its rate to its
    deviation. The integral of its excess over a limit has a closed form; the margin includes that
    distance for the peak that is exceeded as often as touches are allowed. The margin does not
    account for the aircraft's deceleration. Where turbulence closes the throttle, the spread is
    larger than predicted: 1.4 to 2.9 times on the X8 in moderate turbulence, which the second part
    of the margin compensated in 13 hours of flights. In severe turbulence an X8 can lose its
    reference, and no such margin holds.
Room for the guard
    The orbit lies where a turn away from the vessel, as the guard predicts it, is always possible.
Scatter of what is known
    The orbit is placed beside the vessel's position as the filter estimates it. The discs of
    ``gnc.estimation.vessel`` are centred on single reports, which scatter more. So a disc that is
    no larger than planned may reach farther towards the orbit. Beside a vessel that is known
    exactly, the vehicle's own position and velocity are noisy. The vehicle follows its reference by
    its estimated position, with a lag: guidance and guard see the distance from the reference that
    it has not yet corrected. Noise of the velocity, new at each step, turns and stretches the
    predicted turn away.
"""

import functools
import itertools
import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.linalg import solve_continuous_lyapunov

from common.physics import SECONDS_PER_HOUR
from gnc.airspeed import SpeedHold, air_turn
from gnc.estimation.error_budget import AS_COMMANDED, TurnDeviation, WindErrorByGusts, deviations
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import (
    KEPT,
    FilterParameters,
    Tube,
    VesselFilter,
    VesselLimits,
    VesselReport,
    radius_after,
    tube,
)
from gnc.guard.guard import GuardParameters, HeadingRateFilter
from gnc.mission.standoff import CirclePoint
from gnc.reference.reference import CirclingReference, Orbit
from gnc.tracker import Tracker, TrackingParameters
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.equipment import VesselReportsConfig
from scenarios.vehicles.sensors import NAVIGATION_TIME

VESSEL_ACCELERATION, VESSEL_MEMORY = 0.02, 40.0
"""Standard deviation [m/s^2] and time constant [s] of a ship's acceleration in the vessel's filter.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Predicted standard deviations of a flight in turbulence.

    Attributes
    ----------
    along, across : error along and across the reference's course, in the mean over the orbit [m]
    radial, radial_rate : error towards the vessel, and its rate: upper bounds [m, m/s]
    airspeed, airspeed_rate : of the airspeed that the aircraft flies to keep pace, and its rate
        [m/s, m/s^2]
    airspeed_limit : smaller distance of the reference's speed from the limits of the airspeed [m/s]
    """

    along: float
    across: float
    radial: float
    radial_rate: float
    airspeed: float
    airspeed_rate: float
    airspeed_limit: float


@dataclass(frozen=True, slots=True, kw_only=True)
class SpreadTable:
    """Predicted spread of the tracking error.

    Attributes
    ----------
    speed_ratios : nu, ascending [-]
    spreads : at each of them
    turning : of a turn away
    """

    speed_ratios: tuple[float, ...]
    spreads: tuple[Spread, ...]
    turning: TurnDeviation = AS_COMMANDED

    def at(self, nu: float) -> Spread:
        """Return the spread at the nearest speed ratio."""
        return min(
            zip(self.speed_ratios, self.spreads, strict=True), key=lambda entry: abs(entry[0] - nu)
        )[1]


CALM_AIR_SPREAD = Spread(
    along=0.0,
    across=0.0,
    radial=0.0,
    radial_rate=0.0,
    airspeed=0.0,
    airspeed_rate=0.0,
    airspeed_limit=1.0,
)
"""The spread in calm air."""


@dataclass(frozen=True, slots=True, kw_only=True)
class KeepoutMargin:
    """A planned margin.

    Attributes
    ----------
    tracking_sigma : predicted standard deviation of the tracking error towards the vessel [m]
    total : distance of the orbit from the keep-out area [m]
    reach : largest distance of the vessel from its estimated place, as long as its reports are not
        overdue [m]
    """

    tracking_sigma: float
    total: float
    reach: float


def filter_parameters(reports: VesselReportsConfig) -> FilterParameters:
    """Return the filter for a vessel's reports."""
    return FilterParameters(
        position_sigma=0.0 if reports.exact else reports.position_sigma_m,
        velocity_sigma=0.0 if reports.exact else reports.velocity_sigma_mps,
        acceleration=VESSEL_ACCELERATION,
        memory=VESSEL_MEMORY,
    )


def vessel_limits(scenario: Scenario, horizon: float) -> VesselLimits:
    """Return the limits of the vessel and of its reports.

    Errors are normally distributed and so have no limit; the limit used here is exceeded as often
    as the keep-out area may be touched.

    Parameters
    ----------
    scenario : the flight
    horizon : duration of a turn away [s]
    """
    f, reports = scenario.following, scenario.reports
    known = filter_parameters(reports)
    return VesselLimits(
        acceleration=f.vessel_acceleration_mps2,
        speed_max=math.inf if f.vessel_speed_max_mps is None else f.vessel_speed_max_mps,
        position_sigma=math.hypot(known.position_sigma, scenario.sensors.position_sigma_m),
        velocity_sigma=known.velocity_sigma,
        deviations=_deviations(scenario),
        horizon=horizon,
    )


def _deviations(scenario: Scenario) -> float:
    """Return the number of standard deviations that errors exceed as often as the keep-out area may
    be touched [-].
    """
    flight, reports = scenario.flight, scenario.reports
    # Even with very rare reports, a flight begins with one.
    reported = SECONDS_PER_HOUR / flight.duration_max_s
    if not reports.exact:
        reported += SECONDS_PER_HOUR / mean_interval(reports.interval_s)
    wanders = scenario.sensors.position_sigma_m > 0.0
    return deviations(
        scenario.following.touches_per_hour,
        ageing=reported,
        correlation_times=(NAVIGATION_TIME,) if wanders else (),
    )


def widest_tube(
    limits: VesselLimits, reports: VesselReportsConfig, *, plan_period: float, noise: float = 0.0
) -> Tube:
    """Return the disc about a vessel whose newest report has the largest age without a missing
    report, with its centre at the origin.

    It is enlarged by the scatter of the reports (``scatter_allowance``), or, about a vessel that is
    known exactly, by that of the vehicle's own position and velocity.

    Parameters
    ----------
    limits, reports : limits of the vessel and its reports, and intervals of reports
    plan_period : interval at which they are evaluated [s]
    noise : how much nearer noise of satellite navigation takes the vehicle (``noise_allowance``)
        [m]
    """
    age = plan_period + (0.0 if reports.exact else reports.interval_s[1] + reports.latency_max_s)
    oldest = tube(VesselReport(-age, 0.0, 0.0, 0.0, 0.0), limits, 0.0)
    if reports.exact:
        return oldest._replace(radius=oldest.radius + noise)
    allowance = scatter_allowance(
        limits,
        filter_parameters(reports),
        reports.interval_s,
        reports.latency_max_s,
        plan_period=plan_period,
        planned=oldest.reach(limits.horizon),
    )
    return oldest._replace(radius=oldest.radius + allowance)


def tracking_level(
    scenario: Scenario, spreads: SpreadTable | None, nu: float
) -> tuple[float, float]:
    """Return the standard deviation of the tracking error towards the vessel, and the level that it
    exceeds as rarely as allowed [m].
    """
    spread = spreads.at(nu) if spreads else CALM_AIR_SPREAD
    return spread.radial, planned_margin(
        spread, touches_per_hour=scenario.following.touches_per_hour
    )


def planned_margin(spread: Spread, *, touches_per_hour: float) -> float:
    """Return the margin [m] to plan between orbit and keep-out area.

    Parameters
    ----------
    spread : in turbulence
    touches_per_hour : how often the area may be touched, above 0 [1/h]
    """
    return level_crossed(spread.radial, spread.radial_rate, touches_per_hour) + beyond_limits(
        spread, touches_per_hour
    )


def level_crossed(sigma: float, sigma_rate: float, per_hour: float) -> float:
    """Return the level that a Gaussian process crosses upwards at a rate; 0 if it crosses even its
    mean less often.

    By Rice's formula it crosses a level L ``sigma_rate/(2 pi sigma) exp(-(L/sigma)^2/2)`` times a
    second.

    Parameters
    ----------
    sigma, sigma_rate : standard deviations of the process and of its rate [m, m/s]
    per_hour : that rate, above 0 [1/h]

    Raises
    ------
    ValueError : the process has a deviation, but its rate has none
    """
    if sigma == 0.0:
        return 0.0
    if not sigma_rate > 0.0:
        raise ValueError(f"an error of {sigma:g} m varies by {sigma_rate:g} m/s; give above 0")
    mean_per_hour = SECONDS_PER_HOUR * sigma_rate / (2.0 * math.pi * sigma)
    return sigma * math.sqrt(2.0 * math.log(max(1.0, mean_per_hour / per_hour)))


def beyond_limits(spread: Spread, per_hour: float) -> float:
    """Return the distance from its reference to which gusts beyond the range of airspeeds carry the
    aircraft at a rate [1/h], in metres.
    """
    peak = level_crossed(spread.airspeed, spread.airspeed_rate, per_hour)
    excess = peak - spread.airspeed_limit
    if excess <= 0.0:
        return 0.0
    half_time = math.sqrt(2.0 * excess / peak) * spread.airspeed / spread.airspeed_rate
    return 4.0 / 3.0 * excess * half_time


_PHASES = 24
"""Number of points of half an orbit from which a turn away is predicted [-]; the other half is the
mirror image, or has as many.
"""

ASTERN = (-1.0, 0.0)
"""Direction of a plume straight astern, ahead of the vessel and to its right [-]."""

_ALIGNED = 1e-9
"""Largest component to the right of a direction that counts as along the vessel's course [-]: then
half an orbit is enough.
"""

_FAR = 3.0
"""Initial distance of the search for a clearance, over the radius to keep [-]."""


def orbit_distance(
    guard: GuardParameters,
    vessel: Tube,
    orbit: Orbit,
    direction: tuple[float, float] = ASTERN,
    *,
    wind: WindErrorByGusts | None = None,
) -> float:
    """Return the smallest distance of an orbit from the vessel at which a turn away is always
    possible [m].

    It is the distance of the centre less the half-width along.

    Parameters
    ----------
    guard : its parameters
    vessel : largest disc that contains it
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
    """Return the smallest radius of a circle about the vessel on which a turn away is always
    possible [m].

    Parameters
    ----------
    guard : its parameters
    vessel : largest disc that contains it
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
    """Return the distance at which the guard does not have to act for the nearest of the motions at
    that distance [m].
    """
    keeping = HeadingRateFilter(guard)
    disc = vessel._replace(time=0.0, north=0.0, east=0.0, velocity_north=drift, velocity_east=0.0)
    distance = _FAR * (guard.radius + vessel.radius)
    for _ in range(2):
        # Clearances change by as much as the distance, apart from the curvature of a disc: the
        # result is up to 0.3 m too large.
        least = math.inf
        for motion in motions(distance):
            least = min(least, keeping.clearance(0.0, motion, (disc,), speed, enough=least))
        distance -= least
    return distance


GUARDED_PER_HOUR = 1.0
"""How often the discs of a vessel at constant velocity may reach farther than this allowance [1/h].
"""

_HOURS, _SEED = 20.0, 20261122
"""Flight time over which reports are drawn [h], and the seed: the same for every flight."""

_NO_OFTENER, _LEAST = 1.0, 100
"""Shortest mean interval of reports that counts [s], and least number of reports that are drawn
[-].
"""

_SETTLED = 50
"""Reports after which the filter's covariance no longer changes [-]."""


@functools.lru_cache(maxsize=64)
def scatter_allowance(
    limits: VesselLimits,
    known: FilterParameters,
    intervals: tuple[float, float],
    latency: float,
    *,
    plan_period: float,
    planned: float,
) -> float:
    """Return by how much a disc reaches farther than planned, ``GUARDED_PER_HOUR`` times an hour
    [m].

    It is evaluated just before each report, when the earlier reports are oldest. The disc that
    counts is the one of the newest discs that reaches least far in a direction from the filter's
    estimate of the vessel's place. Discs are compared at the end of a turn away.

    Parameters
    ----------
    limits, known : limits of the vessel and its reports, and the filter of the reports
    intervals, latency : shortest and longest time between reports, and their largest delay [s]
    plan_period : interval at which they are evaluated [s]
    planned : radius of the disc in the plan, at the end of a turn away [m]
    """
    generator = np.random.default_rng(_SEED)
    mean = mean_interval(intervals)
    shape = (max(_LEAST, round(_HOURS * SECONDS_PER_HOUR / mean)), KEPT)
    late = plan_period + generator.uniform(0.0, latency, (shape[0], 1))
    age = limits.horizon + late + np.cumsum(generator.uniform(*intervals, shape), axis=1)
    off = limits.position_sigma * generator.standard_normal(
        shape
    ) + limits.velocity_sigma * age * generator.standard_normal(shape)
    taken = _filter_sigma(known, mean) * generator.standard_normal(shape[0])
    reaches = np.min(radius_after(limits, age) + off, axis=1) - taken
    return max(
        0.0,
        float(np.quantile(reaches, max(0.0, 1.0 - GUARDED_PER_HOUR * mean / SECONDS_PER_HOUR)))
        - planned,
    )


def mean_interval(intervals: tuple[float, float]) -> float:
    """Return the mean interval [s] between reports, from the shortest and the longest; at least one
    second.
    """
    return max(_NO_OFTENER, 0.5 * sum(intervals))


def _filter_sigma(known: FilterParameters, interval: float) -> float:
    """Return the standard deviation of the vessel's place as the filter knows it, at the mean
    interval of its reports [m].
    """
    vessel = VesselFilter(known)
    for number in range(_SETTLED):
        vessel.report(VesselReport(number * interval, 0.0, 0.0, 0.0, 0.0))
    return vessel.at(_SETTLED * interval).sigma


_ALONG, _RIGHT, _COURSE, _TURN, _FASTER, _NOISE_ALONG, _NOISE_RIGHT = range(7)
"""Rows of the linear loop: true error [m], course [rad], heading rate [rad/s], speed [m/s], error
of the position [m].
"""

Array = npt.NDArray[np.float64]


def noise_allowance(seen: float, turned: float, *, time_step: float) -> float:
    """Return the level that the sum of both errors exceeds no more often than ``GUARDED_PER_HOUR``,
    as if they were new at each step [m]. A turn away comes nearest a quarter of a turn after it
    begins.

    Parameters
    ----------
    seen, turned : standard deviations of the visible error, and of the closest place of a turn away
        [m]
    time_step : of the guidance [s]
    """
    looks = SECONDS_PER_HOUR / time_step
    return math.hypot(seen, turned) * deviations(GUARDED_PER_HOUR, draws=looks)


def position_scatter(
    tracking: TrackingParameters,
    hold: SpeedHold,
    turns: Iterable[float],
    *,
    speed: float,
    lag: float,
    airspeed_bandwidth: float,
    noise_time: float,
) -> float:
    """Return the standard deviation of the visible error, per that of the noise, in the worst
    direction and turn [-].

    In axes along and across the reference's course, which turn at omega_r, the true error e and the
    error n of the position obey e_along' = -dV + omega_r e_right,
    e_right' = -V dchi - omega_r e_along and n' = -n/T + omega_r (n_right, -n_along) + noise of the
    density 2 sigma^2/T; the steering law and the airspeed act on e - n. Its covariance solves a
    Lyapunov equation.

    Parameters
    ----------
    tracking, hold : how the reference is tracked
    turns : heading rates of the reference [rad/s]
    speed : V_r [m/s]
    lag : of the heading rate behind its command [s]
    airspeed_bandwidth : of the airspeed behind its command [rad/s]
    noise_time : time constant T of the noise [s]
    """
    loops = [
        _loop(tracking, hold, turn, speed, lag, airspeed_bandwidth, noise_time) for turn in turns
    ]
    return max(map(_seen, loops))


def _loop(
    tracking: TrackingParameters,
    hold: SpeedHold,
    turn: float,
    speed: float,
    lag: float,
    bandwidth: float,
    noise_time: float,
) -> Array:
    gains = dict(zip(STEERED_BY, steering_gains(tracking, turn, speed).tolist(), strict=True))
    # A command that depends on the last one has converged.
    along, right, course, faster, rate = (
        gains[name] / (1.0 - gains["last"])
        for name in ("along", "right", "course", "speed", "heading_rate")
    )
    faster += gains["airspeed"] / (1.0 - gains["last"])
    loop = np.zeros((7, 7))
    loop[_ALONG, [_RIGHT, _FASTER]] = turn, -1.0
    loop[_RIGHT, [_ALONG, _COURSE]] = -turn, -speed
    loop[_COURSE, _TURN] = 1.0
    loop[_TURN] = np.array([along, right, course, rate - 1.0, faster, -along, -right]) / lag
    loop[_FASTER, [_ALONG, _NOISE_ALONG, _FASTER]] = (
        bandwidth * hold.gain,
        -bandwidth * hold.gain,
        -bandwidth,
    )
    loop[_NOISE_ALONG, [_NOISE_ALONG, _NOISE_RIGHT]] = -1.0 / noise_time, turn
    loop[_NOISE_RIGHT, [_NOISE_ALONG, _NOISE_RIGHT]] = -turn, -1.0 / noise_time
    return loop


def _seen(loop: Array) -> float:
    """Return the deviation of the error seen; 1 where the law does not track, and the vehicle is
    where its noise is not.
    """
    if np.linalg.eigvals(loop).real.max() >= 0.0:
        return 1.0
    kicks = np.zeros((7, 7))
    kicks[_NOISE_ALONG, _NOISE_ALONG] = kicks[_NOISE_RIGHT, _NOISE_RIGHT] = (
        -2.0 * loop[_NOISE_ALONG, _NOISE_ALONG]
    )
    covariance = solve_continuous_lyapunov(loop, -kicks)
    seen = np.zeros((2, 7))
    seen[[0, 1], [_ALONG, _RIGHT]], seen[[0, 1], [_NOISE_ALONG, _NOISE_RIGHT]] = 1.0, -1.0
    return math.sqrt(np.linalg.eigvalsh(seen @ covariance @ seen.T).max())


STEERED_BY = ("along", "right", "course", "speed", "airspeed", "heading_rate", "last")
"""The inputs of the steering law, as deviations from the reference's motion [m, m, rad, m/s, m/s,
rad/s, rad/s]: the error, the motion over the mean air, airspeed and heading rate as measured
against the gusty air, and the last command.
"""

_STEP = 1e-5

_STRAIGHT = 1e-6
"""Heading rate of a circle that is straight [rad/s]."""


def steering_gains(guidance: TrackingParameters, turn: float, speed: float) -> Array:
    """Return the commanded turn [rad/s] per unit of each of ``STEERED_BY``, on a reference that
    turns at ``turn`` [rad/s]: by differences on ``Tracker`` itself, preview included.

    Parameters
    ----------
    guidance : its parameters; its limit is not applied
    turn : omega_r, and heading rate of an aircraft that follows [rad/s]
    speed : V_r [m/s]
    """
    turn = turn if abs(turn) > _STRAIGHT else _STRAIGHT
    parameters = replace(guidance, heading_rate_max=np.inf)

    def command(
        along: float, right: float, course: float, over: float, air: float, rate: float, last: float
    ) -> float:
        reference = CirclingReference(speed=speed, heading_rate=turn, time_step=guidance.time_step)
        steered = Tracker(parameters, reference)
        steered.heading_rate_command = turn + last
        faster, airspeed = speed + over, speed + air
        turned = steered.step(
            -along, -right, course, faster, air_turn(turn + rate, speed=airspeed, airspeed=faster)
        )
        return air_turn(turned, speed=faster, airspeed=airspeed)

    steps = _STEP * np.eye(len(STEERED_BY))
    return np.array([(command(*step) - command(*(-step))) / (2.0 * _STEP) for step in steps])
