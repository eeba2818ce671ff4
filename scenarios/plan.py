"""From a scenario to flights: everything a flight needs, resolved to SI, and the reason where one cannot be flown."""

import math
from dataclasses import dataclass

import numpy as np

from gnc.delta import look_ahead
from gnc.guidance import GuidanceParameters, Law
from gnc.keepout_guard import KeepoutGuard
from gnc.oscillation import Oscillation, design_oscillation, heading_rate_for_bank
from gnc.placement import PlumeAxis, centre_of_oscillation, distance_by_paper, distance_exact
from gnc.reference import ReferenceStart, start_reference
from scenarios.config import Scenario
from scenarios.vessel import Vessel


@dataclass(frozen=True, slots=True, kw_only=True)
class FlightPlan:
    """One flight.

    Attributes
    ----------
    flight_id : unique in the run
    nu : speed ratio [-]
    seed : of this flight's start
    vessel : ship and plume
    oscillation, reference, phase : of the reference point
    centre_distance : r_CO [m]
    keepout_radius : r_min [m]
    altitude : commanded, that of the CO [m]
    guidance : parameters of the outer loop
    guard : of the keep-out area on the way to the reference, or none
    start_north, start_east, start_course : of the UAV [m, m, rad]
    crossings, duration_max, settling_band, log_interval : when to stop and what to record; the last in guidance steps
    """

    flight_id: str
    nu: float
    seed: int
    vessel: Vessel
    oscillation: Oscillation
    reference: ReferenceStart
    phase: float
    centre_distance: float
    keepout_radius: float
    altitude: float
    guidance: GuidanceParameters
    guard: KeepoutGuard | None
    start_north: float
    start_east: float
    start_course: float
    crossings: int
    duration_max: float
    settling_band: float
    log_interval: int


def plan_flight(scenario: Scenario, *, flight_id: str, nu: float, seed: int, lag: float) -> FlightPlan:
    """Resolve one flight of a scenario.

    Parameters
    ----------
    scenario, flight_id, nu : the flight
    seed : of its random start
    lag : of the inner loop's heading rate [s]

    Raises
    ------
    InfeasibleError : the flight has no solution
    """
    g = scenario.guidance
    speed = g.airspeed_mps
    axis = PlumeAxis(heading=math.radians(scenario.plume.heading_deg), elevation=math.radians(scenario.plume.elevation_deg))
    oscillation = design_oscillation(
        nu=nu,
        speed=speed,
        heading_rate_max=heading_rate_max(scenario),
        reserve=g.reserve,
        roll_rate_max=math.radians(g.roll_rate_max_deg_s),
    )
    vessel = Vessel(
        speed=nu * speed,
        course=math.radians(scenario.vessel.course_deg),
        plume_heading=axis.heading,
        plume_elevation=axis.elevation,
        source_height=scenario.plume.source_height_m,
    )
    rule = distance_by_paper if g.placement == "paper" else distance_exact
    distance = rule(oscillation, axis, scenario.keepout.radius_m + g.tracking_allowance_m)
    ahead, right, above = centre_of_oscillation(distance, axis)
    centre_north, centre_east = vessel.place_ned(ahead, right)
    phase = math.radians(g.phase_deg)
    north, east, course = _random_start(scenario, vessel, seed)
    return FlightPlan(
        flight_id=flight_id,
        nu=nu,
        seed=seed,
        vessel=vessel,
        oscillation=oscillation,
        reference=start_reference(
            oscillation, phase=phase, centre_north=centre_north, centre_east=centre_east, vessel_course=vessel.course
        ),
        phase=phase,
        centre_distance=distance,
        keepout_radius=scenario.keepout.radius_m,
        altitude=vessel.source_height + above,
        guidance=_guidance(scenario, lag),
        guard=_guard(scenario, vessel, above),
        start_north=north,
        start_east=east,
        start_course=course,
        crossings=scenario.flight.crossings,
        duration_max=scenario.flight.duration_max_s,
        settling_band=scenario.flight.settling_band_m,
        log_interval=round(g.rate_hz / scenario.flight.log_rate_hz),
    )


def heading_rate_max(scenario: Scenario) -> float:
    """Return omega_max [rad/s]."""
    g = scenario.guidance
    return g.heading_rate_max_rad_s or heading_rate_for_bank(math.radians(g.bank_deg), g.airspeed_mps)


def _guidance(scenario: Scenario, lag: float) -> GuidanceParameters:
    g = scenario.guidance
    return GuidanceParameters(
        law=Law(g.law),
        look_ahead=look_ahead(g.epsilon_per_m, g.look_ahead_m),
        gain=g.gain_per_s,
        rate_max=g.steering_max_rad_s,
        k_1=g.lyapunov_gain_per_m2,
        heading_rate_max=heading_rate_max(scenario),
        time_step=1.0 / g.rate_hz,
        lag=lag if g.preview else 0.0,
        guard_distance=g.guard_distance_m,
        airspeed_gain=g.airspeed_gain_per_s if g.airspeed_trim else 0.0,
        airspeed_trim_max=g.airspeed_trim_max_mps,
    )


def _guard(scenario: Scenario, vessel: Vessel, above: float) -> KeepoutGuard | None:
    """Return the guard of the disc that the keep-out sphere cuts out at ``above`` [m] over its centre, if any."""
    radius = scenario.keepout.radius_m + scenario.guidance.guard_margin_m
    if not scenario.guidance.keepout_guard or radius <= abs(above):
        return None
    velocity_north, velocity_east = vessel.velocity_ned
    return KeepoutGuard(
        north=0.0,
        east=0.0,
        velocity_north=velocity_north,
        velocity_east=velocity_east,
        radius=math.sqrt(radius**2 - above**2),
        heading_rate_max=heading_rate_max(scenario),
        speed=scenario.guidance.airspeed_mps,
    )


def _random_start(scenario: Scenario, vessel: Vessel, seed: int) -> tuple[float, float, float]:
    generator = np.random.default_rng(seed)
    distance = generator.uniform(*scenario.start.distance_m)
    spread = math.radians(scenario.start.spread_deg)
    bearing = math.pi + generator.uniform(-spread, spread)
    course = generator.uniform(-math.pi, math.pi)
    if scenario.start.course_deg is not None:
        course = math.radians(scenario.start.course_deg)
    north, east = vessel.place_ned(distance * math.cos(bearing), distance * math.sin(bearing))
    return north, east, course
