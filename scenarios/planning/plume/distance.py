"""How far from the ship her exhaust is best measured: where the sulphur's uncertainty by noise
falls fastest with time.

A pass at a height z off the centre of a Gaussian plume of spreads s_y, s_z, in an apparent wind U,
at a speed v across it, has the dose A exp(-z^2/(2 s_z^2)), A = Q/(sqrt(2 pi) n U s_z v). A sensor
with a time constant T makes of it a pulse whose square has the integral A^2/(2T) erfcx(s_y/(v T)),
erfcx(x) = exp(x^2) erfc(x), by Parseval's theorem. The regression's uncertainty by noise falls with
the root of the sum of these integrals. Their mean over a z of mean o and variance w^2 has the
factor s_z/sqrt(s_z^2 + 2 w^2) exp(-o^2/(s_z^2 + 2 w^2)).
"""

import numpy as np
import numpy.typing as npt
from scipy.special import erfcx

from gnc.errors import InfeasibleError
from measurement.plume.spread import STEP, MarineAir, PlumeSettings, spreads
from scenarios.planning.plume.axis import (
    axis_height,
    expected_emission,
    flown_altitudes,
    sniffer_on_board,
)
from scenarios.scenario.scenario import Scenario
from scenarios.world.vessel import VesselTruth

Array = npt.NDArray[np.float64]

_FARTHEST, _GRID = 400.0, 41
"""How much farther than the nearest distance is considered [m], and at how many distances."""

_HEIGHT_ERROR = 5.0
"""Deviation of the flown height from the axis [m]: as well as it is known after some minutes."""

_TYPICAL_WIND = 7.0
"""True wind whose turbulence is expected [m/s]: the mean over the sea."""

_WIND_LEAST = 2.0
"""Apparent wind from which on the spreads hold [m/s]."""


def additional_distance(
    scenario: Scenario, vessel: VesselTruth, nearest: float, apparent_wind: float
) -> float:
    """Return by how much farther than the nearest distance [m] the sulphur is known best after a
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
            "following.distance is 'best_measurement', and nothing measures: put 'sniffer' into payload.instruments"
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
