"""Amplitude and shape of a steered reference's orbit, from tables: they are needed at every step."""

import bisect
import math
from functools import lru_cache

import numpy as np
from scipy.special import j0, jv

_ORDERS = 4
"""Pairs of Bessel functions in the series of the orbit; what is left out is below 1e-4 of its width at the largest eta."""

_SPEED_RATIO_MIN = -0.2
"""Least mean speed over speed in the tables [-]: a reference may back away from its vessel at a fifth of its speed."""

_ETA_MAX = 2.9
"""Largest amplitude in the tables [rad]: J_0(2.9) = -0.224 is beyond the least ratio."""

_ETA_STEP = 0.005
"""Step of the tables [rad], between whose rows values are linear: good to its square over 8, 3e-6, times a curvature up to 1."""


def eta_for_mean_speed(speed_ratio: float) -> float:
    """Return eta [rad] for a mean speed over speed, by a table of J_0: equation (6), within 1e-5.

    Differs from ``gnc.reference.bessel.eta_for_speed_ratio`` because a steered reference needs it often, and may have to back
    away: ratios down to -0.2 are those of eta beyond the first zero of J_0. Ratios outside -0.2 to 1 are those of the nearest end.
    """
    ratios, etas = _inverse_table()
    if speed_ratio >= 1.0:
        return 0.0
    # Near 1 the ratio is 1 - eta^2/4, so that eta is smooth over the root of what is missing.
    missing = math.sqrt(1.0 - speed_ratio)
    i = min(max(bisect.bisect(ratios, missing), 1), len(ratios) - 1)
    fraction = min(1.0, (missing - ratios[i - 1]) / (ratios[i] - ratios[i - 1]))
    return etas[i - 1] + fraction * (etas[i] - etas[i - 1])


def unit_offset(eta: float, phase: float) -> tuple[float, float]:
    """Return where the reference is from the orbit's centre, along the mean course and to its right, in units of V_r/omega_0.

    The series of ``gnc.reference.orbit.offset`` with its Bessel functions from a table, and with theta = ``phase`` [rad].
    """
    table = _bessel_table()
    # Two rows before the end, so that there is a row after it however the table's length was rounded.
    row = min(max(eta, 0.0), _ETA_MAX - 2.0 * _ETA_STEP) / _ETA_STEP
    i = int(row)
    fraction = row - i
    low, high = table[i], table[i + 1]
    along = right = 0.0
    for k in range(_ORDERS):
        odd = low[2 * k] + fraction * (high[2 * k] - low[2 * k])
        even = low[2 * k + 1] + fraction * (high[2 * k + 1] - low[2 * k + 1])
        right += odd * math.sin((2 * k + 1) * phase)
        along += even * math.sin((2 * k + 2) * phase)
    return along, right


@lru_cache(maxsize=1)
def _inverse_table() -> tuple[list[float], list[float]]:
    etas = np.arange(0.0, _ETA_MAX, _ETA_STEP)
    missing = np.sqrt(np.maximum(0.0, 1.0 - j0(etas)))
    kept = missing <= math.sqrt(1.0 - _SPEED_RATIO_MIN)
    return missing[kept].tolist(), etas[kept].tolist()


@lru_cache(maxsize=1)
def _bessel_table() -> list[list[float]]:
    """Coefficients of sin(theta), sin(2 theta), ... by eta, rightward and along in turn."""
    etas = np.arange(0.0, _ETA_MAX + _ETA_STEP, _ETA_STEP)
    columns = []
    for k in range(1, _ORDERS + 1):
        columns.append(2.0 * (-1.0) ** (k - 1) * jv(2 * k - 1, etas) / (2 * k - 1))
        columns.append((-1.0) ** k * jv(2 * k, etas) / k)
    return np.stack(columns, axis=-1).tolist()  # type: ignore[no-any-return]
