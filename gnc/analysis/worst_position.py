"""The position from which the cascade law turns fastest: branch and bound over all of them; see
docs/actuation_bounds.md.
"""

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]

_CELLS = 24
"""Cells a side to begin with."""


def worst_case_over_positions(
    value: Callable[[_Array, _Array], _Array], sigma: float, tolerance: float
) -> float:
    """Return an upper bound, at most ``tolerance`` high, of a value that rises with both factors,
    over all positions.

    Branch and bound: cells are quartered until none can hold a value above the largest met in the
    middle of a cell, but for the tolerance. That ends because the bounds of ``factors_at_most``
    close in on ``factors`` as cells shrink.
    """
    edges = np.linspace(0.0, math.pi, _CELLS + 1)
    low, high = (
        np.stack(np.meshgrid(ends, ends)).reshape(2, -1) for ends in (edges[:-1], edges[1:])
    )
    largest = 0.0
    while low.size:
        middle = 0.5 * (low + high)
        largest = max(largest, float(np.max(value(*factors(sigma, *middle)))))
        open_still = value(*factors_at_most(sigma, low, high)) > largest * (1.0 + 0.5 * tolerance)
        low, middle, high = low[:, open_still], middle[:, open_still], high[:, open_still]
        corners = (
            [(low[0], middle[0]), (middle[0], high[0])],
            [(low[1], middle[1]), (middle[1], high[1])],
        )
        quarters = [(*across, *along) for across in corners[0] for along in corners[1]]
        low = np.concatenate([np.stack([quarter[0], quarter[2]]) for quarter in quarters], axis=1)
        high = np.concatenate([np.stack([quarter[1], quarter[3]]) for quarter in quarters], axis=1)
    return largest * (1.0 + tolerance)


def factors(sigma: float, alpha: _Array, beta: _Array) -> tuple[_Array, _Array]:
    """Return what multiplies V/R and what multiplies omega_r in the largest |omega_rho| at a
    position, over all courses.

    They are (R/rho)(|w_x| + |w|) and (delta/rho) cos(phi_r) of docs/actuation_bounds.md.

    Parameters
    ----------
    sigma : 1/(2 sqrt(epsilon R)), the largest d/delta, below 1 [-]
    alpha : 2 atan(d sqrt(epsilon/R)), so that d/delta = sigma sin(alpha), from 0 to pi [rad]
    beta : between -d and the reference's course, from 0 to pi [rad]
    """
    sin_a, cos_a, sin_b = np.sin(alpha), np.cos(alpha), np.sin(beta)
    x, k = sigma * sin_a, 1.0 - np.cos(beta)
    rho_squared = (1.0 - x) ** 2 + 2.0 * x * k
    across = np.sqrt(np.maximum(rho_squared - (sin_a * sin_b) ** 2, 0.0))
    along = sin_a * sin_b * np.abs(sigma * (1.0 + cos_a) + sin_a * (k - 1.0))
    return 0.5 * (along + (1.0 + cos_a) * across) / rho_squared, (1.0 - x + x * k) / rho_squared


def factors_at_most(sigma: float, low: _Array, high: _Array) -> tuple[_Array, _Array]:
    """Return upper bounds of both ``factors`` over cells: each term at the end of the cell where it
    is largest.
    """
    (a_1, b_1), (a_2, b_2) = low, high
    s_1, s_2 = _sine_range(a_1, a_2)
    sin_b_1, sin_b_2 = _sine_range(b_1, b_2)
    c_1, c_2 = 1.0 + np.cos(a_2), 1.0 + np.cos(a_1)
    k_1, k_2 = 1.0 - np.cos(b_1), 1.0 - np.cos(b_2)
    x_1, x_2 = sigma * s_1, sigma * s_2
    # (1 - x)^2 + 2 x k rises with k and is a parabola in x whose vertex is 1 - k.
    nearest = np.clip(1.0 - k_1, x_1, x_2)
    rho_squared_1 = (1.0 - nearest) ** 2 + 2.0 * nearest * k_1
    rho_squared_2 = np.maximum(
        (1.0 - x_1) ** 2 + 2.0 * x_1 * k_2, (1.0 - x_2) ** 2 + 2.0 * x_2 * k_2
    )
    # sqrt(rho^2 - p)/rho^2 is the root of y - p y^2, y = 1/rho^2, a parabola whose vertex is 1/(2
    # p).
    p = (s_1 * sin_b_1) ** 2
    y = np.clip(1.0 / np.maximum(2.0 * p, 1e-300), 1.0 / rho_squared_2, 1.0 / rho_squared_1)
    across = np.sqrt(np.maximum(y - p * y * y, 0.0))
    along = np.maximum(
        sigma * c_2 + np.maximum(s_1 * (k_2 - 1.0), s_2 * (k_2 - 1.0)),
        -sigma * c_1 - np.minimum(s_1 * (k_1 - 1.0), s_2 * (k_1 - 1.0)),
    )
    speed_factor = 0.5 * (s_2 * sin_b_2 * along / rho_squared_1 + c_2 * across)
    return speed_factor, (1.0 + np.maximum(x_1 * (k_2 - 1.0), x_2 * (k_2 - 1.0))) / rho_squared_1


def _sine_range(low: _Array, high: _Array) -> tuple[_Array, _Array]:
    """Return the least and the largest sine over angles within 0 and pi."""
    at_low, at_high = np.sin(low), np.sin(high)
    holds_crest = (low <= 0.5 * math.pi) & (high >= 0.5 * math.pi)
    return np.minimum(at_low, at_high), np.where(holds_crest, 1.0, np.maximum(at_low, at_high))
