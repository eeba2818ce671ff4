"""Angles on the circle."""

import math

_TURN = 2.0 * math.pi


def wrap(angle: float) -> float:
    """Return ``angle`` [rad] brought into [-pi, pi); the differences of courses go through here."""
    shifted = angle + math.pi
    if 0.0 <= shifted < _TURN:
        # What the remainder would be, without asking for it.
        return shifted - math.pi
    wrapped = math.fmod(shifted, _TURN)
    return wrapped - math.pi if wrapped >= 0.0 else wrapped + math.pi
