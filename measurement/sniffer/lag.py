"""Lags of first and second order, stepped exactly for an input that is linear between samples."""

import functools
import math

import numpy as np
import numpy.typing as npt

from measurement.errors import MeasurementError, check_range

Array = npt.NDArray[np.float64]

SECOND_POLE_MAX = 0.95
"""Largest second time constant over the first [-]: two equal poles have no parallel form."""


@functools.lru_cache(maxsize=256)
def time_constants(t90: float, second_pole: float) -> tuple[float, ...]:
    """Return the time constants [s] of a response that reaches 90 % of a step after ``t90``.

    One pole: t90 / ln 10. Two poles: the second time constant is ``second_pole`` times the first.

    Raises
    ------
    MeasurementError : ``t90`` is not positive, or ``second_pole`` is not in 0 to
        ``SECOND_POLE_MAX``
    """
    if not 0.0 < t90 < math.inf:
        raise MeasurementError(
            f"t90 is {t90:g} s; it must be positive and finite: the time to 90 % of a step"
        )
    check_range("second_pole", second_pole, 0.0, SECOND_POLE_MAX)
    if second_pole == 0.0:
        return (t90 / math.log(10.0),)
    from scipy.optimize import brentq

    # With the first time constant 1, the step response is 1 - (e^-t - r e^(-t/r)) / (1 - r).
    reached = brentq(
        lambda t: (
            0.1 - (math.exp(-t) - second_pole * math.exp(-t / second_pole)) / (1.0 - second_pole)
        ),
        1.0,
        6.0,
        xtol=1e-14,
    )
    return (t90 / float(reached), second_pole * t90 / float(reached))


def parallel(constants: tuple[float, ...]) -> tuple[tuple[float, float], ...]:
    """Return weight and time constant [s] of the first-order lags that add up to a lag."""
    if len(constants) == 1:
        return ((1.0, constants[0]),)
    first, second = constants
    return ((first / (first - second), first), (-second / (first - second), second))


def weights(step: Array | float, constant: float) -> tuple[Array, Array, Array]:
    """Return a first-order lag's coefficients over a step [-].

    The output after a step is a sum of three terms: coefficients times the output before, the input
    before and the input after. With r = step/constant, a = e^-r and m = (1 - a)/r they are a, m - a
    and 1 - m: exact for an input that is linear over the step.
    """
    r = np.asarray(step, dtype=np.float64) / constant
    a = np.exp(-r)
    m = -np.expm1(-r) / np.where(r > 0.0, r, 1.0)
    return a, np.where(r > 0.0, m - a, 0.0), np.where(r > 0.0, 1.0 - m, 0.0)


@functools.lru_cache(maxsize=256)
def _weights_of_step(step: float, constant: float) -> tuple[float, float, float]:
    a, old, new = weights(step, constant)
    return float(a), float(old), float(new)


def lag(
    signal: Array, step: float, constant: float, before: tuple[float, float] | None = None
) -> Array:
    """Return the output of a first-order lag at every sample of its input.

    Parameters
    ----------
    signal : input, shape (n,) or (n, k), linear between samples
    step : between samples [s]
    constant : time constant [s]
    before : output and input a step before the first sample; without it the lag is at rest at the
        first sample
    """
    from scipy.signal import lfilter

    a, old, new = _weights_of_step(step, constant)
    if not len(signal):
        return signal.copy()
    # The state of the transposed direct form is what the past adds to the next output.
    state = (1.0 - new) * signal[0] if before is None else a * before[0] + old * before[1]
    filtered, _ = lfilter(
        [new, old], [1.0, -a], signal, axis=0, zi=np.reshape(state, (1, *signal.shape[1:]))
    )
    return np.asarray(filtered, dtype=np.float64)
