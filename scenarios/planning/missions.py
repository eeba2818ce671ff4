"""Plans a flight: from its scenario to the mission, its guidance and its world, all in SI, or to
the reason why it cannot be flown.

There are three kinds of flights. One tracks a circle, without a vessel. One tracks the paper's
reference, which is known in advance: beside a steady vessel in still air. All others steer their
reference, or a circle about the vessel: beside a vessel that manoeuvres, in wind, by sensors and
reports.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import numpy.typing as npt
from scipy.special import ellipe

from aircraft.wind import WindField
from gnc.airspeed import AlongTrackTrim, PaceHold
from gnc.errors import InfeasibleError
from gnc.estimation.error_budget import AS_COMMANDED
from gnc.estimation.health import HealthParameters
from gnc.estimation.navigation import AirMotion
from gnc.estimation.vessel import ReachableSet, Tube, VesselLimits, VesselReport
from gnc.guard.guard import GuardParameters, HeadingRateFilter
from gnc.guidance import GuidanceParameters, ReportedVessel
from gnc.mission.axis import AxisHeight, Climb
from gnc.mission.follow import FollowingParameters
from gnc.mission.mission import Centre
from gnc.mission.standoff import StandoffParameters
from gnc.mission.track import DirectParameters, Joining
from gnc.paper import PlumeAxis, centre_of_oscillation
from gnc.reference.reference import Orbit, PeriodicPath
from innerloop.flight.part_failure import glide_airspeed
from scenarios.planning.air.wind import (
    check_not_outrun,
    first_known,
    navigation_parameters,
    wind_known_on_orbit,
)
from scenarios.planning.declared_vessel import check_vessel, with_antenna_errors
from scenarios.planning.flight_plan import FlightPlan, Sensing, Start
from scenarios.planning.guidance import (
    Steering,
    approach_parameters,
    controlled_heading_rate,
    flight_errors,
    following_parameters,
    given_steering,
    guard_parameters,
    guidance_lag,
    plan_steering,
    satellite_noise,
    speed_hold,
    thrust_test,
    tracking_parameters,
    turn_time,
)
from scenarios.planning.limits import check_recorded, omega_max, plan_interval, plan_period
from scenarios.planning.margin.keepout_margin import (
    KeepoutMargin,
    SpreadTable,
    circle_distance,
    filter_parameters,
    orbit_distance,
    tracking_level,
    vessel_limits,
    widest_tube,
)
from scenarios.planning.plume import PREDICTED_TIME, additional_distance, axis_height, plume_axis
from scenarios.planning.reference import (
    RATIO_STEPS,
    circle,
    distance_kept,
    joined_orbit,
    orbits,
    oscillation_at,
    swing_of,
)
from scenarios.planning.traffic import (
    Footprint,
    check_room,
    check_start_beside,
    check_traffic_declared,
    received_of,
    traffic_parameters,
)
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.flight import StartConfig
from scenarios.vehicles.sensors import SensorErrors
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.ais.track import AisVessel, received_reports, usual_intervals
from scenarios.world.faults import NO_FAULTS, VESSEL_DATA, in_order, sampled_fault
from scenarios.world.noise import (
    BACKGROUND,
    EXHAUST,
    HEADING,
    OTHER_EXHAUST,
    TRAFFIC,
    Noise,
    own_generator,
    start_generator,
    streams,
)
from scenarios.world.plume import exhaust_of, sampled_background
from scenarios.world.traffic import traffic_of, with_exhausts
from scenarios.world.vessel import VesselTruth, check_manoeuvres
from scenarios.world.wind import STILL_AIR, sampled_weather
from scenarios.world.world import (
    TRACK_MARGIN,
    ApparentWind,
    World,
    antenna_offset,
    apparent_wind,
    mean_wind,
    place_of,
    plume_of,
    sized,
    vessel_of,
)

Array = npt.NDArray[np.float64]

Spreads = Callable[[Scenario], SpreadTable | None]
"""Returns the predicted spread of the tracking error of a scenario in turbulence; None in calm air.
"""

_POINTS = 720
"""Points of a circle about the vessel between which its motion is interpolated [-]."""


def plan_flight(
    scenario: Scenario,
    *,
    flight_id: str,
    seed: int | Noise,
    setup: VehicleSetup,
    spreads: Spreads = lambda _: None,
) -> FlightPlan:
    """Resolve one flight.

    Parameters
    ----------
    scenario, flight_id : the flight
    seed : of its start, air and noise, or a blend of seeds
    setup : of its vehicle
    spreads : of the tracking error

    Raises
    ------
    InfeasibleError : the flight has no solution, or starts where no command keeps it out of the
        keep-out area, or manoeuvres of its vessel overlap, or it turns too fast for the rate at
        which it is recorded
    """
    scenario = sized(scenario)
    check_recorded(scenario)
    check_manoeuvres(scenario.vessel, scenario.vessel_speed)
    noise = seed if isinstance(seed, Noise) else Noise(seed)
    if scenario.circles:
        return _circling_flight(scenario, flight_id, noise, setup)
    if scenario.follows:
        return _following_flight(scenario, flight_id, noise, setup, spreads(scenario))
    return _tracking_flight(scenario, flight_id, noise, setup)


def _circling_flight(
    scenario: Scenario, flight_id: str, noise: Noise, setup: VehicleSetup
) -> FlightPlan:
    """Return a flight that tracks a circle, without a vessel."""
    reference = circle(scenario)
    steering = plan_steering(scenario, omega_max(scenario.guidance), reference.heading_rate)
    mission = DirectParameters(reference=reference)
    altitude = scenario.source_height
    return FlightPlan.of(
        scenario,
        flight_id,
        guidance=_tracking_guidance(scenario, setup, steering, mission, altitude=altitude),
        steering=steering,
        start=sampled_start(scenario.start, start_generator(noise), course=0.0, axis=math.pi),
        period=2.0 * math.pi / reference.heading_rate,
    )


def _tracking_flight(
    scenario: Scenario, flight_id: str, noise: Noise, setup: VehicleSetup
) -> FlightPlan:
    """Return a flight beside a steady vessel that is known exactly, in still air."""
    g, radius = scenario.guidance, scenario.guarded_radius
    vessel = vessel_of(scenario)
    plume = plume_of(scenario, vessel)
    course, (_, _, v_north, v_east) = vessel.course(0.0), vessel.motion(0.0)
    nu = scenario.nu_over_ground
    orbit = oscillation_at(g, scenario.reference, nu)
    axis = PlumeAxis(
        heading=math.radians(scenario.plume.heading_deg),
        elevation=math.radians(scenario.plume.elevation_deg),
    )
    distance = distance_kept(g, scenario.guarded_keepout, orbit, axis)
    ahead, right, above = centre_of_oscillation(distance, axis)
    steering = plan_steering(scenario, omega_max(g), orbit.amplitude)
    trails = plume.axis(0.0)
    start = sampled_start(scenario.start, start_generator(noise), course=course, axis=trails)
    # The section of the keep-out area at the height of the flight, or lower if the aircraft sinks
    # in a turn.
    lowest = max(0.0, abs(above) - setup.altitude_error)
    disc = radius
    if scenario.keepout.shape == "sphere":
        disc = math.sqrt(max(0.0, radius**2 - lowest**2))
    known = Tube(0.0, 0.0, 0.0, v_north, v_east)
    guard = None
    if g.keepout_guard and disc > 0.0:
        guard = guard_parameters(scenario, setup, disc)
        distance += _missing_distance(guard, known, orbit, axis, distance, g.tracking_allowance_m)
        ahead, right, above = centre_of_oscillation(distance, axis)
    check_start(
        start, guard, (known,), wind=(0.0, 0.0), airspeed=g.airspeed_mps, keepout_radius=radius
    )
    joined = joined_orbit(scenario, orbit, course)
    joining = None
    if g.approach:
        joining = Joining(
            approach=approach_parameters(scenario, setup, disc),
            orbit=joined,
            plan_interval=plan_interval(g),
        )
    centre = placed(ahead, right, course)
    mission = DirectParameters(
        reference=joined.reference(math.radians(g.phase_deg), *centre),
        centre=Centre(*centre, nu),
        joining=joining,
    )
    world = World(
        vessel=vessel,
        plume=plume,
        elevation=axis.elevation,
        source_height=scenario.source_height,
        weather=STILL_AIR,
        faults=NO_FAULTS,
        place=place_of(scenario, vessel),
        hull=scenario.vessel.hull,
    )
    nearest = math.hypot(ahead, right) - orbit.half_widths()[0] - g.tracking_allowance_m
    _check_hull(scenario, world, nearest)
    return FlightPlan.of(
        scenario,
        flight_id,
        nu=nu,
        guidance=_tracking_guidance(
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
        period=orbit.period,
        world=world,
        oscillation=orbit,
        centre_distance=distance,
    )


def _missing_distance(
    guard: GuardParameters,
    vessel: Tube,
    orbit: Orbit,
    axis: PlumeAxis,
    distance: float,
    allowance: float,
) -> float:
    """Return the additional distance along the plume's axis, beyond a distance [m], at which the
    guard does not act on an orbit [m], and the largest deviation of the UAV from it [m].
    """
    ahead, right, _ = centre_of_oscillation(distance, axis)
    nearest = math.hypot(ahead, right) - orbit.half_widths()[0] - allowance
    direction = math.cos(axis.heading), math.sin(axis.heading)
    needed = orbit_distance(guard, vessel, orbit, direction)
    return max(0.0, needed - nearest) / math.cos(axis.elevation)


def _tracking_guidance(
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
    return GuidanceParameters(
        speed=g.airspeed_mps,
        altitude=altitude,
        tracking=tracking_parameters(scenario, setup, steering),
        airspeed_law=AlongTrackTrim(
            speed=g.airspeed_mps,
            gain=g.airspeed_gain_per_s if g.airspeed_trim else 0.0,
            change_max=g.airspeed_trim_max_mps,
            airspeed_min=setup.airspeed_min,
            airspeed_max=setup.airspeed_max,
        ),
        airspeed_bandwidth=setup.airspeed_bandwidth,
        airspeed_overshoot=setup.airspeed_overshoot,
        navigation=None,
        vessel=vessel,
        guard=guard,
        mission=mission,
        health=None,
    )


def _following_flight(
    scenario: Scenario,
    flight_id: str,
    noise: Noise,
    setup: VehicleSetup,
    spreads: SpreadTable | None,
) -> FlightPlan:
    """Return a flight that follows a plume, or circles its vessel.

    Raises
    ------
    InfeasibleError : the vessel outruns the UAV, its plume has no direction, or the flight starts
        where no command keeps it out
    """
    g, flight = scenario.guidance, scenario.flight
    vessel = vessel_of(scenario)
    scenario = _with_usual_intervals(scenario, vessel)
    as_reported = scenario.reports
    scenario = with_antenna_errors(scenario, vessel)
    wind = apparent_wind(scenario, vessel)
    _check_plume(scenario, wind)
    limits = vessel_limits(scenario, turn_time(scenario, setup.reversal))
    check_vessel(scenario, vessel, limits)
    mean = mean_wind(scenario, vessel)
    errors = flight_errors(scenario, setup, mean, spreads.turning if spreads else AS_COMMANDED)
    guarded = guard_parameters(scenario, setup, scenario.guarded_radius, errors)
    planned = _planned_orbit(scenario, setup, spreads, vessel, wind, limits, guarded)
    check_not_outrun(scenario, vessel, mean, planned.climbed_to)
    generators = streams(noise)
    start, world = _start_and_world(scenario, vessel, mean, noise, generators.world)
    _check_hull(scenario, world, scenario.guarded_radius + planned.margin.total)
    check_traffic_declared(scenario, world.traffic)
    check_room(scenario, world, planned.footprint)
    outages = world.faults.intervals(VESSEL_DATA)
    received = None
    if not scenario.vessel_known:
        received = received_reports(
            as_reported,
            vessel,
            duration=flight.duration_max_s,
            outages=outages,
            generator=generators.reports,
            antenna=antenna_offset(scenario),
            heading_generator=own_generator(noise, HEADING),
        )
    of_traffic = received_of(
        scenario, world.traffic, outages=outages, generator=own_generator(noise, TRAFFIC)
    )
    traffic = traffic_parameters(
        scenario,
        world.traffic,
        horizon=limits.horizon,
        speed_max=setup.airspeed_max,
        footprint=planned.footprint,
        measured_radius=scenario.guarded_radius + planned.margin.total,
        meets_ships=setup.meets_ships,
    )
    guard = guarded if g.keepout_guard else None
    # The guard's knowledge at the start: a report of a file may be minutes old by then, and any
    # report may be wrong.
    known = ReachableSet(limits)
    for report in first_reports(vessel, received):
        known.report(report)
    check_start(
        start,
        guard,
        known.tubes(0.0),
        wind=mean.now(0.0, scenario.altitude),
        known=first_known(scenario, setup),
        airspeed=g.airspeed_mps,
        keepout_radius=scenario.guarded_radius,
    )
    own = _at_start(start, mean.now(0.0, scenario.altitude), first_known(scenario, setup))
    check_start_beside(
        start, guard, traffic, world.traffic, of_traffic, own, airspeed=g.airspeed_mps
    )
    return FlightPlan.of(
        scenario,
        flight_id,
        nu=wind.at_start / g.airspeed_mps,
        guidance=replace(
            _following_guidance(scenario, setup, planned.mission, guard, limits), traffic=traffic
        ),
        steering=given_steering(g),
        start=start,
        period=planned.orbit.period,
        world=world,
        sensing=Sensing(
            received=received,
            traffic=of_traffic,
            errors=SensorErrors(
                scenario.sensors,
                steps=round(flight.duration_max_s * g.rate_hz) + 2,
                time_step=1.0 / g.rate_hz,
                generator=generators.sensors,
            ),
            reads_plume=scenario.following.plume == "estimated" or flight.until == "verdict",
            knows_axis=scenario.following.plume == "told",
        ),
        oscillation=planned.orbit,
        periods=planned.periods,
        margin=planned.margin,
        apparent_wind=wind,
    )


def _check_hull(scenario: Scenario, world: World, nearest: float) -> None:
    """Raise an InfeasibleError for a hull that reaches as far along the plume, or about a circle,
    as the orbit.

    Parameters
    ----------
    scenario, world : the flight
    nearest : distance of the orbit from the funnel [m]
    """
    hull = world.hull
    if hull is None:
        return
    bearing = world.plume.axis(0.0) - world.vessel.course(0.0)
    reach = hull.farthest if scenario.stands_off else hull.reach(bearing)
    if reach >= nearest:
        raise InfeasibleError(
            f"vessel.length_m is {hull.length:g} m: the hull reaches {reach:.0f} m from the funnel"
            f" towards the orbit, which begins at {nearest:.0f} m; set keepout.from to 'hull', or a"
            f" larger keepout.radius_m than {scenario.keepout.radius_m:g} m"
        )


def _with_usual_intervals(scenario: Scenario, vessel: VesselTruth) -> Scenario:
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
            f"the vessel moves at up to {wind.greatest:.1f} m/s through the air,"
            f" nu = {wind.greatest / speed:.2f}; the UAV at {speed:g} m/s follows up to"
            f" nu = {f.speed_ratio_max:g}: fly faster, or in less apparent wind"
        )
    if scenario.plume_by_wind and wind.at_start < f.apparent_wind_min_mps:
        # Exhaust trails with the wind, regardless of the given direction of the plume.
        given = ", or the plume a direction (plume.direction=given)"
        raise InfeasibleError(
            f"the apparent wind is {wind.at_start:.2f} m/s; below {f.apparent_wind_min_mps:g} m/s"
            " the plume has no direction: give wind or vessel another speed"
            f"{given if scenario.emission.ship is None else ''}"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class _PlannedOrbit:
    """The orbit on which a flight beside a vessel crosses the plume.

    Attributes
    ----------
    orbit, periods : of the reference, and its periods at equal steps of nu [s]
    mission : mission that flies it
    margin : its distance from the keep-out area
    climbed_to : distance from the vessel up to which the flight climbs along an inclined plume [m]
    footprint : area of the orbit that other ships have to leave free
    """

    orbit: PeriodicPath
    periods: tuple[float, ...]
    mission: FollowingParameters | StandoffParameters
    margin: KeepoutMargin
    climbed_to: float
    footprint: Footprint


def _planned_orbit(
    scenario: Scenario,
    setup: VehicleSetup,
    spreads: SpreadTable | None,
    vessel: VesselTruth,
    wind: ApparentWind,
    limits: VesselLimits,
    guard: GuardParameters,
) -> _PlannedOrbit:
    """Return the orbit nearest to the vessel that keeps the margin and on which the guard does not
    act; a farther one where the sulphur is measured better.
    """
    g, f, radius = scenario.guidance, scenario.following, scenario.guarded_radius
    nu = wind.at_start / g.airspeed_mps
    sigma, level = tracking_level(scenario, spreads, nu)
    orbit = oscillation_at(g, scenario.reference, nu)
    noise = satellite_noise(scenario, setup, orbit.amplitude)
    disc = widest_tube(limits, scenario.reports, plan_period=plan_period(g), noise=noise)
    gusts = wind_known_on_orbit(scenario, setup)
    if scenario.stands_off:
        drift = orbit.nu * orbit.speed
        unguarded = circle_distance(guard, disc, orbit.speed, drift, wind=gusts)
    else:
        unguarded = orbit_distance(guard, disc, orbit, wind=gusts)
    farthest = max(radius + f.margin_min_m, unguarded) + level
    margin = KeepoutMargin(
        tracking_sigma=sigma, total=farthest - radius, reach=disc.reach(limits.horizon)
    )
    if scenario.stands_off:
        about = vessel_circle(scenario, nu, farthest)
        height = axis_height(scenario, vessel)
        return _PlannedOrbit(
            orbit=about,
            periods=about.periods(f.speed_ratio_max),
            mission=standoff_parameters(scenario, setup, about.radius, height),
            margin=margin,
            climbed_to=about.radius,
            footprint=Footprint(
                radius=about.radius, distance=0.0, room=margin.total, period=about.period
            ),
        )
    nearest = radius + margin.total + orbit.half_widths()[0]
    further = additional_distance(scenario, vessel, nearest, wind.at_start)
    # Before the orbits: the error of a shape that cannot be steered comes before its errors beside
    # a fast vessel.
    swing = swing_of(g, scenario.reference)
    periods, widths = orbits(g, scenario.reference, f.speed_ratio_max)
    mission = following_parameters(
        scenario,
        setup,
        margin,
        widths,
        plume_axis(scenario, vessel, setup.altitude_reach),
        swing=swing,
        vessel_course=vessel.course(0.0),
        additional_distance=further,
        errors=guard.errors,
    )
    return _PlannedOrbit(
        orbit=orbit,
        periods=periods,
        mission=mission,
        margin=margin,
        climbed_to=nearest + further,
        footprint=Footprint(
            radius=max(orbit.half_widths()),
            distance=nearest + further,
            room=margin.total,
            period=orbit.period,
        ),
    )


def _start_and_world(
    scenario: Scenario,
    vessel: VesselTruth,
    mean: WindField,
    noise: Noise,
    generator: np.random.Generator,
) -> tuple[Start, World]:
    """Return start and world of a flight in a mean wind, sampled in this order: start, fault,
    air, and further faults.
    """
    plume = plume_of(scenario, vessel)
    start = sampled_start(
        scenario.start, generator, course=vessel.course(0.0), axis=plume.axis(0.0)
    )
    first, *others = scenario.faults
    fault = sampled_fault(first, generator)
    weather = sampled_weather(scenario, mean, generator)
    # Start, air and first fault do not depend on further faults.
    faults = in_order([fault, *(sampled_fault(of, generator) for of in others)])
    covered = scenario.flight.duration_max_s + TRACK_MARGIN
    place = place_of(scenario, vessel)
    exhaust = exhaust_of(
        scenario,
        vessel,
        plume,
        weather.wind,
        duration=covered,
        generator=own_generator(noise, EXHAUST),
    )
    world = World(
        vessel=vessel,
        plume=plume,
        elevation=math.radians(scenario.plume.elevation_deg),
        source_height=scenario.source_height,
        weather=weather,
        faults=faults,
        exhaust=exhaust,
        background=sampled_background(scenario.air, covered, own_generator(noise, BACKGROUND)),
        hull=scenario.vessel.hull,
        place=place,
        traffic=with_exhausts(
            scenario,
            traffic_of(scenario, vessel, place, margin=TRACK_MARGIN),
            plume,
            weather.wind,
            duration=covered,
            generator=own_generator(noise, OTHER_EXHAUST),
        ),
    )
    return start, world


def _following_guidance(
    scenario: Scenario,
    setup: VehicleSetup,
    mission: FollowingParameters | StandoffParameters,
    guard: GuardParameters | None,
    limits: VesselLimits,
) -> GuidanceParameters:
    g = scenario.guidance
    tracking, thrust = tracking_parameters(scenario, setup), thrust_test(scenario, setup)
    return GuidanceParameters(
        speed=g.airspeed_mps,
        altitude=scenario.altitude,
        tracking=tracking,
        airspeed_law=PaceHold(
            speed=g.airspeed_mps,
            hold=speed_hold(scenario, setup),
            turn_speed=setup.turning_airspeed(omega_max(g)),
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


def sampled_start(
    start: StartConfig, generator: np.random.Generator, *, course: float, axis: float
) -> Start:
    """Return a start: given, or sampled about the plume's axis.

    Given values are sampled as well, so that the rest of the flight does not depend on which values
    are given.

    Parameters
    ----------
    start : the ``[start]`` section
    generator : of the random numbers
    course : of the vessel, or of the reference of a circle [rad]
    axis : course along which the plume trails [rad]
    """
    distance = float(generator.uniform(*start.distance_m))
    spread = math.radians(start.spread_deg)
    aspect = float(generator.uniform(-spread, spread))
    flown = float(generator.uniform(-math.pi, math.pi))
    if start.course_deg is not None:
        flown = math.radians(start.course_deg)
    if start.place_m is not None:
        north, east = placed(*start.place_m, course)
        return Start(north=north, east=east, course=flown)
    if start.range_m is not None:
        distance = start.range_m
    bearing = axis + (aspect if start.aspect_deg is None else math.radians(start.aspect_deg))
    return Start(
        north=distance * math.cos(bearing), east=distance * math.sin(bearing), course=flown
    )


def placed(ahead: float, right: float, course: float) -> tuple[float, float]:
    """Return north and east of a place ahead and right of a vessel at the origin on a course
    [m, rad].
    """
    sin_c, cos_c = math.sin(course), math.cos(course)
    return ahead * cos_c - right * sin_c, ahead * sin_c + right * cos_c


def first_reports(
    vessel: VesselTruth, received: list[tuple[float, VesselReport]] | None
) -> list[VesselReport]:
    """Return the reports at the start of the flight; for a vessel that is known exactly, its
    motion.
    """
    if received is None:
        return [VesselReport(0.0, *vessel.motion(0.0))]
    return [report for at, report in received if at <= 0.0]


def check_start(
    start: Start,
    guard: GuardParameters | None,
    vessel: Sequence[Tube],
    *,
    wind: tuple[float, float],
    known: AirMotion | None = None,
    airspeed: float,
    keepout_radius: float,
) -> None:
    """Refuse a start from which no command keeps the aircraft out of the keep-out area.

    Parameters
    ----------
    start, guard : the start, and the guard that would have to keep out; any start is accepted
        without a guard
    vessel : discs at time 0; each of them certainly contains it
    wind : north and east [m/s]
    known : motion by the first measurement, with the largest error of the wind at the start; None
        where it is known exactly
    airspeed : of the UAV [m/s]
    keepout_radius : r_min [m]

    Raises
    ------
    InfeasibleError : the best turn away comes too close, or does not lead away because of the
        vehicle's lag
    """
    if guard is None:
        return
    fastest = max(
        math.hypot(tube.velocity_north - wind[0], tube.velocity_east - wind[1]) for tube in vessel
    )
    away = airspeed * math.cos(min(math.pi, guard.heading_rate_max * guard.lag))
    if away <= fastest:
        raise InfeasibleError(
            f"a UAV that turns at {guard.heading_rate_max:.3g} rad/s and lags by {guard.lag:.3g} s"
            f" overshoots, and then leaves at only {away:.1f} of its {airspeed:.1f} m/s, beside a"
            f" vessel with {fastest:.1f} m/s through the air: slow the vessel, turn more slowly"
            " (guidance.bank_deg), or give a kinematic vehicle a shorter lag"
            " (kinematic.heading_rate_lag_s)"
        )
    own = _at_start(start, wind, known)
    clearance = HeadingRateFilter(guard).clearance(0.0, own, vessel, airspeed)
    if clearance < 0.0:
        raise InfeasibleError(
            f"the start lies {math.hypot(start.north, start.east):.1f} m from the vessel on course"
            f" {math.degrees(start.course):.0f} deg, where the best turn away comes within"
            f" {max(0.0, guard.radius + clearance):.1f} m of where it may be; keepout.radius_m is"
            f" {keepout_radius:g} m, and the guard has to keep"
            f" {guard.radius:.1f} m{_most_of_errors(guard, own)}: start farther away"
            " (start.distance_m) or on another course (start.course_deg)"
        )


def _at_start(start: Start, wind: tuple[float, float], known: AirMotion | None) -> AirMotion:
    """Return the vehicle's motion at the start; parameters of ``check_start``."""
    return AirMotion(
        ground_north=start.north,
        ground_east=start.east,
        course=start.course,
        wind_north=wind[0],
        wind_east=wind[1],
        wind_error=known.wind_error if known else 0.0,
        wind_by_gusts=known.wind_by_gusts if known else None,
    )


