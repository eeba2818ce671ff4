"""How high exhaust rises while it is blown away from its funnel."""

import numpy as np

from measurement.emission.emission import Emission
from measurement.plume.arrays import Array

ENTRAINMENT = 0.6
"""Briggs' b [-], as AERMOD takes it."""

_STABLE = 2.66
"""Coefficient of the rise into stable air [-], of AERMOD."""

_FREQUENCY = 0.7
"""Frequency of a rising plume's oscillation over that of the air [-], of AERMOD."""


def rise(emission: Emission, wind: Array, age: Array, brunt_vaisala: float = 0.0) -> Array:
    """Return how far the axis is above the stack [m], gradually: it has no end in neutral air.

    With x = U t: dh^3 = 3 Fm x/(b^2 U^2) + 3 F x^2/(2 b^2 U^3), of which buoyancy alone is Briggs'
    1.6 F^(1/3) x^(2/3)/U. In stable air dh^3 = 2.66^3 [F/(N^2 U) (N' Fm/F sin N't + 1 - cos N't)],
    N' = 0.7 N, held from its crest on, and never above the neutral rise.

    Parameters
    ----------
    emission : its fluxes
    wind : apparent wind U [m/s], above 0
    age : time since emission t [s], at least 0, of a shape that broadcasts with that of ``wind``
    brunt_vaisala : N of the air [1/s], 0 for neutral

    Sources: AERMOD, routines CBLPRD, SBLRIS and DELTAH.
    """
    buoyancy, momentum = emission.buoyancy_flux, emission.momentum_flux
    cube = (3.0 * momentum * age / wind + 1.5 * buoyancy * age**2 / wind) / ENTRAINMENT**2
    if brunt_vaisala > 0.0:
        frequency = _FREQUENCY * brunt_vaisala
        crest = np.arctan2(frequency * momentum, -buoyancy) / frequency
        phase = frequency * np.minimum(age, crest)
        # 1 - cos of a small phase would be lost in rounding.
        stable = frequency * momentum * np.sin(phase) + 2.0 * buoyancy * np.sin(0.5 * phase) ** 2
        cube = np.minimum(cube, _STABLE**3 * stable / (brunt_vaisala**2 * wind))
    result: Array = np.cbrt(cube)
    return result


def downwash(emission: Emission, wind: Array) -> Array:
    """Return how far the stack's tip draws the plume down [m]: 2 d (1.5 - w/U) where the exhaust is
    slower than 1.5 U, or 0.

    Source: AERMOD, routine HSPRIM. The wake of the superstructure, which is not in it, is in the
    initial spread.
    """
    result: Array = (
        2.0 * emission.stack_diameter * np.maximum(0.0, 1.5 - emission.exhaust_speed / wind)
    )
    return result
