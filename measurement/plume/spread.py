"""Rise and spread of a plume over the sea: the air, the settings, and tables by wind and age."""

import functools
import math
from dataclasses import dataclass, field, fields
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from common.physics import STANDARD_GRAVITY
from measurement.emission import (
    AIR_PRESSURE,
    AIR_TEMPERATURE,
    GAS_CONSTANT,
    Emission,
    check_air,
)
from measurement.errors import check_range

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]

SOURCE_HEIGHT_MIN, SOURCE_HEIGHT_MAX = 1.0, 200.0
"""Heights of a stack's mouth above the sea [m]."""

STEP = 0.1
"""Step of age in the tables and in the integration [s]."""

_KARMAN = 0.4
"""Von Karman's constant [-], as in AERMOD."""

_VISCOSITY = 1.5e-5
"""Kinematic viscosity of air [m2/s] at 15 degC."""

_CALM = 0.5
"""Wind below which turbulence is that of this wind [m/s]; an assumption, as calm has no profile."""

_WIND_MAX = 40.0
"""Largest wind [m/s]: above it no UAV flies and Charnock's drag of the sea does not hold."""

_FRICTION_ITERATIONS = 60
"""Iterations for the friction velocity; each halves the error at least."""

_ENTRAINMENT = 0.6
"""Briggs' b [-], as in AERMOD."""

_STABLE = 2.66
"""Coefficient of the rise into stable air [-], from AERMOD."""

_FREQUENCY = 0.7
"""Frequency of a rising plume's oscillation over that of the air [-], from AERMOD."""

_BUOYANT = 0.4 / math.sqrt(2.0)
"""Spread due to the rise, over the rise [-]: AERMOD's buoyancy-induced dispersion."""

_BATCHELOR = 2.33
"""(11/9) C2 6^(1/3) / 2 with Kolmogorov's C2 = 2.1 [-], from memory: reviews give 2.0 to 2.2."""

_FINAL_AGE = 60.0
"""Age at which the axis has the height for which the absolute spreads are computed [s]."""

_SURFACE = 0.46
"""Least height of AERMOD's lateral time scale [m]."""

_WIND_STEP = math.log(1.08)
"""Step between winds of the table, as a logarithm: linear interpolation is good to 1e-3."""

_STEADY = 1e-6
"""Relative range of winds below which the table has a single wind."""

_TYPICAL_AGE = 30.0
"""Age that a plume typically has where it is crossed [s]."""


@dataclass(frozen=True, kw_only=True)
class MarineAir:
    """The air over the sea, neutral or stable.

    u* = 0.4 U10/ln(10/z0) with z0 = alpha u*^2/g + 0.11 nu/u*; sigma_v = 1.9 u*, sigma_w = 1.3 u*
    and eps = u*^3/(0.4 z); the mechanical mixing height is 2300 u*^1.5. Turbulence follows from the
    true wind, dilution from the apparent wind.

    Attributes
    ----------
    wind_speed : true wind at 10 m [m/s], 0 to 40
    temperature, pressure : [K, Pa]
    brunt_vaisala : N of the air that the plume rises through [1/s], 0 for neutral
    charnock : alpha [-]; the range over sea is 0.011 to 0.018

    Raises
    ------
    MeasurementError : a value is out of its range

    Notes
    -----
    Charnock's alpha = 0.0144: J. R. Garratt, Monthly Weather Review 105 (1977). sigma_v^2 =
    3.6 u*^2: AERMOD, EPA-454/R-03-004, eq. 41; the range is 3 to 5 (Panofsky and Dutton).
    sigma_w = 1.3 u*: AERMOD, from memory. Both are taken without their decay with height.
    """

    wind_speed: float
    temperature: float = AIR_TEMPERATURE
    pressure: float = AIR_PRESSURE
    brunt_vaisala: float = 0.0
    charnock: float = 0.0144

    def __post_init__(self) -> None:
        check_air(self.temperature, self.pressure)
        check_range("true wind", self.wind_speed, 0.0, _WIND_MAX, " m/s")
        check_range("stability N", self.brunt_vaisala, 0.0, 0.1, " 1/s")
        check_range("Charnock's constant", self.charnock, 0.005, 0.05)

    @functools.cached_property
    def friction_velocity(self) -> float:
        """Friction velocity u* [m/s]."""
        wind = max(self.wind_speed, _CALM)
        friction = 0.03 * wind
        for _ in range(_FRICTION_ITERATIONS):
            roughness = (
                self.charnock * friction**2 / STANDARD_GRAVITY + 0.11 * _VISCOSITY / friction
            )
            friction = _KARMAN * wind / math.log(10.0 / roughness)
        return friction

    @property
    def sigma_v(self) -> float:
        """Standard deviation of the wind across [m/s]."""
        return 1.9 * self.friction_velocity

    @property
    def sigma_w(self) -> float:
        """Standard deviation of the wind's vertical component [m/s]."""
        return 1.3 * self.friction_velocity

    @property
    def mixing_height(self) -> float:
        """Mechanical mixing height [m] (Venkatram, as in AERMOD)."""
        return float(2300.0 * self.friction_velocity**1.5)

    @property
    def molar_density(self) -> float:
        """Moles of air per volume, p/RT [mol/m3]."""
        return self.pressure / (GAS_CONSTANT * self.temperature)

    def dissipation(self, height: float) -> float:
        """Return the rate of dissipation [m2/s3] at a height above 0 [m]."""
        return self.friction_velocity**3 / (_KARMAN * height)


