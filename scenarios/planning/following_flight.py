"""Flights whose reference is steered: beside a vessel that manoeuvres, in wind, by sensors and
reports.
"""

import math
from collections.abc import Callable

from gnc.airspeed import PaceHold
from gnc.errors import InfeasibleError
from gnc.estimation.error_budget import AS_COMMANDED, ErrorBudget
from gnc.estimation.health import HealthParameters
from gnc.estimation.vessel import ReachableSet, Tube, VesselLimits
from gnc.guard.guard import GuardParameters
from gnc.guidance import GuidanceParameters, ReportedVessel
from gnc.mission.follow import FollowingParameters
from gnc.mission.standoff import StandoffParameters
from gnc.reference.reference import Orbit, PeriodicPath
from scenarios.planning.air.estimated_wind import (
    first_known,
    navigation_parameters,
    wind_known_on_orbit,
)
from scenarios.planning.air.flown_heights import check_not_outrun
from scenarios.planning.bounded_steering import given_steering
from scenarios.planning.declared_vessel import check_vessel
from scenarios.planning.flight_plan import FlightPlan, Sensing
from scenarios.planning.guidance import (
    controlled_heading_rate,
    flight_errors,
    following_parameters,
    guard_parameters,
    guidance_lag,
    satellite_noise,
    speed_hold,
    thrust_test,
    tracking_parameters,
    turn_time,
)
from scenarios.planning.limits import omega_max, plan_period
from scenarios.planning.margin.keepout_margin import (
    KeepoutMargin,
    filter_parameters,
    tracking_level,
    vessel_limits,
    widest_tube,
)
from scenarios.planning.margin.orbit_room import circle_distance, orbit_distance
from scenarios.planning.margin.tracking_spread import SpreadTable
from scenarios.planning.plume.axis import axis_height, plume_axis
from scenarios.planning.plume.distance import additional_distance
from scenarios.planning.reference import orbits, oscillation_at, swing_of
from scenarios.planning.standoff import standoff_parameters, vessel_circle
from scenarios.planning.start import check_start, first_reports, sampled_start
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.sensors import SensorErrors
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.ais.track import AisVessel, usual_intervals
from scenarios.world.ais_reports import no_outage, received_reports
from scenarios.world.background import sampled_background
from scenarios.world.exhaust import exhaust_of
from scenarios.world.faults import VESSEL_DATA, sampled_fault
from scenarios.world.noise import BACKGROUND, EXHAUST, Noise, own_generator, streams
from scenarios.world.vessel import VesselTruth
from scenarios.world.weather import sampled_weather
from scenarios.world.world import (
    TRACK_MARGIN,
    ApparentWind,
    World,
    apparent_wind,
    mean_wind,
    place_of,
    plume_of,
    vessel_of,
)

Spreads = Callable[[Scenario], SpreadTable | None]
"""Returns the predicted spread of the tracking error of a scenario in turbulence; none in calm air.
"""


