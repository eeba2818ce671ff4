"""The wind that guard and mission have to allow for: the heights of a flight, the filter of the
wind, and the change of the wind before its estimate has followed.
"""

import math
import statistics
from functools import lru_cache

import numpy as np

from aircraft.weather import TURBULENCE, low_altitude_turbulence
from aircraft.wind import WindField
from gnc.errors import InfeasibleError
from gnc.estimation.error_budget import Process, WindErrorByGusts
from gnc.estimation.navigation import (
    NOISE_DEVIATIONS,
    EstimatedNavigation,
    NavigationParameters,
    SatelliteFix,
    SensorReadings,
    WindFilter,
)
from innerloop.flight.weave import INTERVAL, Samples, Weave
from scenarios.planning.limits import omega_max, plan_interval, plan_period
from scenarios.scenario.scenario import Scenario
from scenarios.vehicles.vehicle_setup import VehicleSetup
from scenarios.world.faults import NOT_OF_AIRCRAFT
from scenarios.world.vessel import VesselTruth
from scenarios.world.world import TRACK_MARGIN, winds_past

_RADII, _BEYOND, _TURN_RADII = 3.0, 1000.0, 4.0
"""Largest distance from the vessel up to which a flight climbs along an inclined plume: a number of
keep-out radii [-], or, if that is more, one such radius plus a distance [m] and a number of turn
radii [-]. Orbits lie nearer, unless their distance is given or a vessel has been silent for
minutes.
"""

_SEA = 1.0
"""Height at which a gliding aircraft counts as down [m]: it reaches the sea within a second."""

_LOOKED_AT = 30
"""Number of heights at which the wind past the vessel is checked [-]."""


def climbed_along(scenario: Scenario) -> float:
    """Return the distance from the vessel up to which a flight climbs along an inclined plume
    [m].
    """
    radius = scenario.guarded_radius
    turn = scenario.guidance.airspeed_mps / omega_max(scenario.guidance)
    return max(
        _RADII * radius,
        radius + _BEYOND + _TURN_RADII * turn,
        scenario.reference.standoff_radius_m or 0.0,
    )


def flown_heights(scenario: Scenario) -> list[float]:
    """Return the heights of a flight: at the start, the lowest and the highest, and that of the sea
    if the vehicle may glide there [m].
    """
    crossed = _crossed_heights(scenario, climbed_along(scenario))
    return [*crossed, _SEA] if glides(scenario) else crossed


def glides(scenario: Scenario) -> bool:
    """Return whether a part of the aircraft may fail, after which it leaves the vessel in a
    glide.
    """
    return not scenario.declared_faults <= NOT_OF_AIRCRAFT


def climbs(scenario: Scenario) -> bool:
    """Return whether the altitude changes without a failure."""
    return len(set(_crossed_heights(scenario, climbed_along(scenario)))) > 1


def _crossed_heights(scenario: Scenario, distance: float) -> list[float]:
    """Return the height at the start, and the lowest and highest height of a climb along a plume up
    to a distance [m].
    """
    flight, source = scenario.flight, scenario.source_height
    if scenario.emission.ship is not None:
        return [scenario.altitude, flight.altitude_min_m, flight.altitude_max_m]
    return [
        scenario.altitude,
        source,
        source + math.tan(math.radians(scenario.plume.elevation_deg)) * distance,
    ]


def check_not_outrun(
    scenario: Scenario, vessel: VesselTruth, wind: WindField, distance: float
) -> None:
    """Refuse a vessel that outruns the UAV through the air at a height of the flight.

    Parameters
    ----------
    scenario, vessel, wind : the flight, and its mean wind
    distance : distance from the vessel up to which the flight climbs along its plume [m]

    Raises
    ------
    InfeasibleError : it does
    """
    if wind.constant:
        # That is checked at the height of the stack.
        return
    crossed = _crossed_heights(scenario, distance)
    heights = [*crossed, _SEA] if glides(scenario) else crossed
    speed, ratio = scenario.guidance.airspeed_mps, scenario.following.speed_ratio_max
    looked_at = np.unique([*heights, *np.linspace(min(heights), max(heights), _LOOKED_AT)]).tolist()
    past = winds_past(vessel, wind, looked_at, scenario.flight.duration_max_s + TRACK_MARGIN)
    fastest, height = max((of.greatest, height) for of, height in zip(past, looked_at, strict=True))
    if fastest >= ratio * speed:
        why = (
            "to which it glides if a part of it fails"
            if height < min(crossed)
            else "which is flown"
        )
        raise InfeasibleError(
            f"at a height of {height:.0f} m, {why}, the vessel moves at up to {fastest:.1f} m/s"
            f" through the air, nu = {fastest / speed:.2f}; the UAV at {speed:g} m/s follows up to"
            f" nu = {ratio:g}: fly faster, in less wind, or at another height"
        )