def _within(default: float, low: float, high: float) -> float:
    """Return the field of a number, with its default and its limits."""
    limited: float = field(default=default, metadata={"limits": (low, high)})
    return limited


@dataclass(frozen=True, kw_only=True)
class PlumeSettings:
    """Constants and options of a plume.

    Attributes
    ----------
    mean : the ensemble mean (regulatory Gaussian) instead of a realisation: no meander, spreads
        with that of the meander
    meander : whether the centre line of a realisation leaves the axis; without it a realisation is
        too high on the axis
    downwash : whether the stack's tip draws the plume down where the exhaust is slower than 1.5 of
        the apparent wind (AERMOD)
    richardson : C_r of the 4/3 law [-]; 0.08 to 0.1 follow from Richardson's g = 0.5 (Boffetta and
        Sokolov), and results depend on it between 0.1 and 0.6
    structure_intensity : standard deviation over mean of the fluctuations within the plume [-]; 0
        leaves them out. About 0.4 on the axis of a buoyant plume, 0.2 to 0.8: an assumption
    structure_length : length of the fluctuations within the plume, in relative spreads [-]; 0.5 to
        1 are plausible: an assumption
    meander_length_across : integral scale of the meander to the sides along the plume, in heights
        of the source [-]; 2 to 3 for neutral air over sea, to a factor of 2 either way: an
        assumption
    meander_length_up : integral scale of the meander in height along the plume, in heights of the
        source [-]; 0.5 for neutral air over sea, to a factor of 2 either way: an assumption
    dissipation_height : height at which the dissipation is taken, in heights of the source [-]. The
        specification does not say which; its worked table follows from 2, where the axis is some
        hundred metres behind
    age_max : age up to which there is a plume [s]; the spreads hold below about 300 s
    parcel_interval : time between parcels of the axis that is made of the ship's track [s]

    Raises
    ------
    MeasurementError : a value is out of its range
    """

    mean: bool = False
    meander: bool = True
    downwash: bool = True
    richardson: float = _within(0.1, 0.01, 2.0)
    structure_intensity: float = _within(0.0, 0.0, 1.0)
    structure_length: float = _within(0.7, 0.1, 3.0)
    meander_length_across: float = _within(2.5, 0.1, 20.0)
    meander_length_up: float = _within(0.5, 0.05, 5.0)
    dissipation_height: float = _within(2.0, 0.1, 10.0)
    age_max: float = _within(300.0, 10.0, 900.0)
    parcel_interval: float = _within(1.0, 0.1, 10.0)

    def __post_init__(self) -> None:
        for setting in fields(self):
            if "limits" in setting.metadata:
                limits = setting.metadata["limits"]
                check_range(setting.name, getattr(self, setting.name), *limits)


class Spreads(NamedTuple):
    """Axis and spreads by apparent wind and age, arrays of one shape.

    Attributes
    ----------
    height : of the mean axis above the sea [m]
    relative_y, relative_z : about the centre at one moment [m]
    meander_y, meander_z : of the centre about the mean axis [m]
    """

    height: Array
    relative_y: Array
    relative_z: Array
    meander_y: Array
    meander_z: Array


def rise(emission: Emission, wind: Array, age: Array, brunt_vaisala: float = 0.0) -> Array:
    """Return the height of the axis above the stack [m]; in neutral air it has no end.

    With x = U t: dh^3 = 3 Fm x/(b^2 U^2) + 3 F x^2/(2 b^2 U^3). Buoyancy alone gives Briggs'
    1.6 F^(1/3) x^(2/3)/U. In stable air dh^3 = 2.66^3 [F/(N^2 U) (N' Fm/F sin N't + 1 - cos N't)]
    with N' = 0.7 N, held from its crest on and limited to the neutral rise.

    Parameters
    ----------
    emission : with its fluxes
    wind : apparent wind U [m/s], above 0
    age : time since emission t [s], at least 0, of a shape that broadcasts with that of ``wind``
    brunt_vaisala : N of the air [1/s], 0 for neutral

    Notes
    -----
    Source: AERMOD, routines CBLPRD, SBLRIS and DELTAH.
    """
    buoyancy, momentum = emission.buoyancy_flux, emission.momentum_flux
    cube = (3.0 * momentum * age / wind + 1.5 * buoyancy * age**2 / wind) / _ENTRAINMENT**2
    if brunt_vaisala > 0.0:
        frequency = _FREQUENCY * brunt_vaisala
        crest = np.arctan2(frequency * momentum, -buoyancy) / frequency
        phase = frequency * np.minimum(age, crest)
        # 2 sin^2(phase/2) is 1 - cos(phase), which rounding would lose at a small phase.
        stable = frequency * momentum * np.sin(phase) + 2.0 * buoyancy * np.sin(0.5 * phase) ** 2
        cube = np.minimum(cube, _STABLE**3 * stable / (brunt_vaisala**2 * wind))
    result: Array = np.cbrt(cube)
    return result


