"""What the guidance knows beforehand of a plume's axis: how high it is expected to be, how sure that is, and how it is found."""

import math
from collections.abc import Sequence

import numpy as np

from gnc.errors import InfeasibleError
from gnc.estimation.plume_prior import GasSensor, PlumePrior, rise
from gnc.mission.axis_height import AxisHeight
from gnc.mission.plume_axis import AxisParameters, Climb, PredictedPlume
from gnc.mission.searched_axis import SearchedPlume
from measurement.emission.emission import Emission
from measurement.gases import GASES, PARTS
from measurement.plume.air import MarineAir
from measurement.plume.settings import PlumeSettings
from measurement.plume.spread import STEP, spreads
from measurement.sniffer.presets import sensor_preset
from scenarios.instruments.sniffer import SnifferOnBoard
from scenarios.schema.scenario import Scenario
from scenarios.world.exhaust import emission
from scenarios.world.vessel import VesselTruth

PREDICTED_TIME, KNOWN_TIME = 20.0, 4.0
"""Time in which the altitude follows a height that is predicted from wind under estimation, and one that is known [s]."""

ALTITUDE_MARGIN = {"none": 3.0, "light": 6.0, "moderate": 10.0, "severe": 15.0}
"""How far within the limits of the altitude is flown, by the turbulence [m]."""

_ROOM = 10.0
"""Least room between the altitudes that are flown, to search in [m]."""

_WIND_STEP = 1.0
"""Between the apparent winds for which is told what is expected [m/s]."""

_WIND_LEAST = 2.0
"""Apparent wind from which on the spreads hold [m/s]."""

_LOADS, _SOURCES = 5, 3
"""Values that a load and a height of the mouth are expected to have, within their ranges."""

_TYPICAL_WIND = 7.0
"""True wind whose turbulence is expected [m/s]: the mean over the sea."""

_RISE_ERROR, _SOURCE_ERROR, _WIND_ERROR = 0.15, 2.0, 0.5
"""Deviation of the rise, over it [-], of the mouth's height [m], and of each component of the estimated wind [m/s]."""

_COURSE_ERROR = math.radians(2.0)
"""Deviation of the wind's direction by the heading's bias, and of the axis by what the straight plume leaves out [rad]."""

_SPREAD_ERROR, _STRENGTH_ERROR = 0.3, 0.3
"""Deviation of the logarithms of spread and strength [-], beside what the load makes of it."""

CO2 = GASES.index("co2")


def plume_axis(
    scenario: Scenario, vessel: VesselTruth, widths: Sequence[tuple[float, float]], distance_min: float
) -> AxisParameters:
    """Return how the guidance knows the plume's axis.

    Parameters
    ----------
    scenario, vessel : of the flight
    widths : half-widths of the orbit along and across its course, at equal steps of nu from 0 [m]
    distance_min : that the orbit keeps from the vessel [m]

    Raises
    ------
    MeasurementError : the ship has no such speed
    InfeasibleError : the limits of the altitude leave no room to search in, or the flight starts outside of them
    """
    f = scenario.following
    gradient = f.climb_gradient
    if scenario.emission.ship is None or f.plume == "predicted":
        climb = Climb(time=PREDICTED_TIME, gradient=gradient)
        return PredictedPlume(height=axis_height(scenario, vessel), altitude=scenario.altitude, climb=climb)
    limits = flown_altitudes(scenario)
    height = axis_height(scenario, vessel, limits)
    climb = Climb(time=KNOWN_TIME, gradient=gradient)
    if f.plume == "told":
        return PredictedPlume(height=height, altitude=scenario.altitude, climb=climb)
    return SearchedPlume(
        height=height,
        altitude=scenario.altitude,
        climb=climb,
        priors=_priors(scenario, vessel, widths, distance_min, limits=limits),
        wind_step=_WIND_STEP,
        climb_rate=gradient * scenario.guidance.airspeed_mps,
        ladder=f.search == "ladder",
    )


def flown_altitudes(scenario: Scenario) -> tuple[float, float]:
    """Return the lowest and the highest altitude that is flown while the plume is searched for and followed [m].

    Raises
    ------
    InfeasibleError : they leave no room, or the flight starts outside of them
    """
    flight, margin = scenario.flight, ALTITUDE_MARGIN[scenario.turbulence.level]
    lowest, highest = flight.altitude_min_m + margin, flight.altitude_max_m - margin
    if highest - lowest < _ROOM:
        raise InfeasibleError(
            f"flight.altitude_min_m and altitude_max_m are {flight.altitude_min_m:g} and {flight.altitude_max_m:g} m; the aircraft"
            f" keeps {margin:g} m from each, and a plume is searched for within at least {_ROOM:g} m: give them"
            f" {2.0 * margin + _ROOM:g} m or more between them"
        )
    if not lowest <= scenario.altitude <= highest:
        raise InfeasibleError(
            f"the flight starts at an altitude of {scenario.altitude:g} m; the aircraft keeps within {lowest:g} and {highest:g} m,"
            " which follow from flight.altitude_min_m and altitude_max_m: set flight.altitude_m in between"
        )
    return lowest, highest


