"""Spreads of a plume over the sea: about its fixed axis, about its centre at one moment, and of the
centre about the axis.
"""

import functools
import math
from dataclasses import dataclass

import numpy as np

from measurement.emission.emission import Emission
from measurement.plume.air import MarineAir
from measurement.plume.arrays import Array
from measurement.plume.rise import downwash, rise
from measurement.plume.settings import PlumeSettings

STEP = 0.1
"""Step of age in the tables and in the integration [s]."""

_BUOYANT = 0.4 / math.sqrt(2.0)
"""Spread that the rise makes, over the rise [-]: AERMOD's buoyancy-induced dispersion."""

_BATCHELOR = 2.33
"""(11/9) C2 6^(1/3) / 2 with Kolmogorov's C2 = 2.1 [-], which is from memory: reviews give 2.0 to
2.2.
"""

_FINAL = 60.0
"""Age at which the axis' height is the one that the absolute spreads are computed with [s]."""

_SURFACE = 0.46
"""Least height of AERMOD's lateral time scale [m]."""


@dataclass(frozen=True)
class Spreads:
    """Axis and spreads by apparent wind and age; every array has the shape (winds, ages).

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


def spreads(
    emission: Emission,
    air: MarineAir,
    source_height: float,
    wind: Array,
    age_max: float,
    settings: PlumeSettings,
) -> Spreads:
    """Return axis and spreads at ages 0, 0.1, ... [s], from the turbulence of the true wind and the
    time in the apparent one.

    With sigma_r^2 = sigma_0^2 + sigma_b^2 + sigma_t^2 (source, buoyancy, turbulence) each direction
    follows, from sigma_t = 0 on,

        d sigma_t^2/dt =
        min[3 (C_r eps)^(1/3) sigma_r^(4/3), 2 t min(2.33 (eps sigma_r)^(2/3), sigma_w^2), d
        sigma_a^2/dt]:

    Richardson's 4/3 law, Batchelor's ballistic range, and never faster than about the fixed axis.
    The centre has the rest: sigma_m^2 = sigma_a^2 - sigma_t^2, so that the ensemble mean is the
    regulatory Gaussian by construction. Each limit is a standard one; taking the least of them is
    the specification's own.

    Parameters
    ----------
    emission, air, settings : source, turbulence, constants
    source_height : of the funnel's mouth above the sea [m]
    wind : apparent winds [m/s], shape (winds,), above 0
    age_max : largest age [s]

    Holds for 50 to 1000 m and up to about 300 s, over sea, in an apparent wind above 2 m/s.
    """
    return _spreads(emission, air, source_height, tuple(wind.tolist()), age_max, STEP, settings)


@functools.lru_cache(maxsize=8)
def _spreads(
    emission: Emission,
    air: MarineAir,
    source_height: float,
    winds: tuple[float, ...],
    age_max: float,
    step: float,
    settings: PlumeSettings,
) -> Spreads:
    """Return the same, kept for the next flights in the same wind: those of a comparison, or with
    another law or sensor.
    """
    wind = np.array(winds)
    age: Array = step * np.arange(math.ceil(age_max / step) + 2, dtype=np.float64)
    column = wind[:, np.newaxis]
    climb = rise(emission, column, age, air.brunt_vaisala)
    stack = np.maximum(0.0, source_height - settings.downwash * downwash(emission, column))
    final = stack + rise(emission, column, np.array(_FINAL), air.brunt_vaisala)
    absolute = np.stack([_across(air, final, age), _up(air, final, age)])
    start = (
        emission.stack_diameter**2 / 8.0 * np.maximum(emission.exhaust_speed / column, 1.0)
        + emission.wake_spread**2
    )
    source = start + (_BUOYANT * climb) ** 2
    dissipation = air.dissipation(settings.dissipation_height * source_height)
    turbulent = _turbulent(step, source, absolute, dissipation, air.sigma_w, settings.richardson)
    relative = np.sqrt(source + turbulent)
    meander = np.sqrt(np.maximum(0.0, absolute - turbulent))
    found = (stack + climb, relative[0], relative[1], meander[0], meander[1])
    for values in found:
        values.flags.writeable = False
    return Spreads(*found)


def _across(air: MarineAir, height: Array, age: Array) -> Array:
    """sigma_ay^2 of ambient turbulence [m2]: AERMOD, stable and mechanical form."""
    time_scale = air.mixing_height / (156.0 * air.sigma_v) * np.maximum(height, _SURFACE) / _SURFACE
    result: Array = (air.sigma_v * age) ** 2 / (1.0 + age / (2.0 * time_scale)) ** 0.6
    return result


def _up(air: MarineAir, height: Array, age: Array) -> Array:
    """sigma_az^2 of ambient turbulence [m2]: AERMOD, elevated part."""
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
    """sigma_t^2 [m2], of the shape of ``absolute``, by Euler's rule; the time of the ballistic term
    is the step's middle.
    """
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