def _most_of_errors(guard: GuardParameters, own: AirMotion) -> str:
    """Return the term of the error budget that takes most of the room, in words; empty without
    one.
    """
    turn = math.pi / guard.heading_rate_max + guard.delay + guard.lag
    parts = guard.errors.parts(turn, own.wind_by_gusts)
    name, (distance, key) = max(parts.items(), key=lambda part: part[1].distance)
    if distance == 0.0 or not key:
        return ""
    return f" and, for errors, most for {name}: {distance:.1f} m in half a turn ({key})"


@dataclass(frozen=True, slots=True, kw_only=True)
class VesselCircle:
    """A circle about a vessel, flown clockwise at constant airspeed: an orbit whose centre is the
    vessel.

    Attributes
    ----------
    nu : speed of the vessel through the air over that of the vehicle [-]
    speed : V_r [m/s]
    radius : [m]
    """

    nu: float
    speed: float
    radius: float
    eta: float = math.nan
    limit: str = "standoff circle"
    symmetric: ClassVar[bool] = False

    @property
    def period(self) -> float:
        """Time of one turn about the vessel [s].

        The speed relative to the vessel is V (sqrt(1 - nu^2 sin^2) - nu cos) of the angle between
        tangent and vessel's course; the mean of its inverse over a turn is the complete elliptic
        integral E(nu^2) over pi/2 V (1 - nu^2).
        """
        return float(4.0 * self.radius * ellipe(self.nu**2) / (self.speed * (1.0 - self.nu**2)))

    def periods(self, speed_ratio_max: float) -> tuple[float, ...]:
        """Return the periods at equal steps of nu from 0 to ``speed_ratio_max`` [s]."""
        return tuple(
            replace(self, nu=nu).period
            for nu in np.linspace(0.0, speed_ratio_max, RATIO_STEPS + 1).tolist()
        )

    @property
    def crossing_interval(self) -> float:
        """Time between crossings of the plume: one a turn [s]."""
        return self.period

    @property
    def omega_0(self) -> float:
        """Mean rate of the bearing from the vessel [rad/s]."""
        return 2.0 * math.pi / self.period

    @property
    def amplitude(self) -> float:
        """Largest heading rate through the air, flown against the vessel: (1 + nu)^2 times that in
        still air [rad/s].
        """
        return (1.0 + self.nu) ** 2 * self.speed / self.radius

    def offset(self, time: npt.ArrayLike) -> tuple[Array, Array]:
        """Return the place of the reference relative to the vessel, along its course and to its
        right [m], beginning right ahead.
        """
        bearing = np.linspace(0.0, 2.0 * np.pi, _POINTS + 1)
        tangent = bearing + 0.5 * np.pi
        slowness = (
            self.radius
            / self.speed
            / (np.sqrt(1.0 - (self.nu * np.sin(tangent)) ** 2) - self.nu * np.cos(tangent))
        )
        moment = np.concatenate(
            [[0.0], np.cumsum(0.5 * (slowness[1:] + slowness[:-1]) * np.diff(bearing))]
        )
        at = np.interp(np.mod(np.asarray(time), moment[-1]), moment, bearing)
        return self.radius * np.cos(at), self.radius * np.sin(at)

    def half_widths(self) -> tuple[float, float]:
        """Return the radius, both ways [m]."""
        return self.radius, self.radius


