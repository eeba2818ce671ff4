"""Coordinated turns: the heading rate of a bank, and the bank of a heading rate."""

import math

from common.physics.units import STANDARD_GRAVITY


def heading_rate_for_bank(bank: float, speed: float) -> float:
    """Return the heading rate [rad/s] of a coordinated turn at ``bank`` [rad] and ``speed`` [m/s]."""
    return STANDARD_GRAVITY * math.tan(bank) / speed


def bank_for_heading_rate(heading_rate: float, speed: float) -> float:
    """Return the bank [rad] of a coordinated turn at ``heading_rate`` [rad/s] and ``speed`` [m/s]."""
    return math.atan(heading_rate * speed / STANDARD_GRAVITY)
