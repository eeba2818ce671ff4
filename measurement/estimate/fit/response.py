"""One response for all channels: each is given the slowest poles there are, by a filter that lowers
its noise.
"""

import math
from collections.abc import Sequence

import numpy as np

from measurement.sniffer.lag import Array, lag

Poles = tuple[float, ...]
"""Time constants [s], the largest first."""

_AROUND = (-1, 0, 1, 2)
"""Samples between which a signal is read, from the one before the place [-]."""

_ON_SAMPLE = 1e-9
"""Share of a step by which a delay may miss a whole number of steps and still be one."""


def slowest(poles: Sequence[Poles]) -> Poles:
    """Return the poles of the common response: of each order the largest time constant, so that no
    filter amplifies noise.
    """
    count = max(len(p) for p in poles)
    return tuple(max(p[i] for p in poles if len(p) > i) for i in range(count))


def equalised(signal: Array, step: float, own: Poles, common: Poles) -> Array:
    """Return a signal as a channel with the common poles had read it.

    Each pole's filter is (1 + tau s)/(1 + T s), that is tau/T c + (1 - tau/T) lag_T(c), exact for a
    signal that is linear between samples. It is at rest at the first sample; what that leaves out
    is in ``transients``.

    Parameters
    ----------
    signal : shape (n,) or (n, k), a step [s] apart
    own, common : poles; a missing one is 0
    """
    for i, target in enumerate(common):
        tau = own[i] if i < len(own) else 0.0
        if tau != target:
            signal = tau / target * signal + (1.0 - tau / target) * lag(signal, step, target)
    return signal


def adjoint(weights: Array, step: float, own: Poles, common: Poles) -> Array:
    """Return the weights of a signal in the weighted sum of its equalised samples, shape (n,) or
    (n, k).

    The filter begins with a memory that is empty; for weights that sum to zero against
    ``transients`` this makes no difference.
    """
    return np.ascontiguousarray(equalised_from_rest(weights[::-1], step, own, common)[::-1])


def equalised_from_rest(signal: Array, step: float, own: Poles, common: Poles) -> Array:
    """Return the equalised signal where it was 0 before its first sample."""
    padded = np.concatenate([np.zeros((1, *signal.shape[1:])), signal])
    return equalised(padded, step, own, common)[1:]


def impulse(length: int, step: float, own: Poles, common: Poles) -> Array:
    """Return the filter's response to one sample of 1, shape (length,)."""
    one = np.zeros(length)
    one[0] = 1.0
    return equalised_from_rest(one, step, own, common)


def transients(time: Array, common: Poles) -> Array:
    """Return what an unknown state at the first sample may leave in an equalised signal, shape (n,
    poles).
    """
    return np.stack([np.exp(-(time - time[0]) / constant) for constant in common], axis=1)


def shifted(signal: Array, step: float, delay: float) -> Array:
    """Return a smooth signal ``delay`` later, by a cubic through four samples; beyond its ends it
    stays at its last value.
    """
    whole, weights = between_samples(step, delay)
    samples = np.arange(len(signal)) + whole
    moved = np.zeros(len(signal))
    for offset, weight in zip(_AROUND, weights, strict=True):
        if weight:
            moved += weight * signal.take(samples + offset, mode="clip")
    return moved


def unread(step: float, delay: float) -> tuple[int, int]:
    """Return how many samples at either end of a signal that is ``shifted`` by ``delay`` [s] come
    from beyond its ends.
    """
    whole, weights = between_samples(step, delay)
    used = [whole + offset for offset, weight in zip(_AROUND, weights, strict=True) if weight]
    return max(0, -min(used)), max(0, *used)


def between_samples(step: float, delay: float) -> tuple[int, tuple[float, float, float, float]]:
    """Return the sample before a time ``delay`` [s] earlier, and the weights of the one before it,
    itself, and the next two.

    They are Lagrange's. Their squares sum to 0.64 halfway between samples, and to 1 on one: what is
    shifted has less noise.
    """
    place = -delay / step
    whole = math.floor(place)
    share = place - whole
    if share < _ON_SAMPLE or share > 1.0 - _ON_SAMPLE:
        whole, share = round(place), 0.0
    return whole, (
        -share * (share - 1.0) * (share - 2.0) / 6.0,
        (share + 1.0) * (share - 1.0) * (share - 2.0) / 2.0,
        -(share + 1.0) * share * (share - 2.0) / 2.0,
        (share + 1.0) * share * (share - 1.0) / 6.0,
    )
