"""From a scenario of the real sea to one flight: everything it needs, resolved to SI, and the reason where it cannot be flown."""

import math
from dataclasses import dataclass

import numpy as np

from aircraft.weather import Weather
from gnc.errors import InfeasibleError
from gnc.keepout_guard import KeepoutGuard
from gnc.orbit import half_widths
from gnc.oscillation import Oscillation
from gnc.sea_parameters import SeaParameters
from gnc.vessel_filter import VesselFilter, VesselReport
from innerloop.reversal import Reversal
from scenarios.flyable import omega_max
from scenarios.sea_airframe import Airframe
from scenarios.sea_config import SeaScenario
from scenarios.sea_margin import KeepoutMargin, SpreadTable, keepout_margin, vessel_filter
from scenarios.sea_parameters import oscillation_at, sea_parameters
from scenarios.sea_world import VESSEL_DATA, TimedFault, drawn_fault, drawn_weather, vessel_track, wind_ned
from scenarios.sensors import SensorErrors
from scenarios.vessel_reports import heard_reports, never
from scenarios.vessel_track import VesselTrack

_RATIO_STEPS = 48
"""Steps of nu at which the orbit's half-widths are tabled."""


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
    oscillation: Oscillation
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
        return self.periods[min(round(nu / self.guidance.speed_ratio_max * _RATIO_STEPS), len(self.periods) - 1)]


def plan_sea_flight(
    scenario: SeaScenario,
    *,
    flight_id: str,
    seed: int,
    airframe: Airframe,
    spreads: SpreadTable | None,
) -> SeaPlan:
    """Resolve one flight.

    Parameters
    ----------
    scenario, flight_id, seed : the flight
    airframe : what flies it
    spreads : predicted in its turbulence

    Raises
    ------
    InfeasibleError : the flight has no solution
    """
    g, time_step = scenario.guidance, 1.0 / scenario.guidance.rate_hz
    world, noise = (np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(2))
    track = vessel_track(scenario)
    nu = track.apparent_wind([0.0])[0] / g.airspeed_mps
    _check_plume(scenario, track)
    fastest = omega_max(g)
    ratios = np.linspace(0.0, scenario.following.speed_ratio_max, _RATIO_STEPS + 1).tolist()
    oscillations = [oscillation_at(scenario, ratio) for ratio in ratios]
    margin = keepout_margin(scenario, spreads, nu)
    steps = round(scenario.flight.duration_max_s * g.rate_hz) + 2
    start = _start(scenario, track, world)
    fault = drawn_fault(scenario, world)
    weather = drawn_weather(scenario, world)
    silence = (fault.begins, fault.ends) if fault.kind == VESSEL_DATA else never()
    duration = scenario.flight.duration_max_s
    guard = _guard(scenario, fastest, airframe.reversal, margin)
    _check_start(scenario, guard, margin, track, start)
    return SeaPlan(
        flight_id=flight_id,
        nu=nu,
        oscillation=oscillation_at(scenario, nu),
        periods=tuple(oscillation.period for oscillation in oscillations),
        guidance=sea_parameters(
            scenario, fastest, airframe, margin.total, [half_widths(oscillation) for oscillation in oscillations]
        ),
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
    if scenario.plume.direction == "apparent_wind" and track.apparent_wind([0.0])[0] < f.apparent_wind_min_mps:
        raise InfeasibleError(
            f"the apparent wind is {track.apparent_wind([0.0])[0]:.2f} m/s; below {f.apparent_wind_min_mps:g} the plume has no"
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


def _guard(scenario: SeaScenario, fastest: float, reversal: Reversal, margin: KeepoutMargin) -> KeepoutGuard | None:
    """Return the guard of the disc that the keep-out sphere cuts out at the height of its centre."""
    g, f = scenario.guidance, scenario.following
    if not g.keepout_guard:
        return None
    return KeepoutGuard(
        radius=scenario.keepout.radius_m + margin.guard,
        heading_rate_max=fastest,
        lag=reversal.lag,
        delay=reversal.delay,
        time_step=1.0 / g.rate_hz,
        speed_error=f.speed_error_mps,
        acceleration=f.vessel_acceleration_mps2,
    )


def _start(scenario: SeaScenario, track: VesselTrack, generator: np.random.Generator) -> tuple[float, float, float]:
    """Return north, east [m] and course through the air [rad] of the UAV's start, drawn about the plume's axis."""
    distance = float(generator.uniform(*scenario.start.distance_m))
    spread = math.radians(scenario.start.spread_deg)
    bearing = track.axis(0.0) + float(generator.uniform(-spread, spread))
    course = float(generator.uniform(-math.pi, math.pi))
    return distance * math.cos(bearing), distance * math.sin(bearing), course