def downwash(emission: Emission, wind: Array) -> Array:
    """Return how far the plume sinks behind the stack's tip [m], for apparent winds [m/s].

    2 d (1.5 - w/U) where the exhaust is slower than 1.5 U, otherwise 0. Source: AERMOD, routine
    HSPRIM. The wake of the superstructure is part of the initial spread instead.
    """
    result: Array = (
        2.0 * emission.stack_diameter * np.maximum(0.0, 1.5 - emission.exhaust_speed / wind)
    )
    return result


def spreads(
    emission: Emission,
    air: MarineAir,
    source_height: float,
    wind: Array,
    age_max: float,
    settings: PlumeSettings,
    step: float = STEP,
) -> Spreads:
    """Return axis and spreads by wind and age, arrays of shape (winds, ages).

    With sigma_r^2 = sigma_0^2 + sigma_b^2 + sigma_t^2 (source, buoyancy, turbulence) each direction
    follows, from sigma_t = 0 on,

        d sigma_t^2/dt =
        min[3 (C_r eps)^(1/3) sigma_r^(4/3), 2 t min(2.33 (eps sigma_r)^(2/3), sigma_w^2), d
        sigma_a^2/dt]:

    Richardson's 4/3 law, Batchelor's ballistic range, and never faster than about the fixed axis.
    The centre has the rest, sigma_m^2 = sigma_a^2 - sigma_t^2, so that the ensemble mean is the
    regulatory Gaussian by construction. Each limit is a standard one; taking the least of them is
    the specification's choice.

    Parameters
    ----------
    emission, air, settings : source, turbulence, constants
    source_height : of the stack's mouth above the sea [m]
    wind : apparent winds [m/s], shape (winds,), above 0
    age_max : largest age [s]
    step : between ages, and of the integration [s]

    Notes
    -----
    Holds for 50 to 1000 m and up to about 300 s, over sea, in an apparent wind above 2 m/s.
    """
    return _spreads(emission, air, source_height, tuple(wind.tolist()), age_max, settings, step)


# Flights in the same wind follow each other: those of a comparison, or with another law or sensor.
@functools.lru_cache(maxsize=8)
def _spreads(
    emission: Emission,
    air: MarineAir,
    source_height: float,
    winds: tuple[float, ...],
    age_max: float,
    settings: PlumeSettings,
    step: float,
) -> Spreads:
    wind = np.array(winds)[:, np.newaxis]
    age: Array = step * np.arange(math.ceil(age_max / step) + 2, dtype=np.float64)
    climb = rise(emission, wind, age, air.brunt_vaisala)
    stack = np.maximum(0.0, source_height - settings.downwash * downwash(emission, wind))
    final = stack + rise(emission, wind, np.array(_FINAL_AGE), air.brunt_vaisala)
    absolute = np.stack([_absolute_across(air, final, age), _absolute_up(air, final, age)])
    start = (
        emission.stack_diameter**2 / 8.0 * np.maximum(emission.exhaust_speed / wind, 1.0)
        + emission.wake_spread**2
    )
    source = start + (_BUOYANT * climb) ** 2
    dissipation = air.dissipation(settings.dissipation_height * source_height)
    turbulent = _turbulent(step, source, absolute, dissipation, air.sigma_w, settings.richardson)
    relative = np.sqrt(source + turbulent)
    meander = np.sqrt(np.maximum(0.0, absolute - turbulent))
    result = Spreads(
        height=stack + climb,
        relative_y=relative[0],
        relative_z=relative[1],
        meander_y=meander[0],
        meander_z=meander[1],
    )
    for values in result:
        values.flags.writeable = False
    return result


def _absolute_across(air: MarineAir, height: Array, age: Array) -> Array:
    """Return sigma_ay^2 of ambient turbulence [m2]: AERMOD, stable and mechanical form."""
    time_scale = air.mixing_height / (156.0 * air.sigma_v) * np.maximum(height, _SURFACE) / _SURFACE
    result: Array = (air.sigma_v * age) ** 2 / (1.0 + age / (2.0 * time_scale)) ** 0.6
    return result


