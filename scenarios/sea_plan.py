"""From a scenario of the real sea to one flight: everything it needs, resolved to SI, and the reason where it cannot be flown."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from aircraft.turbulence import TURBULENCE, intensities, scale_lengths
from aircraft.weather import Weather
from gnc.delta import look_ahead
from gnc.errors import InfeasibleError
from gnc.guidance import GuidanceParameters, Law
from gnc.keepout_guard import KeepoutGuard
from gnc.moving_centre import CentreParameters
from gnc.navigation import NavigationParameters
from gnc.orbit import half_widths
from gnc.oscillation import Oscillation, design_oscillation
from gnc.sea_guidance import SeaParameters
from gnc.speed_hold import SpeedHold, design_speed_hold
from gnc.vessel_filter import VesselFilter, VesselReport
from innerloop.reversal import Reversal
from scenarios.flights import SixDof
from scenarios.flyable import omega_max
from scenarios.sea_config import SeaScenario
from scenarios.sea_margin import KeepoutMargin, SpreadTable, keepout_margin, vessel_filter
from scenarios.sea_world import VESSEL_DATA, TimedFault, drawn_fault, drawn_weather, vessel_track, wind_ned
from scenarios.sensors import SensorErrors
from scenarios.vessel_reports import heard_reports, never
from scenarios.vessel_track import VesselTrack

_RATIO_STEPS = 48
"""Steps of nu at which the orbit's half-widths are tabled."""

_LOOK = 0.5
"""Time between looks at vessel and wind [s]."""

_STALE_MIN = 2.0
"""Shortest age at which vessel data count as stale [s]."""

_TRANSIT_SHARE = 0.5
"""Share of the airspeed beyond V_r that is used on the way to the reference [-]."""

_POWERLESS_SHARE = 0.55
"""Mean lack of airspeed at which thrust counts as lost, over what V_r lies above the slowest airspeed [-]."""


KINEMATIC_BANDWIDTH = 1.0
"""Bandwidth of a kinematic vehicle's airspeed that its guidance reckons with; it follows at once [rad/s]."""