def following_flight(
    scenario: Scenario,
    flight_id: str,
    noise: Noise,
    setup: VehicleSetup,
    spreads: SpreadTable | None,
) -> FlightPlan:
    """Return a flight that follows a plume.

    Raises
    ------
    InfeasibleError : the vessel outruns the UAV, its plume has no direction, or the flight starts
        where no command keeps it out
    """
    g, f, flight = scenario.guidance, scenario.following, scenario.flight
    generators = streams(noise)
    vessel = vessel_of(scenario)
    scenario = _with_intervals(scenario, vessel)
    plume = plume_of(scenario, vessel)
    wind = apparent_wind(scenario, vessel)
    _check_plume(scenario, wind)
    nu = wind.at_start / g.airspeed_mps
    limits = vessel_limits(scenario, turn_time(scenario, setup.reversal))
    check_vessel(scenario, vessel, limits)
    sigma, level = tracking_level(scenario, spreads, nu)
    radius = scenario.keepout.radius_m
    air = mean_wind(scenario, vessel)
    turning = spreads.turning if spreads else AS_COMMANDED
    guarded = guard_parameters(
        scenario, setup, radius, flight_errors(scenario, setup, air, turning)
    )
    oscillation = oscillation_at(g, scenario.reference, nu)
    nearer = satellite_noise(scenario, setup, oscillation.amplitude)
    widest = widest_tube(limits, scenario.reports, plan_period=plan_period(g), noise=nearer)
    nearest = _nearest(scenario, setup, guarded, widest, oscillation)
    farthest = max(radius + f.margin_min_m, nearest) + level
    margin = KeepoutMargin(
        tracking_sigma=sigma, total=farthest - radius, reach=widest.reach(limits.horizon)
    )
    mission: FollowingParameters | StandoffParameters
    orbit: PeriodicPath
    if scenario.stands_off:
        orbit = circle = vessel_circle(scenario, nu, farthest)
        periods = circle.periods(f.speed_ratio_max)
        mission = standoff_parameters(scenario, setup, circle.radius, axis_height(scenario, vessel))
        climbed_to = circle.radius
    else:
        nearest, orbit = radius + margin.total + oscillation.half_widths()[0], oscillation
        further = additional_distance(scenario, vessel, nearest, wind.at_start)
        periods, mission = _following(scenario, setup, margin, vessel, further, guarded.errors)
        climbed_to = nearest + further
    check_not_outrun(scenario, vessel, air, climbed_to)
    start = sampled_start(
        scenario.start, generators.world, course=vessel.course(0.0), axis=plume.axis(0.0)
    )
    fault = sampled_fault(scenario.fault, generators.world)
    weather = sampled_weather(scenario, air, generators.world)
    covered = flight.duration_max_s + TRACK_MARGIN
    exhaust = exhaust_of(
        scenario,
        vessel,
        plume,
        weather.wind,
        duration=covered,
        generator=own_generator(noise, EXHAUST),
    )
    outage = (fault.begins, fault.ends) if fault.kind == VESSEL_DATA else no_outage()
    received = None
    if not scenario.vessel_known:
        duration = flight.duration_max_s
        received = received_reports(
            scenario.reports, vessel, duration=duration, outage=outage, generator=generators.reports
        )
    guard = guarded if g.keepout_guard else None
    # What the guard knows at the start: a report of a file may be minutes old by then, and any may
    # be wrong.
    known = ReachableSet(limits)
    for report in first_reports(vessel, received):
        known.report(report)
    check_start(
        start,
        guard,
        known.tubes(0.0),
        wind=air.now(0.0, scenario.altitude),
        known=first_known(scenario, setup),
        airspeed=g.airspeed_mps,
        keepout_radius=radius,
    )
    steps = round(flight.duration_max_s * g.rate_hz) + 2
    return FlightPlan.of(
        scenario,
        flight_id,
        nu=nu,
        guidance=_guidance(scenario, setup, mission, guard, limits),
        steering=given_steering(g),
        start=start,
        period=orbit.period,
        world=World(
            vessel=vessel,
            plume=plume,
            elevation=math.radians(scenario.plume.elevation_deg),
            source_height=scenario.source_height,
            weather=weather,
            fault=fault,
            exhaust=exhaust,
            background=sampled_background(scenario.air, covered, own_generator(noise, BACKGROUND)),
            place=place_of(scenario, vessel),
        ),
        sensing=Sensing(
            received=received,
            errors=SensorErrors(
                scenario.sensors,
                steps=steps,
                time_step=1.0 / g.rate_hz,
                generator=generators.sensors,
            ),
            reads_plume=f.plume == "estimated" or flight.until == "verdict",
            knows_axis=f.plume == "told",
        ),
        oscillation=orbit,
        periods=periods,
        margin=margin,
        apparent_wind=wind,
    )


