"""The plan for a plume: the expected height of its axis, the search for it, and the best distance
from the ship to measure the sulphur.

The best distance is where the uncertainty of the sulphur by noise falls fastest with time. A pass
at a height z off the centre of a Gaussian plume of spreads s_y, s_z, in an apparent wind U, at a
speed v across it, has the dose A exp(-z^2/(2 s_z^2)), A = Q/(sqrt(2 pi) n U s_z v). A sensor with a
time constant T turns it into a pulse whose square has the integral A^2/(2T) erfcx(s_y/(v T)),
erfcx(x) = exp(x^2) erfc(x), by Parseval's theorem. The regression's uncertainty by noise falls with
the root of the sum of these integrals. Their mean over a z of mean o and variance w^2 has the
factor s_z/sqrt(s_z^2 + 2 w^2) exp(-o^2/(s_z^2 + 2 w^2)).
"""

import math

import numpy as np
import numpy.typing as npt
from scipy.special import erfcx

from gnc.errors import InfeasibleError
from gnc.estimation.plume.prior import Expectation, GasSensor
from gnc.mission.axis import AxisHeight, AxisParameters, Climb, PredictedPlume, SearchedPlume
from measurement.emission import Emission
from measurement.gases import GASES
from measurement.plume.spread import STEP, MarineAir, PlumeSettings, spreads
from measurement.sniffer.spec import SnifferSpec
from scenarios.instruments.sniffer import SnifferOnBoard
from scenarios.planning.air.wind import climbed_along
from scenarios.scenario.scenario import Scenario
from scenarios.scenario.sections.flight import ALTITUDE_MARGIN
from scenarios.world.plume import emission
from scenarios.world.vessel import VesselTruth

PREDICTED_TIME, KNOWN_TIME = 20.0, 4.0
"""Time in which the altitude follows a height that is predicted from an estimated wind, and a known
height [s].
"""

_ROOM = 10.0
"""Least range of altitudes for a search [m]."""

_LOADS = 9
"""Number of loads, evenly within their range, from which the deviation of the emission is
computed.
"""

_SOURCE_ERROR, _LOAD_ERROR = 2.0, 0.3
"""Deviation of the mouth's height [m], and of the logarithm of the emission [-], where neither has
a range.
"""

_WIND_ERROR = 0.3
"""Deviation of each component of the apparent wind as it is estimated on board [m/s]: 0.29 at the
start of the search in 24 flights.
"""

CO2 = GASES.index("co2")


def plume_axis(
    scenario: Scenario, vessel: VesselTruth, altitude_reach: float = math.inf
) -> AxisParameters:
    """Return the parameters of the guidance's knowledge of the plume's axis.

    Parameters
    ----------
    scenario, vessel : of the flight
    altitude_reach : largest distance of a command from the present altitude [m]

    Raises
    ------
    MeasurementError : the ship has no such speed
    InfeasibleError : the limits of the altitude leave no room to search in, or the flight starts
        outside of them
    """
    f = scenario.following
    gradient = f.climb_gradient
    if scenario.emission.ship is None or f.plume == "predicted":
        climb = Climb(time=PREDICTED_TIME, gradient=gradient)
        return PredictedPlume(
            height=axis_height(scenario, vessel), altitude=scenario.altitude, climb=climb
        )
    limits = flown_altitudes(scenario)
    height = axis_height(scenario, vessel, limits)
    climb = Climb(time=KNOWN_TIME, gradient=gradient, reach=altitude_reach)
    if f.plume == "told":
        return PredictedPlume(height=height, altitude=scenario.altitude, climb=climb)
    return SearchedPlume(
        height=height,
        altitude=scenario.altitude,
        climb=climb,
        expected=_expectation(scenario, vessel, limits),
        climb_rate=gradient * scenario.guidance.airspeed_mps,
        ladder=f.search == "ladder",
    )


