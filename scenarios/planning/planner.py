"""From a scenario to flights: everything a flight needs, resolved to SI, and the reason where one cannot be flown."""

import math
from dataclasses import dataclass

import numpy as np

from gnc.errors import InfeasibleError
from gnc.reference.circling import CirclingReference
from gnc.reference.placement import PlumeAxis, centre_of_oscillation, distance_by_paper, distance_exact
from gnc.reference.reference import Orbit, Reference, ReferenceStart
from gnc.safety.keepout_guard import KeepoutGuard
from gnc.tracker import GuidanceParameters
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.planning.bounded_steering import Steering, plan_steering, steering_law
from scenarios.planning.limits import omega_max
from scenarios.planning.reference import oscillation_at, shape_of_reference
from scenarios.schema.config import Scenario
from scenarios.world.steady_vessel import Vessel

_GUARD_SHARE = 0.75
"""The guard keeps this share of the tracking allowance beyond r_min: what an aircraft does that the guard does not predict [-]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Mission:
    """What a flight is for: plume crossings, outside a keep-out area.

    Attributes
    ----------
    nu : speed ratio [-]
    vessel : ship and plume
    oscillation : of the reference point
    centre_distance : r_CO [m]
    keepout_radius : r_min [m]
    guard : of the keep-out area, as it is at the start, or none
    crossings : to be flown after settling
    """

    nu: float
    vessel: Vessel
    oscillation: Orbit
    centre_distance: float
    keepout_radius: float
    guard: KeepoutGuard | None
    crossings: int


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightPlan:
    """One flight: a reference to track, from a start.

    Attributes
    ----------
    flight_id : unique in the run
    mission : or none, where there is a reference to track and nothing else
    reference : at time 0
    guidance : parameters of the outer loop
    heading_rate_max : omega_max, whether commands are cut at it or not [rad/s]
    steering : look-ahead and limits of the delta formulation, which every time history shows
    altitude : commanded [m]
    start_north, start_east, start_course : of the UAV [m, m, rad]
    duration_max, settling_band, log_interval : when to stop and what to record; the last in guidance steps
    """

    flight_id: str
    mission: Mission | None
    reference: Reference
    guidance: GuidanceParameters
    heading_rate_max: float
    steering: Steering
    altitude: float
    start_north: float
    start_east: float
    start_course: float
    duration_max: float
    settling_band: float
    log_interval: int


def plan_flight(
    scenario: Scenario, *, flight_id: str, nu: float, seed: int, lag: float, reversal: TurnReversalResponse | None = None
) -> FlightPlan:
    """Resolve one flight of a scenario.

    Parameters
    ----------
    scenario, flight_id, nu : the flight; a circle has no use for nu
    seed : of its random start
    lag : of the vehicle's heading rate, half a step of holding commands included [s]
    reversal : how its heading rate follows a reversal of the turn; with that lag alone if not given

    Raises
    ------
    InfeasibleError : the flight has no solution, or starts where no command keeps it out of the keep-out area
    """
    time_step = 1.0 / scenario.guidance.rate_hz
    if scenario.reference.path == "circle":
        mission, altitude = None, scenario.plume.source_height_m
        reference: Reference = _circle(scenario, time_step)
        heading_rate = reference.heading_rate
        vessel = Vessel(speed=0.0, course=0.0, plume_heading=math.pi, plume_elevation=0.0, source_height=altitude)
    else:
        turning = reversal or TurnReversalResponse(delay=0.0, lag=max(0.0, lag - 0.5 * time_step))
        mission, centre = _mission(scenario, nu, turning)
        vessel, heading_rate = mission.vessel, mission.oscillation.amplitude
        altitude = vessel.source_height + centre[2]
        reference = _oscillating(scenario, mission, centre, time_step)
    steering = plan_steering(scenario, omega_max(scenario.guidance), heading_rate)
    north, east, course = _start(scenario, vessel, seed)
    if mission:
        _check_start(scenario, mission, north, east, course)
    return FlightPlan(
        flight_id=flight_id,
        mission=mission,
        reference=reference,
        guidance=_guidance(scenario, steering, lag),
        heading_rate_max=omega_max(scenario.guidance),
        steering=steering,
        altitude=altitude,
        start_north=north,
        start_east=east,
        start_course=course,
        duration_max=scenario.flight.duration_max_s,
        settling_band=scenario.flight.settling_band_m,
        log_interval=round(scenario.guidance.rate_hz / scenario.flight.log_rate_hz),
    )


def _mission(scenario: Scenario, nu: float, turning: TurnReversalResponse) -> tuple[Mission, tuple[float, float, float]]:
    """Return the mission, and its CO ahead of, right of and above the plume's origin [m]."""
    g = scenario.guidance
    axis = PlumeAxis(heading=math.radians(scenario.plume.heading_deg), elevation=math.radians(scenario.plume.elevation_deg))
    oscillation = oscillation_at(scenario.guidance, nu)
    vessel = Vessel(
        speed=nu * g.airspeed_mps,
        course=math.radians(scenario.vessel.course_deg),
        plume_heading=axis.heading,
        plume_elevation=axis.elevation,
        source_height=scenario.plume.source_height_m,
    )
    rule = distance_by_paper if g.placement == "paper" else distance_exact
    distance = rule(oscillation, axis, scenario.keepout.radius_m + g.tracking_allowance_m)
    centre = centre_of_oscillation(distance, axis)
    mission = Mission(
        nu=nu,
        vessel=vessel,
        oscillation=oscillation,
        centre_distance=distance,
        keepout_radius=scenario.keepout.radius_m,
        guard=_guard(scenario, centre[2], turning),
        crossings=scenario.flight.crossings,
    )
    return mission, centre


