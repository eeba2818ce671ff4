"""Dormand and Prince's pair of Runge-Kutta formulae of orders 5 and 4, for many systems at once,
each with its own time and step.

"A family of embedded Runge-Kutta formulae", Journal of Computational and Applied Mathematics 6,
1980.
"""

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

_NODES = (0.0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0)
_STAGES = (
    (),
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
_ERROR = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)


def dormand_prince_step(
    rates: Callable[[Array, Array], Array], time: Array, state: Array, first: Array, step: Array
) -> tuple[Array, Array, Array]:
    """Return state and rates after a step, and the error of the state: the difference of both
    orders.

    Parameters
    ----------
    rates : of a state at a time, all systems at once
    time : shape (n,)
    state, first : now, and its rates, shape (k, n)
    step : shape (n,)
    """
    slopes = [first]
    there = state
    for node, weights in zip(_NODES[1:], _STAGES[1:], strict=True):
        there = state + step * _weighted(weights, slopes)
        slopes.append(rates(time + node * step, there))
    return there, slopes[-1], step * _weighted(_ERROR, slopes)


def _weighted(weights: tuple[float, ...], slopes: list[Array]) -> Array:
    total: Array = weights[0] * slopes[0]
    for weight, slope in zip(weights[1:], slopes[1:], strict=True):
        if weight != 0.0:
            total = total + weight * slope
    return total