def flown_altitudes(scenario: Scenario) -> tuple[float, float]:
    """Return the lowest and the highest altitude of a flight while it searches for the plume and
    follows it [m].

    Raises
    ------
    InfeasibleError : they leave no room, or the flight starts outside of them
    """
    flight, margin = scenario.flight, ALTITUDE_MARGIN[scenario.turbulence.level]
    lowest, highest = flight.altitudes_kept(scenario.turbulence.level)
    if highest - lowest < _ROOM:
        raise InfeasibleError(
            f"flight.altitude_min_m and altitude_max_m are {flight.altitude_min_m:g} and"
            f" {flight.altitude_max_m:g} m; the aircraft keeps {margin:g} m from each, and a plume"
            f" is searched for within at least {_ROOM:g} m: give them {2.0 * margin + _ROOM:g} m or"
            " more between them"
        )
    if not lowest <= scenario.altitude <= highest:
        raise InfeasibleError(
            f"the flight starts at an altitude of {scenario.altitude:g} m; the aircraft keeps"
            f" within {lowest:g} and {highest:g} m, which follow from flight.altitude_min_m and"
            " altitude_max_m: set flight.altitude_m in between"
        )
    return lowest, highest


def axis_height(
    scenario: Scenario, vessel: VesselTruth, limits: tuple[float, float] | None = None
) -> AxisHeight:
    """Return the height that the guidance expects: at the load for the ship's speed, or in the
    middle of the given ranges.

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
    source = sum(f.source_height_m) / 2.0 if f.source_height_m else scenario.source_height
    climb = math.tan(math.radians(scenario.plume.elevation_deg))
    if scenario.emission.ship is None:
        return AxisHeight(
            source=source, climb=climb, highest=source + max(0.0, climb) * climbed_along(scenario)
        )
    expected = expected_emission(scenario, vessel, 0.5)
    return AxisHeight(
        source=source,
        climb=climb,
        momentum_flux=expected.momentum_flux,
        buoyancy_flux=expected.buoyancy_flux,
        stack_diameter=expected.stack_diameter,
        exhaust_speed=expected.exhaust_speed,
        lowest=lowest,
        highest=highest,
    )


def expected_emission(scenario: Scenario, vessel: VesselTruth, quantile: float) -> Emission:
    """Return the expected emission at a quantile of the load's range; without a range, at the load
    for the ship's speed.
    """
    load = scenario.following.load
    if load is not None:
        return emission(scenario, speed=math.nan, load=load[0] + quantile * (load[1] - load[0]))
    _, _, v_north, v_east = vessel.motion(0.0)
    return emission(scenario, speed=math.hypot(v_north, v_east))


def _expectation(
    scenario: Scenario, vessel: VesselTruth, limits: tuple[float, float]
) -> Expectation:
    """Return the expectation for ship and sensor, within the altitudes of the flight."""
    f, middle = scenario.following, expected_emission(scenario, vessel, 0.5)
    sources = f.source_height_m
    loads = [expected_emission(scenario, vessel, (i + 0.5) / _LOADS) for i in range(_LOADS)]
    return Expectation(
        source_height=axis_height(scenario, vessel).source,
        source_deviation=(sources[1] - sources[0]) / math.sqrt(12.0) if sources else _SOURCE_ERROR,
        stack_diameter=middle.stack_diameter,
        exhaust_speed=middle.exhaust_speed,
        momentum_flux=middle.momentum_flux,
        buoyancy_flux=middle.buoyancy_flux,
        co2_rate=middle.rates[CO2],
        load_deviation=float(np.std(np.log([of.rates[CO2] for of in loads])))
        if f.load
        else _LOAD_ERROR,
        wind_deviation=_WIND_ERROR,
        sensor=co2_sensor(sniffer_on_board(scenario)),
        lowest=limits[0],
        highest=limits[1],
    )


def sniffer_on_board(scenario: Scenario) -> SnifferSpec:
    """Return the data sheet of the sniffer on board.

    Raises
    ------
    InfeasibleError : no sniffer is on board
    """
    if "sniffer" not in scenario.payload.instruments:
        raise InfeasibleError(
            "following.plume is 'estimated', and nothing measures it: put 'sniffer' into"
            " payload.instruments"
        )
    spec: SnifferSpec = scenario.payload.settings(SnifferOnBoard).spec
    return spec


def co2_sensor(spec: SnifferSpec) -> GasSensor:
    """Return the CO2 channel of a sniffer, by its data sheet."""
    channel = spec.known("co2")
    return GasSensor(
        interval=1.0 / spec.rate_hz,
        delay=channel.delay_s,
        time_constant=channel.constants[0],
        noise=channel.noise,
        saturated=channel.range_high,
        resolution=channel.resolution,
    )


Array = npt.NDArray[np.float64]

_FARTHEST, _GRID = 400.0, 41
"""Range of distances beyond the nearest one that are considered [m], and their number."""

_HEIGHT_ERROR = 5.0
"""Deviation of the flown height from the axis [m]: that of the estimate after some minutes."""

_TYPICAL_WIND = 7.0
"""True wind whose turbulence is expected [m/s]: the mean over the sea."""

_WIND_LEAST = 2.0
"""Least apparent wind for which the spreads hold [m/s]."""


def additional_distance(
    scenario: Scenario, vessel: VesselTruth, nearest: float, apparent_wind: float
) -> float:
    """Return the distance beyond the nearest one [m] at which the sulphur is known best after a
    minute [m].

    Parameters
    ----------
    scenario, vessel : of the flight
    nearest : distance at which the axis can be crossed [m]
    apparent_wind : past the ship [m/s]

    Raises
    ------
    InfeasibleError : there is no sniffer
    """
    if scenario.following.distance == "closest":
        return 0.0
    if "sniffer" not in scenario.payload.instruments:
        raise InfeasibleError(
            "following.distance is 'best_measurement', and nothing measures: put 'sniffer' into"
            " payload.instruments"
        )
    further = np.linspace(0.0, _FARTHEST, _GRID)
    return float(
        further[int(np.argmax(information(scenario, vessel, nearest + further, apparent_wind)))]
    )


def information(
    scenario: Scenario, vessel: VesselTruth, distance: Array, apparent_wind: float
) -> Array:
    """Return the mean integral of the squared pulse of a pass over that of all gas at once, shape
    as ``distance`` [m]: relative.

    One over its root is the uncertainty of the sulphur by noise after a time, up to a factor that
    all distances have.
    """
    wind = max(apparent_wind, _WIND_LEAST)
    height, emitted = axis_height(scenario, vessel), expected_emission(scenario, vessel, 0.5)
    age = distance / wind
    of = spreads(
        emitted,
        MarineAir(wind_speed=_TYPICAL_WIND),
        height.source,
        np.array([wind]),
        float(age.max()),
        PlumeSettings(),
    )
    sigma_y, sigma_z, meander_z, axis = (
        np.interp(age, STEP * np.arange(values.shape[1]), values[0])
        for values in (of.relative_y, of.relative_z, of.meander_z, of.height)
    )
    lowest, highest = flown_altitudes(scenario)
    off = axis - np.clip(axis, lowest, highest)
    wide = sigma_z**2 + 2.0 * (meander_z**2 + _HEIGHT_ERROR**2)
    spec = sniffer_on_board(scenario)
    constant = max(spec.known(gas).constants[0] for gas in ("so2", "co2"))
    # A pass goes across the plume at about the vehicle's speed.
    pulse = erfcx(sigma_y / scenario.guidance.airspeed_mps / constant) / (2.0 * constant)
    result: Array = pulse / sigma_z**2 * sigma_z / np.sqrt(wide) * np.exp(-(off**2) / wide)
    return result
