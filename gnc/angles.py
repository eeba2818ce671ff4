"""Angles on the circle."""

import math

_TURN = 2.0 * math.pi


def wrap(angle: float) -> float:
    """Return ``angle`` [rad] brought into [-pi, pi); the differences of courses go through here."""
    wrapped = math.fmod(angle + math.pi, _TURN)
    return wrapped - math.pi if wrapped >= 0.0 else wrapped + math.pi
