"""From a scenario of the real sea to the parameters of its guidance, in SI."""

import math
from collections.abc import Sequence

from aircraft.atmosphere.turbulence import TURBULENCE, intensities, scale_lengths
from gnc.airspeed.pace_hold import SpeedHold, design_speed_hold
from gnc.estimation.navigation import NavigationParameters
from gnc.reference.moving_centre import CentreParameters
from gnc.sea_parameters import SeaParameters
from gnc.tracker import GuidanceParameters
from scenarios.planning.bounded_steering import steering_law
from scenarios.planning.limits import omega_max
from scenarios.schema.sea_config import SeaScenario
from scenarios.vehicles.sea_airframe import Airframe

_LOOK = 0.5
"""Time between looks at vessel and wind [s]."""

_STALE_MIN = 2.0
"""Shortest age at which vessel data count as stale [s]."""

_TRANSIT_SHARE = 0.5
"""Share of the airspeed beyond V_r that is used on the way to the reference [-]."""

_POWERLESS_SHARE = 0.55
"""Mean lack of airspeed at which thrust counts as lost, over what V_r lies above the slowest airspeed [-]."""


def sea_parameters(
    scenario: SeaScenario, airframe: Airframe, margin: float, widths: Sequence[tuple[float, float]]
) -> SeaParameters:
    """Return the parameters of the guidance over a real sea.

    Parameters
    ----------
    scenario, airframe : the flight, and what flies it
    margin : of the keep-out area [m]
    widths : half-widths of the orbit along and across its course, at equal steps of nu from 0 [m]
    """
    g, f, time_step = scenario.guidance, scenario.following, 1.0 / scenario.guidance.rate_hz
    fastest = omega_max(g)
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
        law=steering_law(g),
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