_AIRSPEED_SIGMA, _COURSE_SIGMA = 0.5, 0.03
"""Least deviations of airspeed and course that count as noise in the wind's filter in still air
[m/s, rad].
"""

_FIRST_WIND = 0.04
"""Error of the first measurement of the wind by roll and climb, over the airspeed [-]: the largest
in 25 starts each is 2.3 % for the X8, 2.2 % for the Aerosonde, 1.3 % for the c172p, and 3.3 % for
an X8 that climbs.
"""

_WIND_DRIFT = 0.02
"""Change of the wind in the root of a second [m/s]."""

_UNTIL_ORBIT = 120.0
"""Time of wind measurements before the vehicle joins an orbit on which the guard is not to act [s];
earlier the guard may act.
"""

_UNTIL_SETTLED = 200.0
"""Time after which the variance of an estimated wind no longer changes in still air [s]."""

WIND_FOLLOWED = 20.0
"""Time within which the estimated wind follows a change [s]: the estimate lags less behind a wind
that turns steadily.
"""


def navigation_parameters(scenario: Scenario, setup: VehicleSetup) -> NavigationParameters:
    """Return the parameters of the navigation: among them the scatter, by gusts, of its
    measurements of the wind.
    """
    g, time_step, gust = scenario.guidance, 1.0 / scenario.guidance.rate_hz, _gust_sigma(scenario)
    airspeed_sigma, course_sigma = _sensor_sigmas(scenario)
    return NavigationParameters(
        crab_banks=setup.crab_banks,
        crab_offsets=setup.crab_offsets,
        airspeed_sigma=math.hypot(airspeed_sigma, gust),
        course_sigma=math.hypot(course_sigma, gust / g.airspeed_mps),
        wind_drift=_WIND_DRIFT,
        wind_noise=NOISE_DEVIATIONS * _measured_noise(scenario),
        first_wind_error=_FIRST_WIND * g.airspeed_mps,
        wind_error=NOISE_DEVIATIONS * wind_noise_left(scenario),
        turbulence=turbulence_met(scenario),
        wind_interval=plan_interval(scenario.guidance),
        time_step=time_step,
    )


def wind_noise(scenario: Scenario) -> float:
    """Return the deviation of the wind by the noise of the readings of airspeed and heading at a
    step [m/s].
    """
    return _wrong_by(
        scenario, scenario.sensors.airspeed_sigma_mps, scenario.sensors.heading_sigma_deg
    )


def wind_bias(scenario: Scenario) -> float:
    """Return the largest error of the measured wind by biases of airspeed and heading [m/s].

    The error turns with the vehicle: an estimate keeps the error of earlier courses. In a climb the
    sensor reads the airspeed along the inclined path, whose horizontal part is a little smaller.
    """
    climbing = (
        1.0 - 1.0 / math.hypot(1.0, scenario.following.climb_gradient) if climbs(scenario) else 0.0
    )
    airspeed = scenario.sensors.airspeed_bias_mps + climbing * scenario.guidance.airspeed_mps
    return _wrong_by(scenario, airspeed, scenario.sensors.heading_bias_deg)


def wind_error_in_weaves(scenario: Scenario, setup: VehicleSetup) -> float:
    """Return the largest error of the estimated wind while the vehicle weaves in still air, in
    excess of the allowance for a first measurement [m/s]: its crab angles differ from those of
    steady turns at V_r.
    """
    parameters = navigation_parameters(scenario, setup)
    return max((_largest_error(weave, parameters) for weave in setup.weaves), default=0.0)


