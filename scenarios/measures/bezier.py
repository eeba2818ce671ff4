"""The cubic between two samples as a Bezier curve."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


def bezier_points(time: Array, value: Array, rate: Array) -> Array:
    """Return the Bernstein coefficients of the cubics through values and rates, which each cubic
    stays within.

    Parameters
    ----------
    time : shape (n,) [s]
    value, rate : shapes (..., n), the rate per second

    Returns
    -------
    coefficients : shape (4, ..., n - 1)
    """
    third = np.diff(time) / 3.0
    first, last = value[..., :-1], value[..., 1:]
    points: Array = np.stack(
        [first, first + third * rate[..., :-1], last - third * rate[..., 1:], last]
    )
    return points
