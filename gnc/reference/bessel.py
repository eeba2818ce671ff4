"""Speed ratio and oscillation: the inverse of the Bessel function J_0."""

import math

from scipy.optimize import brentq
from scipy.special import j0

from gnc.errors import InfeasibleError


def mean_speed_ratio(eta: float) -> float:
    """Return the reference's mean speed over its speed, F(eta) = J_0(eta): equation (5).

    Parameters
    ----------
    eta : amplitude of the reference's course oscillation [rad]
    """
    return float(j0(eta))


def eta_for_speed_ratio(nu: float) -> float:
    """Return eta [rad] such that the reference's mean speed is that of the vessel: equation (6),
    eta = J_0^-1(nu).

    Parameters
    ----------
    nu : vessel speed over UAV speed, 0 to 1

    Raises
    ------
    InfeasibleError : ``nu`` is outside 0 to 1, where J_0 on [0, 2.4048] has no inverse
    """
    if not (math.isfinite(nu) and 0.0 <= nu <= 1.0):
        raise InfeasibleError(
            f"speed ratio nu is {nu:g}; it must lie within 0 and 1: give the vessel a speed from 0 up to that of the UAV"
        )
    if nu == 1.0:
        return 0.0
    return float(brentq(lambda eta: mean_speed_ratio(eta) - nu, 0.0, 2.5, xtol=1e-15, rtol=1e-14))