def _absolute_up(air: MarineAir, height: Array, age: Array) -> Array:
    """Return sigma_az^2 of ambient turbulence [m2]: AERMOD, elevated part."""
    path = air.sigma_w * age
    length = 1.0 / (0.72 * np.maximum(height, _SURFACE)) + air.brunt_vaisala / (0.54 * air.sigma_w)
    result: Array = path**2 / (1.0 + path * length)
    return result


def _turbulent(
    interval: float,
    source: Array,
    absolute: Array,
    dissipation: float,
    sigma_w: float,
    richardson: float,
) -> Array:
    """Return sigma_t^2 [m2] by Euler's rule, in the shape of ``absolute``."""
    others = source.T[:, np.newaxis, :].copy()
    growth = np.diff(absolute, axis=-1).transpose(2, 0, 1)
    explosive = interval * 3.0 * (richardson * dissipation) ** (1.0 / 3.0)
    ballistic = interval**2 * (2.0 * np.arange(len(growth)) + 1.0)
    steepest = (_BATCHELOR * dissipation ** (2.0 / 3.0) * ballistic).tolist()
    bound = np.minimum(growth, (sigma_w**2 * ballistic)[:, np.newaxis, np.newaxis])
    result = np.zeros((len(growth) + 1, *growth.shape[1:]))
    root, step = np.empty((2, *growth.shape[1:]))
    for i, steep in enumerate(steepest):
        np.cbrt(others[i] + result[i], out=root)
        np.minimum(explosive * root, steep, out=step)
        step *= root
        np.minimum(step, bound[i], out=step)
        np.add(result[i], step, out=result[i + 1])
    return result.transpose(1, 2, 0)


class SpreadTable:
    """Axis and spreads of a plume, looked up by apparent wind and age.

    Parameters
    ----------
    emission, air, source_height, settings : same as for ``spreads``
    winds : least and largest apparent wind [m/s]
    age_max : largest age [s]

    Attributes
    ----------
    typical_spread : relative spread across at a typical wind and age [m]
    winds : apparent winds of its rows, geometrically even [m/s], shape (w,)
    """

    def __init__(
        self,
        emission: Emission,
        air: MarineAir,
        source_height: float,
        winds: tuple[float, float],
        age_max: float,
        settings: PlumeSettings,
    ) -> None:
        low, high = winds
        if high - low <= _STEADY * high:
            grid = np.array([0.5 * (low + high)])
        else:
            grid = np.geomspace(low, high, 1 + math.ceil(math.log(high / low) / _WIND_STEP))
        self.winds = grid
        self._winds = len(grid)
        self._log_first = math.log(grid[0])
        self._log_step = math.log(high / low) / max(1, self._winds - 1)
        found = spreads(emission, air, source_height, grid, age_max, settings)
        table = np.stack(found, axis=-1)
        if settings.mean:
            table[..., 1:3] = np.hypot(table[..., 1:3], table[..., 3:])
        if settings.mean or not settings.meander:
            table[..., 3:] = 0.0
        self._ages = table.shape[1] - 1
        columns = len(Spreads._fields)
        # A row has the values at an age, and their growth until the next age.
        self._values = np.ascontiguousarray(table[:, :-1]).reshape(-1, columns)
        self._growth = np.diff(table, axis=1).reshape(-1, columns)
        typical = min(self._ages, round(_TYPICAL_AGE / STEP))
        self.typical_spread = float(found.relative_y[self._winds // 2, typical])

    def at(self, wind: Array, age: Array) -> Spreads:
        """Return axis and spreads, shape (n,), linear in age and in the wind's logarithm.

        Parameters
        ----------
        wind : apparent wind [m/s], shape (n,), within the table's
        age : [s], shape (n,), from 0 to the table's end
        """
        steps = age / STEP
        index = np.minimum(steps.astype(np.intp), self._ages - 1)
        rest = steps - index
        if self._winds == 1:
            return Spreads(*self._row(index, rest))
        position = (np.log(wind) - self._log_first) / self._log_step
        position = np.clip(position, 0.0, self._winds - 1.0)
        line = np.minimum(position.astype(np.intp), self._winds - 2)
        share = position - line
        index += line * self._ages
        below = self._row(index, rest)
        return Spreads(*(below + share * (self._row(index + self._ages, rest) - below)))

    def _row(self, index: Indices, rest: Array) -> Array:
        """Return the five columns of ``Spreads`` at places of the table, shape (5, n)."""
        values = self._values.take(index, axis=0).T
        growth = self._growth.take(index, axis=0).T
        result: Array = values + rest * growth
        return result