KINEMATIC_LAG = 0.4
"""Lag of a kinematic vehicle's heading rate over the real sea, where it stands for an aircraft [s]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Airframe:
    """What flights need of what flies them.

    Attributes
    ----------
    lag : of the heading rate behind the guidance [s]
    airspeed_bandwidth, airspeed_min, airspeed_max : of the airspeed behind its command, and its range [rad/s, m/s]
    turning_airspeed : up to which omega_max can be flown at the autopilot's largest bank [m/s]
    reversal : how the heading rate follows a reversal of the turn
    crab_banks, crab_offsets : banks in steady turns, and course through the air minus heading at each [rad]
    six_dof, model : the aircraft and the JSBSim root of its autopilot; neither for a kinematic vehicle
    """

    lag: float
    airspeed_bandwidth: float
    airspeed_min: float
    airspeed_max: float
    turning_airspeed: float
    reversal: Reversal
    crab_banks: tuple[float, ...]
    crab_offsets: tuple[float, ...]
    six_dof: SixDof | None
    model: Path | None


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
        guidance=_parameters(scenario, fastest, airframe, margin.total, [half_widths(oscillation) for oscillation in oscillations]),
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


def _parameters(
    scenario: SeaScenario, fastest: float, airframe: Airframe, margin: float, widths: list[tuple[float, float]]
) -> SeaParameters:
    g, f, time_step = scenario.guidance, scenario.following, 1.0 / scenario.guidance.rate_hz
    radius, reports = scenario.keepout.radius_m, scenario.reports
    gust = 0.0
    if scenario.turbulence.level != "none":
        sigma = intensities(scenario.plume.source_height_m, TURBULENCE[scenario.turbulence.level].wind_at_20ft)[0]
        scale = scale_lengths(scenario.plume.source_height_m)[0]
        gust = sigma * math.sqrt(2.0 * scale / g.airspeed_mps / _LOOK)
    guidance = tracking_parameters(scenario, airframe)
    hold = speed_hold(scenario, airframe)
    navigation = NavigationParameters(
        crab_banks=airframe.crab_banks,
        crab_offsets=airframe.crab_offsets,
        airspeed_sigma=math.hypot(0.5, gust),
        course_sigma=math.hypot(0.03, gust / g.airspeed_mps),
        wind_drift=0.02,
        wind_prior=10.0,
        wind_interval=max(1, round(_LOOK * g.rate_hz)),
        time_step=time_step,
    )
    centre = CentreParameters(
        distance_min=radius + margin,
        speed_ratio_max=f.speed_ratio_max,
        along=tuple(along for along, _ in widths),
        across=tuple(across for _, across in widths),
        plume_heading=math.radians(scenario.plume.heading_deg) if scenario.plume.direction == "given" else None,
        apparent_wind_min=f.apparent_wind_min_mps,
        speed=g.airspeed_mps,
        heading_rate_max=fastest,
    )
    return SeaParameters(
        guidance=guidance,
        navigation=navigation,
        centre=centre,
        reference_heading_rate=(1.0 - g.reserve) * fastest,
        roll_rate_max=math.radians(g.roll_rate_max_deg_s),
        speed_ratio_max=f.speed_ratio_max,
        blocked_radius=radius + margin,
        round_radius=radius + margin + 0.8 * g.airspeed_mps / fastest,
        join_distance=f.join_distance_m,
        standoff=f.standoff_m,
        tracked=f.tracked_m,
        hold=hold,
        transit_airspeed=min(g.airspeed_mps + _TRANSIT_SHARE * (hold.airspeed_max - g.airspeed_mps), airframe.turning_airspeed),
        powerless=_POWERLESS_SHARE * (g.airspeed_mps - hold.airspeed_min),
        stale=max(_STALE_MIN, reports.interval_s[1] + reports.latency_max_s),
        vessel_acceleration=f.vessel_acceleration_mps2,
        drift_rate=f.drift_rate_mps,
        plan_interval=max(1, round(_LOOK * g.rate_hz)),
        altitude=scenario.plume.source_height_m,
        glide_airspeed=0.5 * (g.airspeed_mps + hold.airspeed_min),
    )


def tracking_parameters(scenario: SeaScenario, airframe: Airframe) -> GuidanceParameters:
    """Return the parameters of the tracking law of a scenario."""
    g = scenario.guidance
    return GuidanceParameters(
        law=Law(g.law),
        look_ahead=look_ahead(g.epsilon_per_m, g.look_ahead_m),
        gain=g.gain_per_s,
        rate_max=g.steering_max_rad_s,
        k_1=g.lyapunov_gain_per_m2,
        heading_rate_max=omega_max(g),
        time_step=1.0 / g.rate_hz,
        lag=airframe.lag if g.preview else 0.0,
        airspeed_gain=0.0,
        airspeed_trim_max=0.0,
    )


def speed_hold(scenario: SeaScenario, airframe: Airframe) -> SpeedHold:
    """Return how a scenario's flights keep pace with their reference."""
    return design_speed_hold(
        bandwidth=airframe.airspeed_bandwidth,
        speed=scenario.guidance.airspeed_mps,
        look_ahead=scenario.guidance.look_ahead_m,
        airspeed_min=airframe.airspeed_min,
        airspeed_max=airframe.airspeed_max,
    )


def oscillation_at(scenario: SeaScenario, nu: float) -> Oscillation:
    """Return the reference's oscillation at a speed ratio, or raise an InfeasibleError."""
    g = scenario.guidance
    return design_oscillation(
        nu=nu,
        speed=g.airspeed_mps,
        heading_rate_max=omega_max(g),
        reserve=g.reserve,
        roll_rate_max=math.radians(g.roll_rate_max_deg_s),
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
