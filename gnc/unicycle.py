"""The vehicle of the paper: constant speed, steered by its heading rate."""

import math


def unicycle_rates(speed: float, course: float, heading_rate: float) -> tuple[float, float, float]:
    """Return north rate, east rate [m/s] and course rate [rad/s]: equation (1), and (13) for a reference.

    Parameters
    ----------
    speed : v [m/s]
    course : chi [rad]
    heading_rate : omega [rad/s]
    """
    return speed * math.cos(course), speed * math.sin(course), heading_rate


def unicycle_move(
    north: float, east: float, course: float, speed: float, heading_rate: float, duration: float
) -> tuple[float, float, float]:
    """Return position [m] and course [rad] after ``duration`` [s] of constant speed and heading rate: equation (1) integrated.

    The chord of the arc has the length v T sin(a)/a and the course of the arc's middle, with a half the angle turned.
    """
    half_turn = 0.5 * heading_rate * duration
    chord = speed * duration
    if abs(half_turn) > 1e-6:
        chord *= math.sin(half_turn) / half_turn
    middle = course + half_turn
    return north + chord * math.cos(middle), east + chord * math.sin(middle), course + 2.0 * half_turn
