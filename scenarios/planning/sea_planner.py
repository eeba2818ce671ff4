"""From a scenario of the real sea to one flight: everything it needs, resolved to SI, and the reason where it cannot be flown."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from aircraft.atmosphere.weather import Weather
from gnc.errors import InfeasibleError
from gnc.estimation.vessel_filter import VesselFilter, VesselReport
from gnc.reference.reference import Orbit
from gnc.safety.keepout_guard import KeepoutGuard
from gnc.sea_parameters import SeaParameters
from innerloop.flight.turn_reversal import TurnReversalResponse
from scenarios.margin.keepout_margin import KeepoutMargin, SpreadTable, keepout_margin, vessel_filter
from scenarios.planning.limits import omega_max
from scenarios.planning.reference import RATIO_STEPS, orbits, oscillation_at
from scenarios.planning.sea_parameters import sea_parameters
from scenarios.schema.sea_config import SeaScenario
from scenarios.vehicles.sea_airframe import Airframe
from scenarios.vehicles.sensors import SensorErrors
from scenarios.world.ais_reports import heard_reports, never
from scenarios.world.vessel import VesselTrack
from scenarios.world.weather import VESSEL_DATA, TimedFault, drawn_fault, drawn_weather, vessel_track, wind_ned


@dataclass(frozen=True, slots=True, kw_only=True)
class SeaPlan:
    """One flight over the real sea.

    Attributes
    ----------
    flight_id : unique in the run
    nu : speed ratio at the start [-]
    oscillation : of the reference at that ratio
    periods : of the oscillation at equal steps of nu from 0 to the largest [s]
    guidance : parameters of the outer loop
    guard : of the keep-out area, fresh, or none
    vessel_filter : fresh
    track : of the vessel, true
    heard : reports of the vessel and when each is heard [s]; none where the vessel is known exactly
    weather, fault, errors : the air, what fails, and the errors of the sensors
    keepout_radius : r_min [m]
    margin : planned on top of it [m]
    altitude : commanded [m]
    start_north, start_east, start_course : of the UAV; the course is through the air [m, m, rad]
    duration_max, crossings, settling_band, log_interval : when to stop and what to record; the last in guidance steps
    """

    flight_id: str
    nu: float
    oscillation: Orbit
    periods: tuple[float, ...]
    guidance: SeaParameters
    guard: KeepoutGuard | None
    vessel_filter: VesselFilter
    track: VesselTrack
    heard: list[tuple[float, VesselReport]] | None
    weather: Weather
    fault: TimedFault
    errors: SensorErrors
    keepout_radius: float
    margin: KeepoutMargin
    altitude: float
    start_north: float
    start_east: float
    start_course: float
    duration_max: float
    crossings: int
    settling_band: float
    log_interval: int

    def period(self, nu: float) -> float:
        """Return the period of the oscillation at a speed ratio [s]."""
        return self.periods[min(round(nu / self.guidance.speed_ratio_max * RATIO_STEPS), len(self.periods) - 1)]


def plan_sea_flight(
    scenario: SeaScenario,
    *,
    flight_id: str,
    seed: int,
    airframe: Airframe,
    spreads: Mapping[str, SpreadTable],
) -> SeaPlan:
    """Resolve one flight.

    Parameters
    ----------
    scenario, flight_id, seed : the flight
    airframe : what flies it
    spreads : predicted, by level of turbulence

    Raises
    ------
    InfeasibleError : the flight has no solution
    """
    g, time_step = scenario.guidance, 1.0 / scenario.guidance.rate_hz
    world, noise = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(2))
    track = vessel_track(scenario)
    nu = track.apparent_wind_at_start / g.airspeed_mps
    _check_plume(scenario, track)
    periods, widths = orbits(g, scenario.following.speed_ratio_max)
    margin = keepout_margin(scenario, spreads.get(scenario.turbulence.level), nu)
    steps = round(scenario.flight.duration_max_s * g.rate_hz) + 2
    start = _start(scenario, track, world)
    fault = drawn_fault(scenario, world)
    weather = drawn_weather(scenario, world)
    silence = (fault.begins, fault.ends) if fault.kind == VESSEL_DATA else never()
    duration = scenario.flight.duration_max_s
    guard = _guard(scenario, airframe.reversal, margin)
    _check_start(scenario, guard, margin, track, start)
    return SeaPlan(
        flight_id=flight_id,
        nu=nu,
        oscillation=oscillation_at(g, nu),
        periods=periods,
        guidance=sea_parameters(scenario, airframe, margin.total, widths),
        guard=guard,
        vessel_filter=vessel_filter(scenario.reports),
        track=track,
        heard=None
        if scenario.reports.exact
        else heard_reports(scenario.reports, track, duration=duration, silence=silence, generator=noise),
        weather=weather,
        fault=fault,
        errors=SensorErrors(scenario.sensors, steps=steps, time_step=time_step, generator=noise),
        keepout_radius=scenario.keepout.radius_m,
        margin=margin,
        altitude=scenario.plume.source_height_m,
        start_north=start[0],
        start_east=start[1],
        start_course=start[2],
        duration_max=duration,
        crossings=scenario.flight.crossings,
        settling_band=scenario.flight.settling_band_m,
        log_interval=round(g.rate_hz / scenario.flight.log_rate_hz),
    )


def _check_plume(scenario: SeaScenario, track: VesselTrack) -> None:
    """Raise an InfeasibleError where the scenario implies that no plume can be crossed."""
    f, speed = scenario.following, scenario.guidance.airspeed_mps
    most = track.apparent_wind_range[1]
    if most >= f.speed_ratio_max * speed:
        raise InfeasibleError(
            f"the vessel moves at up to {most:.1f} m/s through the air, nu = {most / speed:.2f}; the UAV at {speed:g} m/s follows"
            f" up to nu = {f.speed_ratio_max:g}: fly faster, or in less apparent wind"
        )
    if scenario.plume.direction == "apparent_wind" and track.apparent_wind_at_start < f.apparent_wind_min_mps:
        raise InfeasibleError(
            f"the apparent wind is {track.apparent_wind_at_start:.2f} m/s; below {f.apparent_wind_min_mps:g} the plume has no"
            " direction: give wind or vessel another speed, or the plume a direction (plume.direction=given)"
        )


def _check_start(
    scenario: SeaScenario, guard: KeepoutGuard | None, margin: KeepoutMargin, track: VesselTrack, start: tuple[float, float, float]
) -> None:
    """Raise an InfeasibleError for a start from which no command keeps the aircraft out of r_min."""
    if guard is None:
        return
    north, east, course = start
    wind_north, wind_east = wind_ned(scenario)
    _, _, v_north, v_east = track.motion(0.0)
    airspeed = scenario.guidance.airspeed_mps
    kept = margin.guard + guard.clearance(north, east, v_north - wind_north, v_east - wind_east, course, airspeed, 0.0)
    if kept < 0.0:
        radius = scenario.keepout.radius_m
        raise InfeasibleError(
            f"from its start, {math.hypot(north, east):.0f} m from the vessel, the UAV cannot turn away in time: it would come"
            f" within {radius + kept:.0f} m, inside keepout.radius_m, {radius:g} m: start farther away"
        )


def _guard(scenario: SeaScenario, reversal: TurnReversalResponse, margin: KeepoutMargin) -> KeepoutGuard | None:
    """Return the guard of the disc that the keep-out sphere cuts out at the height of its centre."""
    g, f = scenario.guidance, scenario.following
    if not g.keepout_guard:
        return None
    return KeepoutGuard(
        radius=scenario.keepout.radius_m + margin.guard,
        heading_rate_max=omega_max(g),
        lag=reversal.lag,
        delay=reversal.delay,
        time_step=1.0 / g.rate_hz,
        speed_error=f.speed_error_mps,
        acceleration=f.vessel_acceleration_mps2,
    )


def _start(scenario: SeaScenario, track: VesselTrack, generator: np.random.Generator) -> tuple[float, float, float]:
    """Return north, east [m] and course through the air [rad] of the UAV's start, about the plume's axis: given, or drawn."""
    given = scenario.start
    distance = float(generator.uniform(*given.distance_m))
    spread = math.radians(given.spread_deg)
    aspect = float(generator.uniform(-spread, spread))
    course = float(generator.uniform(-math.pi, math.pi))
    # What is given is drawn all the same, so that nothing else of the flight depends on what is.
    distance = distance if given.range_m is None else given.range_m
    bearing = track.axis(0.0) + (aspect if given.aspect_deg is None else math.radians(given.aspect_deg))
    course = course if given.course_deg is None else math.radians(given.course_deg)
    return distance * math.cos(bearing), distance * math.sin(bearing), course