def axis_height(scenario: Scenario, vessel: VesselTruth, limits: tuple[float, float] | None = None) -> AxisHeight:
    """Return the height that the guidance expects: at the load that the speed takes, or in the middle of the ranges given.

    Parameters
    ----------
    scenario, vessel : of the flight
    limits : lowest and highest altitude that is flown [m]; those of the flight unless given

    Raises
    ------
    MeasurementError : the ship has no such speed
    """
    f, flight = scenario.following, scenario.flight
    lowest, highest = limits or (flight.altitude_min_m, flight.altitude_max_m)
    source = sum(f.source_height_m) / 2.0 if f.source_height_m else scenario.plume.source_height_m
    climb = math.tan(math.radians(scenario.plume.elevation_deg))
    if scenario.emission.ship is None:
        return AxisHeight(source=source, climb=climb)
    expected = _expected(scenario, vessel, 0.5)
    return AxisHeight(
        source=source,
        climb=climb,
        momentum_flux=expected.momentum_flux,
        buoyancy_flux=expected.buoyancy_flux,
        lowest=lowest,
        highest=highest,
    )


def _expected(scenario: Scenario, vessel: VesselTruth, quantile: float) -> Emission:
    """Return what is expected to be emitted, at a quantile of the load's range; at the load that the speed takes without one."""
    load = scenario.following.load
    if load is not None:
        return emission(scenario, speed=math.nan, load=load[0] + quantile * (load[1] - load[0]))
    _, _, v_north, v_east = vessel.motion(0.0)
    return emission(scenario, speed=math.hypot(v_north, v_east))


def _priors(
    scenario: Scenario,
    vessel: VesselTruth,
    widths: Sequence[tuple[float, float]],
    distance_min: float,
    *,
    limits: tuple[float, float],
) -> tuple[PlumePrior, ...]:
    """Return what is expected at even steps of the apparent wind, where the orbit in it crosses the axis."""
    speed, ratio_max = scenario.guidance.airspeed_mps, scenario.following.speed_ratio_max
    winds = _WIND_STEP * np.arange(1.0, max(2.0, ratio_max * speed / _WIND_STEP))
    ratios = np.linspace(0.0, ratio_max, len(widths))
    distances = distance_min + np.interp(winds / speed, ratios, [along for along, _ in widths])
    held = np.maximum(winds, _WIND_LEAST)
    ages = distances / held
    given = scenario.following.source_height_m or (scenario.plume.source_height_m,) * 2
    sources = [given[0] + (i + 0.5) / _SOURCES * (given[1] - given[0]) for i in range(_SOURCES)]
    emissions = [_expected(scenario, vessel, (i + 0.5) / _LOADS) for i in range(_LOADS)]
    middle, source = emissions[_LOADS // 2], sources[_SOURCES // 2]
    settings, air = PlumeSettings(), MarineAir(wind_speed=_TYPICAL_WIND)
    of = spreads(middle, air, source, held, float(ages.max()), settings)
    rows, at = np.arange(len(winds)), np.round(ages / STEP).astype(np.intp)
    strengths = np.log([expected.rates[CO2] for expected in emissions])
    sensor = _co2_sensor(scenario)
    priors = []
    for i, wind, distance in zip(rows.tolist(), winds.tolist(), distances.tolist(), strict=True):
        rises = np.array([rise(expected.momentum_flux, expected.buoyancy_flux, distance, wind) for expected in emissions])
        sigma_y, sigma_z = (float(values[i, at[i]]) for values in (of.relative_y, of.relative_z))
        mean_rise = float(np.mean(rises))
        wind_error = _WIND_ERROR / max(wind, _WIND_LEAST)
        spread_of_height = math.sqrt(
            float(np.var(rises) + np.var(sources)) + _SOURCE_ERROR**2 + mean_rise**2 * (_RISE_ERROR**2 + wind_error**2)
        )
        priors.append(
            PlumePrior(
                distance=distance,
                apparent_wind=wind,
                source_height=source,
                height=source + mean_rise,
                height_deviation=spread_of_height,
                bearing_deviation=math.hypot(wind_error, _COURSE_ERROR),
                sigma_y=sigma_y,
                sigma_z=sigma_z,
                sigma_deviation=_SPREAD_ERROR,
                meander_y=float(of.meander_y[i, at[i]]),
                meander_z=float(of.meander_z[i, at[i]]),
                meander_time=settings.meander_length_across * source / wind,
                peak=middle.rates[CO2] * PARTS["co2"] / (2.0 * math.pi * air.molar_density * wind * sigma_y * sigma_z),
                peak_deviation=math.hypot(_STRENGTH_ERROR, float(np.std(strengths))),
                sensor=sensor,
                lowest=limits[0],
                highest=limits[1],
            )
        )
    return tuple(priors)


def _co2_sensor(scenario: Scenario) -> GasSensor:
    """Return the CO2 channel of the sniffer on board, by its data sheet."""
    if "sniffer" not in scenario.payload.instruments:
        raise InfeasibleError("following.plume is 'estimated', and nothing smells it: put 'sniffer' into payload.instruments")
    spec = sensor_preset(scenario.payload.settings(SnifferOnBoard).sensor)
    channel = spec.known("co2")
    return GasSensor(
        interval=1.0 / spec.rate_hz,
        delay=channel.delay_s,
        time_constant=channel.constants[0],
        noise=channel.noise,
        saturated=channel.range_high,
    )
