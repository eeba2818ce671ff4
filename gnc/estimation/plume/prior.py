"""The plume that is expected before the first reading, and the data sheet of its sensor."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from gnc.errors import InfeasibleError

Array = npt.NDArray[np.float64]

_ENTRAINMENT = 0.6
"""Briggs' entrainment coefficient of a plume that bends over in the wind [-]."""

SPEED_MIN = 1.0
"""Least apparent wind of the formulas [m/s]: below it a plume has no direction."""

BUOYANT_SPREAD = 0.4 / math.sqrt(2.0)
"""Spread by the rise, over the rise [-]: AERMOD's buoyancy-induced dispersion."""

_SIGMA_V, _SIGMA_W = 1.9, 1.3
"""Deviations of the wind across and up, over the friction velocity [-] (AERMOD, neutral)."""

_DRAG, _DRAG_SLOPE = 0.029, 0.0008
"""Friction velocity over the wind at 10 m in calm, and its growth [-, s/m] (Charnock, to 3 %)."""

_WIND_MIN = 0.5
"""Least wind that makes turbulence [m/s]."""

_SURFACE_SCALE = 0.72
"""Length over height at which the sea stops the spread in height [-] (AERMOD, elevated part)."""

_OWN_SHARE, _OWN_HEIGHT, _OWN_FRICTION = 0.42, 40.0, 0.3
"""Spread about the moving centre over spread about the axis, across and by turbulence [-], for a
source at this height [m] in wind of this friction velocity [m/s].

It is proportional to the fourth root of the inverse of each. A fit to the plume model, to 5 % of
it, at 240 to 330 m behind sources of 20 to 60 m, in 3 to 12 m/s: dissipation decreases with height,
and the 4/3 law lags behind the meander.
"""

_OWN_UP = 0.9
"""Largest spread about the moving centre over that about the axis, across and in height [-].

The spread about the centre in height equals that across: eddies of the plume's size are the same in
each direction, and the sea stops the larger ones.
"""

_SOURCE_SPREAD = 4.0
"""Spread at the stack, in the wake of the superstructure [m]: 0 to 8 m; no measurement is known."""

_MEANDER_LENGTH, _MEANDER_HEIGHT = 2.5, 0.25
"""Integral scale of the meander across, and its length in height, over the source height [-, -]."""

_AIR_DENSITY = 42.3
"""Moles of air per volume [mol/m^3], at 15 degC."""

_MODEL_ERROR, _SPREAD_ERROR, _BEARING_ERROR = 0.1, 0.25, 0.02
"""Errors of rise and spreads, over themselves, and of the bearing [-, -, rad]: assumptions."""

_GROWTH, _NEAR = 0.85, 0.2
"""Power of the distance with which spreads grow, and least value of the distance over that of the
prior [-, -].
"""

HEIGHT_DRIFT, BEARING_DRIFT = 0.1, 0.002
"""Distance and angle that the axis wanders in a second [m, rad]; they grow with the root of time.
"""

BACKGROUND_DRIFT = 0.1
"""Rate at which the reading of clean air may change, by drift and by altitude [ppm/s]."""

_MEANDER_MIN = 0.5
"""Least standard deviation of the meander [m]."""


def rise(
    momentum_flux: float, buoyancy_flux: float, distance: float, apparent_wind: float
) -> float:
    """Return the rise of a bent-over plume in neutral air [m] (Briggs 1975; AERMOD, CBLPRD).

    Parameters
    ----------
    momentum_flux, buoyancy_flux : of the exhaust [m^4/s^2, m^4/s^3]
    distance : behind the stack, at least 0 [m]
    apparent_wind : past the ship [m/s]
    """
    u = max(apparent_wind, SPEED_MIN)
    momentum = 3.0 * momentum_flux * distance / u**2
    buoyancy = 1.5 * buoyancy_flux * distance**2 / u**3
    return math.cbrt((momentum + buoyancy) / _ENTRAINMENT**2)


def downwash(stack_diameter: float, exhaust_speed: float, apparent_wind: float) -> float:
    """Return how far the stack's wake draws the plume down [m] (AERMOD, HSPRIM).

    It is 2 d (1.5 - w/U), not below 0.

    Parameters
    ----------
    stack_diameter, exhaust_speed : d of the stack's mouth [m], and w of the exhaust in it [m/s]
    apparent_wind : U past the ship [m/s]
    """
    return 2.0 * stack_diameter * max(0.0, 1.5 - exhaust_speed / max(apparent_wind, SPEED_MIN))


