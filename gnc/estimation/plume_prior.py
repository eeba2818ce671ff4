"""What is taken for granted of a plume, and of the sensor that smells it, before anything is read."""

import math
from dataclasses import dataclass

from gnc.errors import InfeasibleError

_ENTRAINMENT = 0.6
"""Briggs' entrainment coefficient of a plume that bends over in the wind [-]."""

_SPEED_MIN = 1.0
"""Apparent wind that the rise is computed for at least [m/s]: below it a plume has no direction, and rises straight up."""

_BUOYANT = 0.4 / math.sqrt(2.0)
"""Spread that the rise makes, over the rise [-]: AERMOD's buoyancy-induced dispersion."""


def rise(momentum_flux: float, buoyancy_flux: float, distance: float, apparent_wind: float) -> float:
    """Return the rise of a bent-over plume in neutral air [m] (Briggs 1975; AERMOD, CBLPRD).

    Parameters
    ----------
    momentum_flux, buoyancy_flux : of the exhaust [m^4/s^2, m^4/s^3]
    distance : behind the funnel, at least 0 [m]
    apparent_wind : past the ship [m/s]
    """
    u = max(apparent_wind, _SPEED_MIN)
    momentum, buoyancy = 3.0 * momentum_flux * distance / u**2, 1.5 * buoyancy_flux * distance**2 / u**3
    return math.cbrt((momentum + buoyancy) / _ENTRAINMENT**2)


@dataclass(frozen=True, slots=True, kw_only=True)
class GasSensor:
    """A channel for CO2: its data sheet.

    Attributes
    ----------
    interval : between readings [s]
    delay : of tube and pump [s]
    time_constant : of its first-order lag, t90/ln 10 [s]
    noise : standard deviation of a reading [ppm]
    background_drift : how fast the reading of clean air may change, by drift and by altitude [ppm/s]
    saturated : reading from which the channel is saturated [ppm]
    """

    interval: float
    delay: float
    time_constant: float
    noise: float
    background_drift: float = 0.1
    saturated: float = math.inf


@dataclass(frozen=True, slots=True, kw_only=True)
class PlumePrior:
    """A plume as it is expected, where it is to be crossed. Deviations are standard deviations.

    Attributes
    ----------
    distance, apparent_wind : behind the funnel, and past the ship, that the other values are for [m, m/s]
    source_height : of the funnel's mouth above the sea, as expected [m]
    height, height_deviation : of the axis above the sea, from stack, load and rise [m]
    bearing_deviation : of the axis from the one that the wind lets expect [rad]
    sigma_y, sigma_z : spreads about the centre at one moment, at the expected height [m]
    sigma_deviation : of the logarithm of both spreads, which are too large or too small together [-]
    meander_y, meander_z : standard deviation of the centre about the axis [m]
    meander_time : integral scale of the lateral meander, as the ship meets it [s]
    peak, peak_deviation : CO2 above the background in the centre at one moment [ppm], its median, and the deviation of
        its logarithm [-]; both at the expected height and spread
    sensor : what reads it
    lowest, highest : altitudes that may be flown, above the sea [m]
    height_drift, bearing_drift : how far the axis wanders in a second [m, rad]; it grows with the root of time
    """

    distance: float
    apparent_wind: float
    source_height: float
    height: float
    height_deviation: float
    bearing_deviation: float
    sigma_y: float
    sigma_z: float
    sigma_deviation: float
    meander_y: float
    meander_z: float
    meander_time: float
    peak: float
    peak_deviation: float
    sensor: GasSensor
    lowest: float
    highest: float
    height_drift: float = 0.2
    bearing_drift: float = 0.002

    def __post_init__(self) -> None:
        if not self.lowest < self.highest:
            raise InfeasibleError(
                f"altitudes that may be flown are {self.lowest:g} to {self.highest:g} m; the second must be above the first"
            )
        for name in ("distance", "apparent_wind", "height_deviation", "bearing_deviation", "sigma_y", "sigma_z", "peak"):
            if not getattr(self, name) > 0.0:
                raise InfeasibleError(f"{name} of the expected plume is {getattr(self, name):g}; it must be above 0")

    def height_at(self, height: float, distance: float, apparent_wind: float) -> float:
        """Return how high an axis of this ``height`` [m] at the prior's distance and wind is elsewhere [m].

        The rise goes with x^(2/3)/U (Briggs, buoyancy alone).

        Parameters
        ----------
        height : at the prior's distance, in its apparent wind [m]
        distance, apparent_wind : behind the funnel [m], past the ship [m/s]
        """
        scale = rise(0.0, 1.0, distance, apparent_wind) / rise(0.0, 1.0, self.distance, self.apparent_wind)
        return self.source_height + (height - self.source_height) * scale

    @property
    def buoyant_spread(self) -> float:
        """Spread over rise that buoyancy makes [-]."""
        return _BUOYANT
