"""The reference's path about the centre of oscillation, in closed form.

Seen from the centre of oscillation the reference flies a figure of eight: period T across the
vessel's course, T/2 along it. The Jacobi-Anger expansion of cos and sin of [eta cos(theta)] turns
its integrals into Fourier series that converge in a dozen terms.
"""

import functools
import math

import numpy as np
import numpy.typing as npt
from scipy.special import jv

from gnc.reference.reference import Array, Orbit

_TERMS = np.arange(1, 25)
_ODD = 2 * _TERMS - 1


def f_x(oscillation: Orbit, time: npt.ArrayLike) -> Array:
    """Return F_x = integral of cos[eta cos(omega_0 t)] from 0 [s]: equation (12)."""
    t = np.asarray(time, dtype=np.float64)[..., None]
    series, _ = _series(oscillation.eta, oscillation.omega_0)
    periodic = np.sum(series * np.sin(2 * _TERMS * oscillation.omega_0 * t), axis=-1)
    return np.asarray(oscillation.nu * t[..., 0] + periodic)


def f_y(oscillation: Orbit, time: npt.ArrayLike) -> Array:
    """Return F_y = integral of sin[eta cos(omega_0 t)] from 0 [s]: equation (12)."""
    t = np.asarray(time, dtype=np.float64)[..., None]
    _, series = _series(oscillation.eta, oscillation.omega_0)
    return np.asarray(np.sum(series * np.sin(_ODD * oscillation.omega_0 * t), axis=-1))


@functools.lru_cache(maxsize=8)
def _series(eta: float, omega_0: float) -> tuple[Array, Array]:
    """Return the coefficients of both series [s], which to find where to join an orbit asks for
    again and again.
    """
    along = (-1.0) ** _TERMS * jv(2 * _TERMS, eta) / (_TERMS * omega_0)
    across = 2.0 * (-1.0) ** (_TERMS - 1) * jv(_ODD, eta) / (_ODD * omega_0)
    return along, across


def offset(oscillation: Orbit, time: npt.ArrayLike) -> tuple[Array, Array]:
    """Return where the reference is from the centre of oscillation: along the vessel's course and
    to its right [m].

    ``time`` [s] counts from a passage through the centre with phi_0 = 0.
    """
    t = np.asarray(time, dtype=np.float64)
    return oscillation.speed * (f_x(oscillation, t) - oscillation.nu * t), oscillation.speed * f_y(
        oscillation, t
    )


def half_widths(oscillation: Orbit) -> tuple[float, float]:
    """Return |d_x|max and |d_y|max [m], the orbit's half-widths along and across the vessel's
    course: equation (12).

    They are reached at t_x = arccos[arccos(nu)/eta]/omega_0 and t_y = pi/(2 omega_0).
    """
    t_x = math.acos(min(1.0, math.acos(oscillation.nu) / oscillation.eta)) / oscillation.omega_0
    t_y = 0.5 * math.pi / oscillation.omega_0
    along, _ = offset(oscillation, t_x)
    _, across = offset(oscillation, t_y)
    return abs(float(along)), abs(float(across))