@dataclass(frozen=True, slots=True, kw_only=True)
class GasSensor:
    """A channel for CO2: its data sheet.

    Attributes
    ----------
    interval : between readings [s]
    delay : of tube and pump [s]
    time_constant : of its first-order lag, t90/ln 10 [s]
    noise : standard deviation of a reading [ppm]
    saturated : reading from which the channel is saturated [ppm]
    resolution : step of the readings, 0 for none [ppm]
    """

    interval: float
    delay: float
    time_constant: float
    noise: float
    saturated: float = math.inf
    resolution: float = 0.0

    def __post_init__(self) -> None:
        for name, unit in (("interval", "s"), ("time_constant", "s"), ("noise", "ppm")):
            value = getattr(self, name)
            if not value > 0.0:
                message = f"{name} of the CO2 sensor is {value:g} {unit}; it must be above 0"
                raise InfeasibleError(message)


@dataclass(frozen=True, slots=True, kw_only=True)
class PlumePrior:
    """The expected plume at the place where it is to be crossed. Deviations are standard
    deviations.

    Attributes
    ----------
    distance, apparent_wind : behind the stack, and past the ship; the other values hold there [m,
        m/s]
    source_height, source_deviation : height above the sea from which the plume rises [m]
    height, height_deviation : of the axis above the sea, from stack, load and rise [m]
    bearing_deviation : of the axis from the one predicted from the wind [rad]
    sigma_y, sigma_z : spreads about the centre at one moment, at the expected height [m]
    sigma_deviation : of the logarithm of both spreads, whose errors are common [-]
    meander_y, meander_z : standard deviation of the centre about the axis [m]
    meander_length : correlation length of the meander in height, along the plume [m]
    meander_time : integral scale of the meander across, past the ship [s]
    peak, peak_deviation : CO2 above the background in the centre at one moment [ppm], its median,
        and the deviation of its logarithm [-]; both at the expected height and spread, so that the
        error of the spread is not in it
    sensor : that reads it
    lowest, highest : altitudes that may be flown, above the sea [m]
    """

    distance: float
    apparent_wind: float
    source_height: float
    source_deviation: float
    height: float
    height_deviation: float
    bearing_deviation: float
    sigma_y: float
    sigma_z: float
    sigma_deviation: float
    meander_y: float
    meander_z: float
    meander_length: float
    meander_time: float
    peak: float
    peak_deviation: float
    sensor: GasSensor
    lowest: float
    highest: float

    def __post_init__(self) -> None:
        if not self.lowest < self.highest:
            raise InfeasibleError(
                f"altitudes that may be flown are {self.lowest:g} to {self.highest:g} m; "
                "the second must be above the first"
            )
        positive = {
            "distance": "m",
            "apparent_wind": "m/s",
            "height_deviation": "m",
            "bearing_deviation": "rad",
            "sigma_y": "m",
            "sigma_z": "m",
            "peak": "ppm",
        }
        for name, unit in positive.items():
            value = getattr(self, name)
            if not value > 0.0:
                message = f"{name} of the expected plume is {value:g} {unit}; it must be above 0"
                raise InfeasibleError(message)

    def rise_of(self, height: Array | float) -> Array:
        """Return the expected rise of axes of some heights [m], at least 0.

        Stack and rise share the difference from the expected height as they share its variance.

        Parameters
        ----------
        height : above the sea, at the prior's distance and wind, any shape [m]
        """
        share = max(0.0, 1.0 - (self.source_deviation / self.height_deviation) ** 2)
        off = np.asarray(height) - self.height
        result: Array = np.maximum(0.0, self.height - self.source_height + share * off)
        return result

    def widened(self, distance: float, apparent_wind: float) -> float:
        """Return the ratio of spreads and meander elsewhere to those at the prior's distance and
        wind [-].

        Turbulence makes them grow with x/U, buoyancy with x^(2/3)/U, and the source has a spread
        from the start. The result is within 7 % (rms) of the plume model's, from 250 to 460 m to
        220 to 350 m.

        Parameters
        ----------
        distance, apparent_wind : behind the stack [m], past the ship [m/s]
        """
        turbulent = max(0.0, self.sigma_y**2 - _SOURCE_SPREAD**2) + self.meander_y**2
        source = min(self.sigma_y, _SOURCE_SPREAD) ** 2
        farther = (max(distance, _NEAR * self.distance) / self.distance) ** _GROWTH
        grown = farther * self.apparent_wind / max(apparent_wind, SPEED_MIN)
        return math.sqrt((source + turbulent * grown**2) / (source + turbulent))

    def height_at(self, height: Array, distance: float, apparent_wind: float) -> Array:
        """Return the heights of axes elsewhere [m].

        The rise goes with x^(2/3)/U (Briggs, buoyancy alone).

        Parameters
        ----------
        height : of the axes at the prior's distance, in its apparent wind, any shape [m]
        distance, apparent_wind : behind the stack [m], past the ship [m/s]
        """
        risen = rise(0.0, 1.0, max(distance, 0.0), apparent_wind)
        scale = risen / rise(0.0, 1.0, self.distance, self.apparent_wind)
        result: Array = height + (scale - 1.0) * self.rise_of(height)
        return result