def _nearest(
    scenario: Scenario,
    setup: VehicleSetup,
    guard: GuardParameters,
    widest: Tube,
    oscillation: Orbit,
) -> float:
    """Return the smallest distance of the orbit, or of the circle about the vessel, at which the
    guard does not act [m].
    """
    wind = wind_known_on_orbit(scenario, setup)
    if scenario.stands_off:
        drift = oscillation.nu * oscillation.speed
        return circle_distance(guard, widest, oscillation.speed, drift, wind=wind)
    return orbit_distance(guard, widest, oscillation, wind=wind)


def _following(
    scenario: Scenario,
    setup: VehicleSetup,
    margin: KeepoutMargin,
    vessel: VesselTruth,
    further: float,
    errors: ErrorBudget,
) -> tuple[tuple[float, ...], FollowingParameters]:
    """Return the periods of the orbit over nu [s], and how the plume is followed, ``further`` off
    [m].
    """
    # Before its orbits: a shape that cannot be steered says so, whatever else it cannot do beside a
    # fast vessel.
    swing = swing_of(scenario.guidance, scenario.reference)
    periods, widths = orbits(
        scenario.guidance, scenario.reference, scenario.following.speed_ratio_max
    )
    return periods, following_parameters(
        scenario,
        setup,
        margin,
        widths,
        plume_axis(scenario, vessel, setup.altitude_reach),
        swing=swing,
        vessel_course=vessel.course(0.0),
        additional_distance=further,
        errors=errors,
    )


def _guidance(
    scenario: Scenario,
    setup: VehicleSetup,
    mission: FollowingParameters | StandoffParameters,
    guard: GuardParameters | None,
    limits: VesselLimits,
) -> GuidanceParameters:
    g = scenario.guidance
    tracking, hold = tracking_parameters(scenario, setup), speed_hold(scenario, setup)
    thrust = thrust_test(scenario, setup)
    return GuidanceParameters(
        speed=g.airspeed_mps,
        altitude=scenario.altitude,
        tracking=tracking,
        airspeed_law=PaceHold(
            speed=g.airspeed_mps, hold=hold, turn_speed=setup.turning_airspeed(omega_max(g))
        ),
        airspeed_bandwidth=setup.airspeed_bandwidth,
        airspeed_overshoot=setup.airspeed_overshoot,
        navigation=navigation_parameters(scenario, setup),
        vessel=ReportedVessel(filter=filter_parameters(scenario.reports), limits=limits),
        guard=guard,
        mission=mission,
        health=HealthParameters(
            thrust=thrust.parameters if thrust else None,
            heading_rate_max=controlled_heading_rate(g),
            lag=guidance_lag(scenario, setup),
            time_step=tracking.time_step,
        ),
    )


def _with_intervals(scenario: Scenario, vessel: VesselTruth) -> Scenario:
    """Return the scenario with the usual intervals of the reports of a track from a file, unless it
    gives others.
    """
    if not isinstance(vessel, AisVessel) or not scenario.reports.exact:
        return scenario
    reports = scenario.reports.model_copy(update={"interval_s": usual_intervals(vessel)})
    return scenario.model_copy(update={"reports": reports})


def _check_plume(scenario: Scenario, wind: ApparentWind) -> None:
    """Raise an InfeasibleError where the scenario implies that no plume can be crossed."""
    f, speed = scenario.following, scenario.guidance.airspeed_mps
    if wind.greatest >= f.speed_ratio_max * speed:
        raise InfeasibleError(
            f"the vessel moves at up to {wind.greatest:.1f} m/s through the air, nu = {wind.greatest / speed:.2f}; the UAV at"
            f" {speed:g} m/s follows up to nu = {f.speed_ratio_max:g}: fly faster, or in less apparent wind"
        )
    if scenario.plume_by_wind and wind.at_start < f.apparent_wind_min_mps:
        # Exhaust trails with the wind, whatever direction the plume is given.
        given = (
            ", or the plume a direction (plume.direction=given)"
            if scenario.emission.ship is None
            else ""
        )
        raise InfeasibleError(
            f"the apparent wind is {wind.at_start:.2f} m/s; below {f.apparent_wind_min_mps:g} m/s the plume has no direction:"
            f" give wind or vessel another speed{given}"
        )