def _oscillating(scenario: Scenario, mission: Mission, centre: tuple[float, float, float], time_step: float) -> Reference:
    north, east = mission.vessel.place_ned(centre[0], centre[1])
    return shape_of_reference().reference(
        mission.oscillation,
        phase=math.radians(scenario.guidance.phase_deg),
        centre_north=north,
        centre_east=east,
        vessel_course=mission.vessel.course,
        time_step=time_step,
    )


def _circle(scenario: Scenario, time_step: float) -> CirclingReference:
    speed, radius = scenario.guidance.airspeed_mps, scenario.reference.radius_m
    least = speed / omega_max(scenario.guidance)
    if radius < least:
        raise InfeasibleError(
            f"reference.radius_m is {radius:g} m; at {speed:g} m/s and omega_max = {speed / least:.3f} rad/s it must be at least"
            f" {least:.1f} m: widen the circle or raise omega_max"
        )
    start = ReferenceStart(north=0.0, east=0.0, course=0.0)
    return CirclingReference(start, speed=speed, heading_rate=speed / radius, time_step=time_step)


def _guidance(scenario: Scenario, steering: Steering, lag: float) -> GuidanceParameters:
    """Return the parameters of the outer loop."""
    g = scenario.guidance
    epsilon, radius = steering.look_ahead
    return GuidanceParameters(
        law=steering_law(g, epsilon_per_m=epsilon, look_ahead_m=radius, steering_max_rad_s=steering.steering_max),
        heading_rate_max=omega_max(scenario.guidance) if g.command_limit else math.inf,
        time_step=1.0 / g.rate_hz,
        lag=lag if g.preview else 0.0,
        airspeed_gain=g.airspeed_gain_per_s if g.airspeed_trim else 0.0,
        airspeed_trim_max=g.airspeed_trim_max_mps,
    )


def _guard(scenario: Scenario, above: float, turning: TurnReversalResponse) -> KeepoutGuard | None:
    """Return the guard of the disc that the keep-out sphere cuts out at ``above`` [m] over its centre, if any."""
    radius = scenario.keepout.radius_m + _GUARD_SHARE * scenario.guidance.tracking_allowance_m
    if not scenario.guidance.keepout_guard or radius <= abs(above):
        return None
    return KeepoutGuard(
        radius=math.sqrt(radius**2 - above**2),
        heading_rate_max=omega_max(scenario.guidance),
        lag=turning.lag,
        delay=turning.delay,
        time_step=1.0 / scenario.guidance.rate_hz,
    )


def _check_start(scenario: Scenario, mission: Mission, north: float, east: float, course: float) -> None:
    """Refuse a start from which no command keeps the aircraft out of the keep-out area."""
    if mission.guard is None:
        return
    clearance = mission.guard.clearance(north, east, *mission.vessel.velocity_ned, course, scenario.guidance.airspeed_mps, 0.0)
    if clearance < 0.0:
        raise InfeasibleError(
            f"the start lies {math.hypot(north, east):.1f} m from the vessel on course {math.degrees(course):.0f} deg, where the"
            f" best turn away is {-clearance:.1f} m short of keepout.radius_m, {scenario.keepout.radius_m:g} m, and what the guard"
            " adds; start farther away (start.distance_m) or on another course (start.course_deg)"
        )


def _start(scenario: Scenario, vessel: Vessel, seed: int) -> tuple[float, float, float]:
    """Return north, east [m] and course [rad] of the UAV's start: given, or drawn in the vessel's frame."""
    generator = np.random.default_rng(seed)
    distance = generator.uniform(*scenario.start.distance_m)
    spread = math.radians(scenario.start.spread_deg)
    bearing = math.pi + generator.uniform(-spread, spread)
    course = generator.uniform(-math.pi, math.pi)
    if scenario.start.course_deg is not None:
        course = math.radians(scenario.start.course_deg)
    place = scenario.start.place_m or (distance * math.cos(bearing), distance * math.sin(bearing))
    north, east = vessel.place_ned(*place)
    return north, east, course