@dataclass(frozen=True, slots=True, kw_only=True)
class Expectation:
    """The values that are known beforehand of the ship's class and of the sensor.

    Attributes
    ----------
    source_height, source_deviation : of the stack's mouth [m]
    stack_diameter, exhaust_speed : of the stack's mouth [m], and of the exhaust in it at the
        expected load [m/s]
    momentum_flux, buoyancy_flux, co2_rate : of the exhaust at that load [m^4/s^2, m^4/s^3, mol/s]
    load_deviation : of the logarithm of buoyancy flux and CO2 rate [-]
    wind_deviation : of each component of the apparent wind, as it is estimated on board [m/s]
    sensor : for CO2
    lowest, highest : altitudes that may be flown [m]
    """

    source_height: float
    source_deviation: float
    stack_diameter: float
    exhaust_speed: float
    momentum_flux: float
    buoyancy_flux: float
    co2_rate: float
    load_deviation: float
    wind_deviation: float
    sensor: GasSensor
    lowest: float
    highest: float


def expected_plume(
    expected: Expectation, *, distance: float, apparent_wind: float, wind_speed: float
) -> PlumePrior:
    """Return the expected plume of a ship of a class, over the sea in neutral air.

    Source, buoyancy and a part of the turbulence make the spreads about the moving centre; the rest
    of the turbulence makes the meander. The part is a fit to ``measurement.plume.spread`` at 200 to
    500 m.

    Parameters
    ----------
    expected : of ship and sensor
    distance : behind the stack, where it is to be crossed [m]
    apparent_wind : past the ship [m/s]
    wind_speed : over the sea at 10 m [m/s]; with the wind at 60 to 110 m in its place, the meander
        is up to 29 % too large and the peak 17 % too low (8 m/s over a roughness of 0.2 mm), within
        the prior's deviations
    """
    wind = max(apparent_wind, SPEED_MIN)
    wind_error = expected.wind_deviation / wind
    lowered = downwash(expected.stack_diameter, expected.exhaust_speed, wind)
    mouth = max(0.0, expected.source_height - lowered)
    climbed = rise(expected.momentum_flux, expected.buoyancy_flux, distance, wind)
    # The rise goes with the cube root of the flux, and with 1/U.
    rise_error = math.hypot(expected.load_deviation / 3.0, wind_error, _MODEL_ERROR)
    height = mouth + climbed
    # Spreads about the axis by turbulence alone.
    friction = max(wind_speed, _WIND_MIN) * (_DRAG + _DRAG_SLOPE * wind_speed)
    age = distance / wind
    across = _SIGMA_V * friction * age
    path = _SIGMA_W * friction * age
    up = path / math.sqrt(1.0 + path / (_SURFACE_SCALE * height))
    # Spreads about the moving centre.
    scale = _OWN_HEIGHT * _OWN_FRICTION / (expected.source_height * friction)
    own_across = across * min(_OWN_UP, _OWN_SHARE * scale**0.25)
    own_up = min(own_across, _OWN_UP * up)
    buoyant = BUOYANT_SPREAD * climbed
    without_turbulence = math.hypot(_SOURCE_SPREAD, buoyant)
    sigma_y = math.hypot(without_turbulence, own_across)
    sigma_z = math.hypot(without_turbulence, own_up)
    # Twice the load gives twice the gas, and makes the buoyant part of the spreads 2^(1/3) times as
    # wide.
    by_load = 1.0 - buoyant**2 * (1.0 / sigma_y**2 + 1.0 / sigma_z**2) / 3.0
    return PlumePrior(
        distance=distance,
        apparent_wind=wind,
        source_height=mouth,
        source_deviation=expected.source_deviation,
        height=height,
        height_deviation=math.hypot(expected.source_deviation, climbed * rise_error),
        bearing_deviation=math.hypot(wind_error, _BEARING_ERROR),
        sigma_y=sigma_y,
        sigma_z=sigma_z,
        sigma_deviation=_SPREAD_ERROR,
        meander_y=max(math.sqrt(across**2 - own_across**2), _MEANDER_MIN),
        meander_z=max(math.sqrt(up**2 - own_up**2), _MEANDER_MIN),
        meander_length=_MEANDER_HEIGHT * expected.source_height,
        meander_time=_MEANDER_LENGTH * expected.source_height / wind,
        peak=1e6 * expected.co2_rate / (2.0 * math.pi * wind * sigma_y * sigma_z * _AIR_DENSITY),
        peak_deviation=math.hypot(by_load * expected.load_deviation, wind_error, _MODEL_ERROR),
        sensor=expected.sensor,
        lowest=expected.lowest,
        highest=expected.highest,
    )
