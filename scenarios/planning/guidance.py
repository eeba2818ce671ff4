"""From a scenario to the parameters of the guidance, in SI: law, look-ahead, guard, speed hold,
approach, and the test of the thrust.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from aircraft.faults import OF_THRUST
from aircraft.weather import TURBULENCE, low_altitude_turbulence
from aircraft.wind import WindField
from common.physics import heading_rate_for_bank
from gnc.airspeed import SpeedHold, design_speed_hold
from gnc.analysis.bounds import BoundedSteering, fastest_within, heading_rate_bound
from gnc.errors import InfeasibleError
from gnc.estimation.error_budget import Bias, ErrorBudget, TurnDeviation
from gnc.estimation.health import CHECK_INTERVAL
from gnc.estimation.navigation import NOISE_DEVIATIONS
from gnc.guard.guard import GuardParameters
from gnc.laws import STEERING_LAWS
from gnc.mission.axis import AxisParameters
from gnc.mission.follow import FollowingParameters
from gnc.mission.way import ApproachParameters
from gnc.paper import LookAhead, look_ahead
from gnc.reference.moving_centre import CentreParameters
from gnc.reference.reference import Swing
from gnc.steering import SteeringLaw
from gnc.tracker import TrackingParameters
from innerloop.flight.part_failure import PartFailure, glide_airspeed
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.planning.air.errors import error_budget
from scenarios.planning.air.wind import climbs, glides
from scenarios.planning.limits import omega_max, plan_interval
from scenarios.planning.margin.keepout_margin import (
    KeepoutMargin,
    noise_allowance,
    position_scatter,
)
from scenarios.planning.reference import shape_of
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.guidance import GuidanceConfig
from scenarios.vehicles.sensors import NAVIGATION_TIME
from scenarios.vehicles.thrust_expectation import ThrustTest
from scenarios.vehicles.vehicle_setup import VehicleSetup


@dataclass(frozen=True, slots=True, kw_only=True)
class Steering:
    """Parameters of the cascade law, eq. (30).

    Attributes
    ----------
    look_ahead : epsilon [1/m] and R [m]
    steering_max : largest |h(phi)| [rad/s]
    bound : on the law's demand in any state [rad/s]; infinite for a law without a bound
    """

    look_ahead: LookAhead
    steering_max: float
    bound: float


def steering_law(guidance: GuidanceConfig, **searched: float) -> SteeringLaw:
    """Return the steering law of a scenario with its given parameters or, where a search found
    them, with those.
    """
    given = guidance.model_extra or {}
    law: Any = STEERING_LAWS.get(guidance.law)
    values = {
        name: searched.get(name, getattr(guidance, name, given.get(name, default)))
        for name, default in guidance.law_keys.items()
    }
    try:
        made: SteeringLaw = law(**values)
    except ValueError as error:
        raise InfeasibleError(f"guidance of law '{guidance.law}': {error}") from None
    return made


def given_steering(guidance: GuidanceConfig) -> Steering:
    """Return the steering that a scenario gives, without a bound."""
    parameters = look_ahead(guidance.epsilon_per_m, guidance.look_ahead_m)
    return Steering(look_ahead=parameters, steering_max=guidance.steering_max_rad_s, bound=math.inf)


def plan_steering(
    scenario: Scenario, heading_rate_max: float, reference_heading_rate: float
) -> Steering:
    """Return the steering of a flight.

    Parameters
    ----------
    scenario : its parameters
    heading_rate_max : omega_max [rad/s]
    reference_heading_rate : largest |omega_r| of the reference [rad/s]

    Raises
    ------
    InfeasibleError : the parameters cannot work, or no parameters respect omega_max
    """
    g, speed = scenario.guidance, largest_speed(scenario)
    if g.tuning == "bounded":
        found = search_steering(scenario, heading_rate_max, reference_heading_rate)
        return Steering(
            look_ahead=found.look_ahead, steering_max=found.steering_max, bound=found.bound
        )
    given = given_steering(g)
    if g.law != "cascade":
        return given
    bound = heading_rate_bound(
        given.look_ahead,
        speed=speed,
        reference_heading_rate_max=reference_heading_rate,
        steering_max=g.steering_max_rad_s,
    )
    return replace(given, bound=bound)


def search_steering(
    scenario: Scenario, heading_rate_max: float, reference_heading_rate: float
) -> BoundedSteering:
    """Return the steering that converges fastest from the farthest start, with no demand above
    omega_max in any state.

    Parameters and errors are those of ``plan_steering``.
    """
    try:
        return fastest_within(
            speed=largest_speed(scenario),
            heading_rate_max=heading_rate_max,
            reference_heading_rate_max=reference_heading_rate,
            distance_from=farthest_start(scenario),
            distance_to=scenario.flight.settling_band_m,
            gain=scenario.guidance.gain_per_s,
        )
    except InfeasibleError as error:
        raise InfeasibleError(
            f"guidance.tuning is 'bounded' with guidance.reserve {scenario.guidance.reserve:g}:"
            f" {error} (guidance.reserve)"
        ) from None


def largest_speed(scenario: Scenario) -> float:
    """Return the largest speed of vehicle and reference [m/s] for which the bound holds.

    It is the largest commanded speed, plus a margin where an aircraft has to follow the command.
    """
    g = scenario.guidance
    margin = g.bound_speed_margin_mps if scenario.fidelity == "six_dof" else 0.0
    return g.airspeed_mps + (g.airspeed_trim_max_mps if g.airspeed_trim else 0.0) + margin


def farthest_start(scenario: Scenario) -> float:
    """Return the approximate largest distance of a start from the reference [m]: that from the
    vessel.
    """
    start = scenario.start
    if start.place_m is not None:
        distance = math.hypot(*start.place_m)
    elif start.range_m is not None:
        distance = start.range_m
    else:
        distance = start.distance_m[1]
    return max(distance, 10.0 * scenario.flight.settling_band_m)


STALE_MIN = 2.0
"""Shortest age at which vessel data count as stale [s]."""

TRANSIT_FRACTION = 0.5
"""Fraction of the airspeed beyond V_r that is used on the way to the reference [-]."""

CONTROLLED_BANK = math.radians(17.0)
"""Bank whose heading rate replaces a smaller omega_max in the criterion for lost control, which is
a share of that rate [rad].

