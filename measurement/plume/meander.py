"""Smooth random processes along the air that has passed the funnel: where the plume's centre is, in
standard deviations.
"""

import math
from itertools import accumulate

import numpy as np

from measurement.plume.arrays import Array

_STEPS = 8.0
"""Steps of the grid per correlation length: the cubic between them is good to 1e-4 of a standard
deviation.
"""


class Meander:
    """A Gaussian process of unit variance with covariance (1 + |l|/L) exp(-|l|/L) over a path l,
    whose integral scale is 2 L.

    Matern's process of order 3/2: the solution of a linear equation with two states, value and
    slope, which is discretised exactly and started in its stationary state. Between the steps it is
    the cubic with the values and slopes that are at hand, so that it is had at any place and in any
    order, and has no corners.

    Parameters
    ----------
    start, end : of the path [m]
    integral_scale : 2 L [m], above 0
    generator : source of its randomness
    """

    def __init__(
        self, start: float, end: float, integral_scale: float, generator: np.random.Generator
    ) -> None:
        length = 0.5 * integral_scale
        self._start = start
        self._step = length / _STEPS
        count = math.ceil((end - start) / self._step) + 2
        value, slope = _states(count, self._step / length, generator)
        slope *= self._step / length
        rise = np.diff(value)
        # Rows of the cubics' coefficients, from the constant on.
        self._cubics = np.stack(
            [
                value[:-1],
                slope[:-1],
                3.0 * rise - 2.0 * slope[:-1] - slope[1:],
                slope[:-1] + slope[1:] - 2.0 * rise,
            ],
            axis=-1,
        )

    def at(self, path: Array) -> Array:
        """Return the process at places on the path [m] between its start and end, shape as given."""
        place = (path - self._start) / self._step
        index = place.astype(np.intp)
        rest = place - index
        constant, first, second, third = self._cubics.take(index, axis=0).T
        result: Array = constant + rest * (first + rest * (second + rest * third))
        return result


def _states(count: int, step: float, generator: np.random.Generator) -> tuple[Array, Array]:
    """Value and slope at ``count`` steps, with the correlation length as unit of the path.

    With w = value + slope both w and the value are first-order: dw = -w dl + noise, d value = (w -
    value) dl.
    """
    decay = math.exp(-step)
    stationary = np.array([[1.0, 1.0], [1.0, 2.0]])
    transition = decay * np.array([[1.0, step], [0.0, 1.0]])
    noise = np.linalg.cholesky(
        stationary - transition @ stationary @ transition.T
    ) @ generator.standard_normal((2, count))
    noise[:, 0] = np.linalg.cholesky(stationary) @ generator.standard_normal(2)
    total = _filtered(noise[1], decay)
    noise[0, 1:] += decay * step * total[:-1]
    value = _filtered(noise[0], decay)
    return value, total - value


def _filtered(noise: Array, decay: float) -> Array:
    """First-order recursion x_k = decay x_(k-1) + noise_k; scipy.signal takes a second to import."""
    return np.fromiter(
        accumulate(noise.tolist(), lambda state, kick: decay * state + kick), np.float64, len(noise)
    )