@lru_cache(maxsize=64)
def _largest_error(weave: Weave, parameters: NavigationParameters) -> float:
    """Return the largest error of a wind that is estimated in a lasting weave, in excess of that of
    the first measurement [m/s].

    The estimate begins in straight flight, before the first turn. It is also evaluated after the
    filter has settled: by then the error has decayed to its mean over the weave, about which it
    moves within each period. So this estimate begins at the mean of single measurements.
    """
    wind, largest, first_variance = _wind_filter(parameters), 0.0, 0.0
    for measured in _triangles(weave.entry, parameters):
        wind.update(*measured, INTERVAL)
        variance = wind.sigma**2
        first_variance = first_variance or variance
        allowed = parameters.first_wind_error * variance / first_variance
        largest = max(largest, math.hypot(wind.north, wind.east) - allowed)
    period = _triangles(weave.period, parameters)
    wind = _wind_filter(parameters)
    for _ in range(math.ceil(_UNTIL_SETTLED / (INTERVAL * len(period)))):
        for measured in period:
            wind.update(*measured, INTERVAL)
    wind.north = statistics.fmean(v - speed * math.cos(course) for speed, course, v, _ in period)
    wind.east = statistics.fmean(v - speed * math.sin(course) for speed, course, _, v in period)
    for measured in 2 * period:
        wind.update(*measured, INTERVAL)
        largest = max(largest, math.hypot(wind.north, wind.east))
    return largest


def _triangles(
    samples: Samples, parameters: NavigationParameters
) -> list[tuple[float, float, float, float]]:
    """Return the inputs of the wind's filter for some samples: airspeed, course through the air,
    and velocity over the ground.
    """
    rolls = [sample.roll for sample in samples]
    crabs = np.interp(rolls, parameters.crab_banks, parameters.crab_offsets).tolist()
    return [
        (sample.airspeed, sample.heading + crab, sample.velocity_north, sample.velocity_east)
        for sample, crab in zip(samples, crabs, strict=True)
    ]


def _wind_filter(parameters: NavigationParameters) -> WindFilter:
    return WindFilter(
        airspeed_sigma=parameters.airspeed_sigma,
        course_sigma=parameters.course_sigma,
        drift=parameters.wind_drift,
    )


def wind_noise_left(scenario: Scenario) -> float:
    """Return the final deviation of the estimated wind by that noise [m/s]: sqrt(k/2) of the noise,
    with the filter's gain k.
    """
    gain = _WIND_DRIFT * math.sqrt(plan_period(scenario.guidance)) / _sensor_sigma(scenario)
    return math.sqrt(0.5 * gain) * wind_noise(scenario)


def first_known(scenario: Scenario, setup: VehicleSetup) -> EstimatedNavigation:
    """Return the navigation after its first measurement, with the error of the wind at the
    start.
    """
    airspeed = scenario.guidance.airspeed_mps
    navigation = EstimatedNavigation(navigation_parameters(scenario, setup))
    navigation.update(
        SensorReadings(SatelliteFix(0.0, 0.0, airspeed, 0.0), airspeed, 0.0, 0.0, 0.0, 0.0)
    )
    return navigation


def turbulence_met(scenario: Scenario) -> Process:
    """Return a horizontal component of the turbulence as the vehicle meets it [m/s]."""
    level = scenario.turbulence.level
    if level == "none" or scenario.fidelity == "kinematic":
        return Process()
    air = low_altitude_turbulence(scenario.altitude, TURBULENCE[level].wind_at_20ft)
    return Process(
        sigma=air.horizontal,
        correlation_time=air.horizontal_length / scenario.guidance.airspeed_mps,
        key="turbulence.level",
    )


def wind_known_on_orbit(scenario: Scenario, setup: VehicleSetup) -> WindErrorByGusts | None:
    """Return the error of the estimated wind by turbulence at the start of an orbit; None in calm
    air.

    The filter runs ``_UNTIL_ORBIT`` on a straight way: its gains hardly depend on courses.
    """
    parameters = navigation_parameters(scenario, setup)
    if parameters.turbulence.sigma == 0.0:
        return None
    airspeed, period = scenario.guidance.airspeed_mps, plan_period(scenario.guidance)
    known = WindErrorByGusts(parameters.turbulence)
    wind = _wind_filter(parameters)
    for _ in range(math.ceil(_UNTIL_ORBIT / period)):
        wind.update(airspeed, 0.0, airspeed, 0.0, period)
        known.measure(wind.gain, period)
    return known