Moderate turbulence turns a sound aircraft at 0.07 rad/s, at 19 m/s, which exceeds that share at 5
degrees of bank.
"""

ROUND_BY = 0.8
"""Distance between a way round the keep-out area and the blocked area, in turn radii [-]."""


def thrust_test(scenario: Scenario, setup: VehicleSetup) -> ThrustTest | None:
    """Return the test for a loss of thrust; None for a vehicle without an engine, or one whose
    accelerometers cannot detect it in the declared gusts.
    """
    if setup.thrust is None:
        return None
    sensors, airspeed = scenario.sensors, scenario.guidance.airspeed_mps
    return setup.thrust.test(
        airspeed,
        glide_airspeed(airspeed, setup.airspeed_min),
        gusts=_gusts(scenario),
        airspeed_sigma=sensors.airspeed_sigma_mps,
        airspeed_bias=sensors.airspeed_bias_mps,
    )


def _gusts(scenario: Scenario) -> float:
    """Return the standard deviation of gusts along the path [m/s]; a discrete gust counts as
    several.
    """
    air = scenario.turbulence
    sigma = air.gust_speed_mps / NOISE_DEVIATIONS
    if air.level == "none":
        return sigma
    turbulence = low_altitude_turbulence(scenario.source_height, TURBULENCE[air.level].wind_at_20ft)
    return math.hypot(sigma, turbulence.horizontal)


def slowest_without_thrust(scenario: Scenario, setup: VehicleSetup) -> float:
    """Return the airspeed to which the vehicle may fall in a turn at V_r after its engine has
    failed [m/s].

    The airspeed falls until the failure is detected, which may take until the engine has run down;
    then on to the airspeed of the glide, and below it during the pushover. A stuck throttle reduces
    thrust less, but counts the same. The result is infinite where neither fault is declared.

    Raises
    ------
    InfeasibleError : such a fault is declared, and could not be detected in the declared gusts
    """
    failure, airspeed = part_failure(scenario, setup), scenario.guidance.airspeed_mps
    if failure is None or not scenario.declared_faults & OF_THRUST:
        return math.inf
    test = thrust_test(scenario, setup)
    if test is None:
        raise InfeasibleError(
            f"in gusts of {_gusts(scenario):.1f} m/s accelerometers do not show whether the engine"
            " has failed (turbulence.level, turbulence.gust_speed_mps, sensors.airspeed_bias_mps):"
            " declare less of them, or no failure of the engine (fault.declared)"
        )
    known = test.detection_time + 0.5 * test.parameters.model.spool_time
    fallen = airspeed - failure.airspeed_fall * known
    glide = glide_airspeed(airspeed, setup.airspeed_min)
    return min(fallen, glide) - failure.airspeed_fall * CHECK_INTERVAL - failure.glide_undershoot


def part_failure(scenario: Scenario, setup: VehicleSetup) -> PartFailure | None:
    """Return the effect of the failure of a part on the vehicle; None where the scenario declares
    no such failure.
    """
    if not (scenario.follows and glides(scenario)):
        return None
    return setup.failing_climbing if climbs(scenario) else setup.failing_level


def controlled_heading_rate(guidance: GuidanceConfig) -> float:
    """Return the heading rate of the criterion for lost control, which is a share of it [rad/s]."""
    return max(omega_max(guidance), heading_rate_for_bank(CONTROLLED_BANK, guidance.airspeed_mps))


def tracking_parameters(
    scenario: Scenario, setup: VehicleSetup, steering: Steering | None = None
) -> TrackingParameters:
    """Return the tracking parameters of a scenario, with the given steering unless a search found
    another.
    """
    g, time_step = scenario.guidance, 1.0 / scenario.guidance.rate_hz
    epsilon, radius = (steering or given_steering(g)).look_ahead
    steering_max = steering.steering_max if steering else g.steering_max_rad_s
    return TrackingParameters(
        law=steering_law(
            g, epsilon_per_m=epsilon, look_ahead_m=radius, steering_max_rad_s=steering_max
        ),
        heading_rate_max=omega_max(g) if g.command_limit else math.inf,
        time_step=time_step,
        # Commands are held for a step: half of it is lag.
        lag=guidance_lag(scenario, setup) if g.preview else 0.0,
    )


def guidance_lag(scenario: Scenario, setup: VehicleSetup) -> float:
    """Return the lag of the vehicle's heading rate behind the guidance [s]: the vehicle's lag, and
    half a step of holding commands.
    """
    return setup.lag + 0.5 / scenario.guidance.rate_hz


def guard_parameters(
    scenario: Scenario, setup: VehicleSetup, radius: float, errors: ErrorBudget | None = None
) -> GuardParameters:
    """Return the guard that keeps a radius from every possible place of the vessel.

    Parameters
    ----------
    scenario, setup : the flight, and its vehicle
    radius : to keep [m]
    errors : error budget; None where everything but the vehicle's response is known exactly
    """
    budget = errors or ErrorBudget(response=Bias(size=setup.response_error))
    return GuardParameters(
        radius=radius + budget.failed_part.size,
        heading_rate_max=omega_max(scenario.guidance),
        lag=setup.reversal.lag,
        delay=setup.reversal.delay,
        slow_lag=setup.lag,
        time_step=1.0 / scenario.guidance.rate_hz,
        errors=budget,
        turn_speed=setup.turning_airspeed(omega_max(scenario.guidance)),
    )


def flight_errors(
    scenario: Scenario, setup: VehicleSetup, wind: WindField, turning: TurnDeviation
) -> ErrorBudget:
    """Return the error budget of a flight beside a vessel.

    Parameters
    ----------
    scenario, setup : the flight, and its vehicle
    wind : mean wind of the flight
    turning : deviation of a turn from its commands by turbulence
    """
    failure = part_failure(scenario, setup)
    return error_budget(
        scenario,
        setup,
        wind,
        turn=turn_time(scenario, setup.reversal),
        turning=turning,
        slowest=slowest_without_thrust(scenario, setup),
        failed_part=failure.glide_deviation if failure else 0.0,
    )


def turn_time(scenario: Scenario, reversal: TurnReversalResponse) -> float:
    """Return the time of half a turn, including its beginning [s]: that of a turn away."""
    return math.pi / omega_max(scenario.guidance) + reversal.delay + reversal.lag


def satellite_noise(scenario: Scenario, setup: VehicleSetup, fastest: float) -> float:
    """Return how much nearer noise of satellite navigation may take a vehicle [m], for a reference
    that turns at up to a rate [rad/s].
    """
    if not scenario.reports.exact:
        # Compared with the scatter of reports it adds only centimetres.
        return 0.0
    noise, share = scenario.sensors, 0.0
    tracking = tracking_parameters(scenario, setup)
    if noise.position_sigma_m > 0.0:
        share = position_scatter(
            tracking,
            speed_hold(scenario, setup),
            (-fastest, 0.0, fastest),
            speed=scenario.guidance.airspeed_mps,
            lag=guidance_lag(scenario, setup),
            airspeed_bandwidth=setup.airspeed_bandwidth,
            noise_time=NAVIGATION_TIME,
        )
    quarter = (
        0.5 * math.pi / omega_max(scenario.guidance) + setup.reversal.delay + setup.reversal.lag
    )
    return noise_allowance(
        share * noise.position_sigma_m,
        quarter * noise.velocity_sigma_mps,
        time_step=tracking.time_step,
    )


def speed_hold(scenario: Scenario, setup: VehicleSetup) -> SpeedHold:
    """Return the parameters by which a scenario's flights keep pace with a steered reference."""
    return design_speed_hold(
        bandwidth=setup.airspeed_bandwidth,
        speed=scenario.guidance.airspeed_mps,
        look_ahead=scenario.guidance.look_ahead_m,
        airspeed_min=setup.airspeed_min,
        airspeed_max=setup.airspeed_max,
    )


