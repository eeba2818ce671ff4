"""Angles brought into one turn, and values kept within a limit."""

import math

import numpy as np
import numpy.typing as npt

_TURN = 2.0 * math.pi


def wrap(angle: float) -> float:
    """Return ``angle`` [rad] brought into [-pi, pi); the differences of courses go through here."""
    shifted = angle + math.pi
    if 0.0 <= shifted < _TURN:
        # What the remainder would be, without asking for it.
        return shifted - math.pi
    wrapped = math.fmod(shifted, _TURN)
    return wrapped - math.pi if wrapped >= 0.0 else wrapped + math.pi


def wrapped(angles: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return angles [rad] brought to between -pi and pi, of any shape."""
    result: npt.NDArray[np.float64] = angles - _TURN * np.rint(angles / _TURN)
    return result


def limited(value: float, limit: float) -> float:
    """Return ``value`` kept within minus and plus ``limit``, which is above 0; what is not a number
    stays so.

    It takes a third of the time of ``min`` and ``max``: the guidance calls it at every step.
    """
    if value > limit:
        return limit
    return -limit if value < -limit else value


def clip(value: float, low: float, high: float) -> float:
    """Return ``value`` kept within ``low`` and ``high``; what is not a number stays so."""
    return low if value < low else high if value > high else value
