"""The wind that the guidance estimates: how its filter is set, and by how much the wind changes until its estimate has followed."""

import math

from aircraft.atmosphere.turbulence import TURBULENCE, intensities, scale_lengths
from aircraft.atmosphere.wind import WindField
from gnc.estimation.navigation import NavigationParameters
from scenarios.planning.limits import plan_interval
from scenarios.schema.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup

_AIRSPEED_SIGMA, _COURSE_SIGMA = 0.5, 0.03
"""Deviations of airspeed and course that the wind's filter takes for noise in still air [m/s, rad]."""

_WIND_DRIFT, _WIND_PRIOR = 0.02, 10.0
"""By how much the wind may change in the root of a second, and how large it may be before any measurement [m/s]."""

WIND_FOLLOWED = 20.0
"""Time within which the estimated wind follows a change [s]: of a wind that turns steadily it is behind by less."""

_PLUME_RADII = 3.0
"""Distance from the vessel up to which an inclined plume is climbed to, over the keep-out radius [-]: beyond any orbit's centre."""


def navigation_parameters(scenario: Scenario, setup: VehicleSetup) -> NavigationParameters:
    """Return what the navigation knows beforehand: how much gusts scatter what it measures the wind by."""
    g, time_step, gust = scenario.guidance, 1.0 / scenario.guidance.rate_hz, _gust_sigma(scenario)
    return NavigationParameters(
        crab_banks=setup.crab_banks,
        crab_offsets=setup.crab_offsets,
        airspeed_sigma=math.hypot(_AIRSPEED_SIGMA, gust),
        course_sigma=math.hypot(_COURSE_SIGMA, gust / g.airspeed_mps),
        wind_drift=_WIND_DRIFT,
        wind_prior=_WIND_PRIOR,
        wind_interval=plan_interval(scenario.guidance),
        time_step=time_step,
    )


def wind_change(scenario: Scenario, wind: WindField) -> float:
    """Return by how much the wind that is flown in changes at most until its estimate has followed [m/s].

    It changes with time, and with the height of a vehicle that climbs to that of the plume.
    """
    return largest_wind_change(scenario, wind, wind_followed(scenario))


def largest_wind_change(scenario: Scenario, wind: WindField, interval: float) -> float:
    """Return by how much the wind that is flown in changes at most within an interval [s], by time and by height [m/s]."""
    heights, duration = _flown_heights(scenario), scenario.flight.duration_max_s
    climbed = scenario.following.climb_gradient * scenario.guidance.airspeed_mps * interval
    shear = wind.largest_shear(climbed, min(heights), max(heights), duration)
    return wind.largest_change(interval, duration, heights) + shear


def wind_followed(scenario: Scenario) -> float:
    """Return the time within which the estimated wind follows a change [s]: where gusts hide it, the filter is slower."""
    period = plan_interval(scenario.guidance) / scenario.guidance.rate_hz
    return max(WIND_FOLLOWED, math.hypot(_AIRSPEED_SIGMA, _gust_sigma(scenario)) * math.sqrt(period) / _WIND_DRIFT)


def _flown_heights(scenario: Scenario) -> list[float]:
    """Return the height at the start and those of the plume that are climbed to, the lowest and the highest [m]."""
    flight, plume = scenario.flight, scenario.plume
    if scenario.emission.ship is not None:
        return [scenario.altitude, flight.altitude_min_m, flight.altitude_max_m]
    risen = _PLUME_RADII * scenario.keepout.radius_m * math.tan(math.radians(plume.elevation_deg))
    return [scenario.altitude, plume.source_height_m, plume.source_height_m + risen]


def _gust_sigma(scenario: Scenario) -> float:
    """Return the deviation of single measurements of the wind by turbulence [m/s], more for being correlated in time."""
    if scenario.turbulence.level == "none":
        return 0.0
    g, height = scenario.guidance, scenario.plume.source_height_m
    sigma = intensities(height, TURBULENCE[scenario.turbulence.level].wind_at_20ft)[0]
    return sigma * math.sqrt(2.0 * scale_lengths(height)[0] / g.airspeed_mps * g.rate_hz / plan_interval(scenario.guidance))
