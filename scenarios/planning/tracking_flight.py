"""Flights that track the paper's reference, which is known in advance: beside a steady vessel in
still air, or on a circle.
"""

import math

from gnc.airspeed import AlongTrackTrim
from gnc.estimation.vessel import Tube
from gnc.guard.guard import GuardParameters
from gnc.guidance import GuidanceParameters
from gnc.mission.mission import Centre
from gnc.mission.track import DirectParameters, Joining
from gnc.paper import PlumeAxis, centre_of_oscillation
from scenarios.planning.bounded_steering import Steering, plan_steering
from scenarios.planning.flight_plan import FlightPlan
from scenarios.planning.guidance import approach_parameters, guard_parameters, tracking_parameters
from scenarios.planning.limits import omega_max, plan_interval
from scenarios.planning.margin.orbit_room import orbit_distance
from scenarios.planning.reference import circle, distance_kept, joined_orbit, oscillation_at
from scenarios.planning.start import check_start, placed, sampled_start
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.faults import NO_FAULT
from scenarios.world.noise import Noise, start_generator
from scenarios.world.weather import STILL_AIR
from scenarios.world.world import World, place_of, plume_of, vessel_of


def circling_flight(
    scenario: Scenario, flight_id: str, noise: Noise, setup: VehicleSetup
) -> FlightPlan:
    """Return a flight that tracks a circle, without a vessel.

    Raises
    ------
    InfeasibleError : the circle is too tight
    """
    reference = circle(scenario)
    steering = plan_steering(scenario, omega_max(scenario.guidance), reference.heading_rate)
    altitude = scenario.source_height
    return FlightPlan.of(
        scenario,
        flight_id,
        guidance=_guidance(
            scenario, setup, steering, DirectParameters(reference=reference), altitude=altitude
        ),
        steering=steering,
        start=sampled_start(scenario.start, start_generator(noise), course=0.0, axis=math.pi),
        period=2.0 * math.pi / reference.heading_rate,
    )


def tracking_flight(
    scenario: Scenario, flight_id: str, noise: Noise, setup: VehicleSetup
) -> FlightPlan:
    """Return a flight beside a steady vessel that is known exactly, in still air.

    Raises
    ------
    InfeasibleError : the vessel outruns the UAV, or the flight starts where no command keeps it out
        of the keep-out area
    """
    g, radius = scenario.guidance, scenario.keepout.radius_m
    vessel = vessel_of(scenario)
    plume = plume_of(scenario, vessel)
    course, (_, _, v_north, v_east) = vessel.course(0.0), vessel.motion(0.0)
    nu = scenario.nu_over_ground
    oscillation = oscillation_at(g, scenario.reference, nu)
    axis = PlumeAxis(
        heading=math.radians(scenario.plume.heading_deg),
        elevation=math.radians(scenario.plume.elevation_deg),
    )
    distance = distance_kept(g, scenario.keepout, oscillation, axis)
    ahead, right, above = centre_of_oscillation(distance, axis)
    steering = plan_steering(scenario, omega_max(g), oscillation.amplitude)
    start = sampled_start(
        scenario.start, start_generator(noise), course=course, axis=plume.axis(0.0)
    )
    guard = None
    # The disc that the keep-out area cuts out at the height of the flight, or lower if the aircraft
    # sinks in a turn.
    lowest = max(0.0, abs(above) - setup.altitude_error)
    disc = (
        radius
        if scenario.keepout.shape == "cylinder"
        else math.sqrt(max(0.0, radius**2 - lowest**2))
    )
    if g.keepout_guard and disc > 0.0:
        guard = guard_parameters(scenario, setup, disc)
        known = Tube(0.0, 0.0, 0.0, v_north, v_east)
        # The guard must leave the orbit alone, and what the UAV may stray from it: an orbit that
        # lies nearer moves off.
        nearest = math.hypot(ahead, right) - oscillation.half_widths()[0] - g.tracking_allowance_m
        needed = orbit_distance(
            guard, known, oscillation, (math.cos(axis.heading), math.sin(axis.heading))
        )
        distance += max(0.0, needed - nearest) / math.cos(axis.elevation)
        ahead, right, above = centre_of_oscillation(distance, axis)
        check_start(
            start, guard, (known,), wind=(0.0, 0.0), airspeed=g.airspeed_mps, keepout_radius=radius
        )
    orbit = joined_orbit(scenario, oscillation, course)
    joining = None
    if g.approach:
        approach = approach_parameters(scenario, setup, disc)
        joining = Joining(
            approach=approach, orbit=orbit, plan_interval=plan_interval(scenario.guidance)
        )
    mission = DirectParameters(
        reference=orbit.reference(math.radians(g.phase_deg), *placed(ahead, right, course)),
        centre=Centre(*placed(ahead, right, course), nu),
        joining=joining,
    )
    return FlightPlan.of(
        scenario,
        flight_id,
        nu=nu,
        guidance=_guidance(
            scenario,
            setup,
            steering,
            mission,
            altitude=scenario.source_height + above,
            vessel=(v_north, v_east),
            guard=guard,
        ),
        steering=steering,
        start=start,
        period=oscillation.period,
        world=World(
            vessel=vessel,
            plume=plume,
            elevation=axis.elevation,
            source_height=scenario.source_height,
            weather=STILL_AIR,
            fault=NO_FAULT,
            place=place_of(scenario, vessel),
        ),
        oscillation=oscillation,
        centre_distance=distance,
    )


def _guidance(
    scenario: Scenario,
    setup: VehicleSetup,
    steering: Steering,
    mission: DirectParameters,
    *,
    altitude: float,
    vessel: tuple[float, float] = (0.0, 0.0),
    guard: GuardParameters | None = None,
) -> GuidanceParameters:
    g = scenario.guidance
    trim = AlongTrackTrim(
        speed=g.airspeed_mps,
        gain=g.airspeed_gain_per_s if g.airspeed_trim else 0.0,
        change_max=g.airspeed_trim_max_mps,
        airspeed_min=setup.airspeed_min,
        airspeed_max=setup.airspeed_max,
    )
    return GuidanceParameters(
        speed=g.airspeed_mps,
        altitude=altitude,
        tracking=tracking_parameters(scenario, setup, steering),
        airspeed_law=trim,
        airspeed_bandwidth=setup.airspeed_bandwidth,
        airspeed_overshoot=setup.airspeed_overshoot,
        navigation=None,
        vessel=vessel,
        guard=guard,
        mission=mission,
        health=None,
    )