def wind_change(scenario: Scenario, wind: WindField, altitude_error: float) -> float:
    """Return the largest change of the flight's wind before its estimate has followed [m/s].

    The wind changes with time, and with the height of a vehicle that climbs to the plume, or whose
    height differs from its command [m].
    """
    return largest_wind_change(scenario, wind, wind_followed(scenario), altitude_error)


def largest_wind_change(
    scenario: Scenario, wind: WindField, interval: float, altitude_error: float
) -> float:
    """Return the largest change of the flight's wind within an interval [s], by time and by height
    [m/s].

    Parameters
    ----------
    altitude_error : by which the altitude may differ from its command [m]
    """
    heights, duration = flown_heights(scenario), scenario.flight.duration_max_s
    climbed = scenario.following.climb_gradient * scenario.guidance.airspeed_mps * interval
    if glides(scenario):
        # The gradient depends on the failure; the whole descent does not take long.
        climbed = max(climbed, scenario.altitude)
    lowest, highest = min(heights) - altitude_error, max(heights) + altitude_error
    shear = wind.largest_shear(climbed + 2.0 * altitude_error, lowest, highest, duration)
    return wind.largest_change(interval, duration, heights) + shear


def wind_followed(scenario: Scenario) -> float:
    """Return the time within which the estimated wind follows a change [s].

    The filter is slower where gusts or noise hide the wind, and for a fast vehicle, whose error of
    the course hides more of the wind.
    """
    across = scenario.guidance.airspeed_mps * _sensor_sigmas(scenario)[1]
    hidden_by = math.hypot(max(_sensor_sigma(scenario), across), _gust_sigma(scenario))
    return max(WIND_FOLLOWED, hidden_by * math.sqrt(plan_period(scenario.guidance)) / _WIND_DRIFT)


def _wrong_by(scenario: Scenario, airspeed: float, heading_deg: float) -> float:
    """Return the error of a single measurement of the wind by errors of airspeed [m/s] and heading
    [deg].
    """
    return math.hypot(airspeed, scenario.guidance.airspeed_mps * math.radians(heading_deg))


def _measured_noise(scenario: Scenario) -> float:
    """Return the deviation of a measurement of the wind by the noise of all sensors [m/s]."""
    return math.hypot(wind_noise(scenario), scenario.sensors.velocity_sigma_mps)


def _sensor_sigmas(scenario: Scenario) -> tuple[float, float]:
    """Return the deviations of airspeed [m/s] and course [rad] that the wind's filter allows for as
    sensor noise.
    """
    sensors, velocity = scenario.sensors, scenario.sensors.velocity_sigma_mps
    course = math.hypot(
        math.radians(sensors.heading_sigma_deg), velocity / scenario.guidance.airspeed_mps
    )
    return max(_AIRSPEED_SIGMA, math.hypot(sensors.airspeed_sigma_mps, velocity)), max(
        _COURSE_SIGMA, course
    )


def _sensor_sigma(scenario: Scenario) -> float:
    """Return the deviation of single measurements of the wind by sensor noise [m/s]: the filter's
    value, or that of the sensors if it is larger.
    """
    return max(_AIRSPEED_SIGMA, _measured_noise(scenario))


def _gust_sigma(scenario: Scenario) -> float:
    """Return the deviation of single measurements of the wind by turbulence [m/s], increased
    because it is correlated in time.
    """
    if scenario.turbulence.level == "none":
        return 0.0
    g, wind_at_20ft = scenario.guidance, TURBULENCE[scenario.turbulence.level].wind_at_20ft
    air = low_altitude_turbulence(scenario.source_height, wind_at_20ft)
    return air.horizontal * math.sqrt(
        2.0 * air.horizontal_length / g.airspeed_mps * g.rate_hz / plan_interval(scenario.guidance)
    )