def vessel_circle(scenario: Scenario, nu: float, least: float) -> VesselCircle:
    """Return the circle of a scenario, with the given radius, or with the ``least`` radius that
    keeps out [m].

    Raises
    ------
    InfeasibleError : the circle is tighter than omega_max allows
    """
    circle = VesselCircle(
        nu=nu,
        speed=scenario.guidance.airspeed_mps,
        radius=scenario.reference.standoff_radius_m or least,
    )
    fastest = omega_max(scenario.guidance)
    if circle.amplitude > fastest:
        smallest = max(least, circle.radius * circle.amplitude / fastest)
        raise InfeasibleError(
            f"a circle of {circle.radius:.0f} m about a vessel at nu = {nu:.2f} takes"
            f" {circle.amplitude:.3f} rad/s, above omega_max = {fastest:.3f} rad/s: widen it to"
            f" {smallest:.0f} m (reference.standoff_radius_m), or raise omega_max"
        )
    return circle


def standoff_parameters(
    scenario: Scenario, setup: VehicleSetup, radius: float, height: AxisHeight
) -> StandoffParameters:
    """Return the parameters of circling a vessel at a radius [m], at the height of the plume's axis
    there.
    """
    g = scenario.guidance
    return StandoffParameters(
        radius=radius,
        tracked=scenario.following.tracked_m,
        speed=g.airspeed_mps,
        speed_ratio_max=scenario.following.speed_ratio_max,
        glide_airspeed=glide_airspeed(g.airspeed_mps, setup.airspeed_min),
        plan_interval=plan_interval(scenario.guidance),
        altitude=scenario.altitude,
        height=height,
        climb=Climb(time=PREDICTED_TIME, gradient=scenario.following.climb_gradient),
    )