def approach_parameters(
    scenario: Scenario, setup: VehicleSetup, radius: float
) -> ApproachParameters:
    """Return the way to the centre of oscillation, round a keep-out area of some radius [m]."""
    g, f, fastest = scenario.guidance, scenario.following, omega_max(scenario.guidance)
    airspeed = g.airspeed_mps + TRANSIT_FRACTION * (setup.airspeed_max - g.airspeed_mps)
    return ApproachParameters(
        blocked_radius=radius,
        round_radius=radius + ROUND_BY * g.airspeed_mps / fastest,
        join_distance=f.join_distance_m,
        tracked=f.tracked_m,
        airspeed=min(airspeed, setup.turning_airspeed(fastest)),
    )


def following_parameters(
    scenario: Scenario,
    setup: VehicleSetup,
    margin: KeepoutMargin,
    widths: Sequence[tuple[float, float]],
    axis: AxisParameters,
    *,
    swing: Swing,
    vessel_course: float,
    additional_distance: float,
    errors: ErrorBudget,
) -> FollowingParameters:
    """Return the parameters of following the plume of a moving vessel.

    Parameters
    ----------
    scenario, setup : the flight, and its vehicle
    margin : of the keep-out area
    widths : half-widths of the orbit along and across its course, at equal steps of nu from 0 [m]
    axis : how the plume's axis is known
    swing : courses of the reference, by its shape
    vessel_course : at the start [rad]
    additional_distance : distance from the vessel in excess of that which keeps out [m]
    errors : of the flight
    """
    g, f, reports = scenario.guidance, scenario.following, scenario.reports
    fastest, radius = omega_max(g), scenario.guarded_radius
    centre = CentreParameters(
        distance_min=radius + margin.total + additional_distance,
        speed_ratio_max=f.speed_ratio_max,
        along=tuple(along for along, _ in widths),
        across=tuple(across for _, across in widths),
        plume_heading=None if scenario.plume_by_wind else math.radians(scenario.plume.heading_deg),
        vessel_course=vessel_course,
        apparent_wind_min=f.apparent_wind_min_mps,
        speed=g.airspeed_mps,
        heading_rate_max=fastest,
    )
    return FollowingParameters(
        centre=centre,
        reference_heading_rate=(1.0 - g.reserve) * fastest,
        swing=swing,
        turn_rate_fraction_until_tracked=shape_of(
            scenario.reference
        ).turn_rate_fraction_until_tracked,
        speed_ratio_max=f.speed_ratio_max,
        approach=approach_parameters(scenario, setup, radius + margin.total),
        standoff=f.standoff_m,
        glide_airspeed=glide_airspeed(g.airspeed_mps, setup.airspeed_min),
        stale=max(STALE_MIN, reports.interval_s[1] + reports.latency_max_s),
        reach=margin.reach,
        reach_time=turn_time(scenario, setup.reversal),
        errors=errors,
        plan_interval=plan_interval(g),
        axis=axis,
    )
